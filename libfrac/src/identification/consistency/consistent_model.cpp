// SPDX-License-Identifier: BSD-3-Clause
#include "consistent_model.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/eigenvalues.hpp"
#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"
#include "frac/identification/statistics.hpp"
#include "triangle.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

/// Real and imaginary part of each entry in turn.
Eigen::Map<const Eigen::MatrixXd> rows(const Eigen::MatrixXcd& columns) {
  return {reinterpret_cast<const double*>(columns.data()), 2 * columns.rows(), columns.cols()};
}

/// Frequencies in units of the middle of the band, values over their deviation.
struct Problem {
  Eigen::VectorXcd s;
  Eigen::VectorXd log_omega;
  Eigen::VectorXd weight;
  Eigen::VectorXcd value;  // unweighted
  Eigen::VectorXd target;

  explicit Problem(const WeightedPoints& points) : value(points.value) {
    const auto count = static_cast<Eigen::Index>(points.omega.size());
    const double centre = std::sqrt(points.omega.front()) * std::sqrt(points.omega.back());
    s.resize(count);
    log_omega.resize(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const double omega = points.omega[static_cast<std::size_t>(k)] / centre;
      s(k) = Complex(0, omega);
      log_omega(k) = std::log(omega);
    }
    weight = points.deviation.cwiseInverse();
    target = rows(weighted(value));
  }
  [[nodiscard]] Eigen::MatrixXcd weighted(Eigen::MatrixXcd columns) const {
    columns.array().colwise() *= weight.array();
    return columns;
  }
  [[nodiscard]] Eigen::Index size() const { return s.size(); }
};

constexpr Eigen::Index ends = 3;

double aicc(const Problem& problem, double cost, Eigen::Index parameters) {
  return information_criteria(cost, static_cast<std::size_t>(problem.target.size()),
                              static_cast<std::size_t>(parameters), 1e-24 * problem.target.squaredNorm())
      .aicc;
}

ConsistentModel made(const Problem& problem, const Eigen::MatrixXcd& tangent) {
  throw_if_cancelled();
  ConsistentModel model;
  model.projected.orthonormal = PlainQr(rows(problem.weighted(tangent))).basis();
  return model;
}

void take_residual(const Problem& problem, const Eigen::VectorXd& residual, ConsistentModel& model) {
  model.projected.residual = residual;
  model.value.resize(problem.size());
  for (Eigen::Index k = 0; k < problem.size(); ++k)
    model.value(k) = problem.value(k) - Complex(residual(2 * k), residual(2 * k + 1)) / problem.weight(k);
}

// ---- Real poles on a grid.

/// 1/(s - pole) for imaginary s, without the recovery of infinities that division of std::complex spends time on.
Eigen::ArrayXcd reciprocals(const Eigen::VectorXcd& s, Complex pole) {
  const Eigen::ArrayXd above = s.imag().array() - pole.imag();
  const Eigen::ArrayXd share = (above.square() + pole.real() * pole.real()).inverse();
  Eigen::ArrayXcd result(s.size());
  result.real() = -pole.real() * share;
  result.imag() = -above * share;
  return result;
}

/// Ends and poles, unweighted.
Eigen::MatrixXcd grid_columns(const Problem& problem, Eigen::Index poles, double margin) {
  Eigen::MatrixXcd columns(problem.size(), ends + poles);
  columns.col(0).setOnes();
  columns.col(1) = problem.s;
  columns.col(2) = problem.s.cwiseInverse();
  const double first = problem.log_omega(0) - margin, last = problem.log_omega(problem.size() - 1) + margin;
  for (Eigen::Index i = 0; i < poles; ++i) {
    const double corner =
        std::exp(first + (last - first) * (static_cast<double>(i) + 0.5) / static_cast<double>(poles));
    columns.col(ends + i) = corner * reciprocals(problem.s, -corner);
  }
  return columns;
}

// ---- Poles at free places.

using Poles = std::vector<Complex>;  // real, or the upper one of a pair; real part < 0

Eigen::Index width_of(const Poles& poles) {
  Eigen::Index width = 0;
  for (const Complex& pole : poles) width += pole.imag() == 0 ? 1 : 2;
  return width;
}

/// 1/(s - p), or for a pair the sum and j times the difference of both, so that coefficients are real.
Eigen::MatrixXcd pole_columns(const Problem& problem, const Poles& poles) {
  Eigen::MatrixXcd columns(problem.size(), width_of(poles));
  Eigen::Index at = 0;
  for (const Complex& pole : poles) {
    const Eigen::ArrayXcd upper = reciprocals(problem.s, pole);
    if (pole.imag() == 0) {
      columns.col(at++) = upper;
      continue;
    }
    const Eigen::ArrayXcd lower = reciprocals(problem.s, std::conj(pole));
    columns.col(at++) = upper + lower;
    columns.col(at++) = Complex(0, 1) * (upper - lower);
  }
  return columns;
}

/// Distance of the points about a frequency, on its logarithm.
double spacing_at(const Problem& problem, double size) {
  const double* first = problem.log_omega.data();
  const double* last = first + problem.size();
  const double* above = std::clamp(std::upper_bound(first, last, std::log(size)), first + 1, last - 1);
  return *above - *(above - 1);
}

/// Moves poles into the left half plane, and widens a pair so narrow that the points cannot tell its width.
Complex admitted(const Problem& problem, Complex pole) {
  const double size = std::abs(pole);
  if (!(size > 0) || !std::isfinite(size)) return {-1, 0};
  if (pole.imag() == 0) return {-std::abs(pole.real()), 0};
  const double narrowest = std::min(0.05 * spacing_at(problem, size), 0.7) * size;
  return {-std::max(std::abs(pole.real()), narrowest), std::abs(pole.imag())};
}

std::size_t narrow_pairs_of(const Problem& problem, const Poles& poles) {
  return static_cast<std::size_t>(std::count_if(poles.begin(), poles.end(), [&](const Complex& pole) {
    const double size = std::abs(pole);
    return pole.imag() != 0 && -pole.real() < 0.25 * spacing_at(problem, size) * size;
  }));
}

/// Columns side by side.
Eigen::MatrixXcd beside(const Eigen::MatrixXcd& left, const Eigen::MatrixXcd& right) {
  Eigen::MatrixXcd both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

struct FreeFit {
  Poles poles;
  Eigen::VectorXd coefficients;  // of what stays in the model, then of the poles
  double cost = std::numeric_limits<double>::infinity();

  /// The fit in the space of the first columns; the last of these belong to the poles.
  FreeFit(Poles at, const Triangle& triangle, Eigen::Index columns)
      : poles(std::move(at)), coefficients(triangle.solution(columns)) {
    if (coefficients.allFinite()) cost = triangle.squared_distance(columns);
  }
  FreeFit() = default;
  [[nodiscard]] Eigen::Index width() const { return width_of(poles); }
};

/// @param fixed  columns that stay in the model while poles move
FreeFit fit_at(const Problem& problem, const Eigen::MatrixXcd& fixed, Poles poles) {
  const Triangle triangle(problem.weighted(beside(fixed, pole_columns(problem, poles))), problem.target);
  const Eigen::Index columns = fixed.cols() + width_of(poles);
  return {std::move(poles), triangle, columns};
}

/// Zeros of 1 + a sum of poles with these coefficients; empty where they are not of the same number.
Poles zeros_of(const Problem& problem, const Poles& poles, const Eigen::VectorXd& sum) {
  if (!sum.allFinite()) return {};
  const Eigen::Index width = sum.size();
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(width, width);
  Eigen::Index at = 0;
  for (const Complex& pole : poles) {
    if (pole.imag() == 0) {
      state(at, at) = pole.real();
      state.row(at) -= sum.transpose();
      at += 1;
    } else {
      state.block<2, 2>(at, at) << pole.real(), pole.imag(), -pole.imag(), pole.real();
      state.row(at) -= 2 * sum.transpose();
      at += 2;
    }
  }
  const Eigen::VectorXcd zeros = eigenvalues(state);
  Poles next;
  for (const Complex& zero : zeros)
    if (zero.imag() >= 0) next.push_back(admitted(problem, zero));
  return width_of(next) == width ? next : Poles{};
}

/// The fit at these poles, and where a step of vector fitting moves them: to the zeros of 1 + sum of the poles that
/// makes its product with the data a sum of the same poles.
struct Relocation {
  FreeFit here;
  Poles next;  // empty: nowhere
};
Relocation relocated(const Problem& problem, const Eigen::MatrixXcd& fixed, Poles poles) {
  const Eigen::MatrixXcd basis = pole_columns(problem, poles);
  const Eigen::Index width = basis.cols(), model = fixed.cols() + width;
  Eigen::MatrixXcd columns(problem.size(), model + width);
  columns << fixed, basis, -(problem.value.asDiagonal() * basis);
  const Triangle triangle(problem.weighted(std::move(columns)), problem.target);
  Poles next = zeros_of(problem, poles, triangle.solution(model + width).tail(width));
  return {FreeFit(std::move(poles), triangle, model), std::move(next)};
}

/// Columns of the poles, and derivatives of the model by the logarithm of a real pole, by the real and the imaginary
/// part of one of a pair.
Eigen::MatrixXcd tangent_of(const Problem& problem, const FreeFit& fit) {
  const Eigen::Index width = fit.width();
  const Eigen::VectorXd coefficients = fit.coefficients.tail(width);
  Eigen::MatrixXcd columns(problem.size(), 2 * width);
  columns.leftCols(width) = pole_columns(problem, fit.poles);
  Eigen::Index at = 0;
  for (const Complex& pole : fit.poles) {
    const Eigen::ArrayXcd upper = reciprocals(problem.s, pole).square();
    const Eigen::Index to = width + at;
    if (pole.imag() == 0) {
      columns.col(to) = coefficients(at) * pole.real() * upper;
      at += 1;
      continue;
    }
    const Complex residue(coefficients(at), coefficients(at + 1));
    const Eigen::ArrayXcd lower = reciprocals(problem.s, std::conj(pole)).square();
    columns.col(to) = residue * upper + std::conj(residue) * lower;
    columns.col(to + 1) = Complex(0, 1) * (residue * upper - std::conj(residue) * lower);
    at += 2;
  }
  return columns;
}

Poles stepped(const Problem& problem, const Poles& poles, const Eigen::VectorXd& step, double share) {
  Poles next;
  Eigen::Index at = 0;
  for (const Complex& pole : poles) {
    if (pole.imag() == 0) {
      next.emplace_back(pole.real() * std::exp(std::clamp(share * step(at), -1.0, 1.0)), 0);
      at += 1;
    } else {
      const double limit = 0.5 * std::abs(pole);
      const Complex moved(pole.real() + std::clamp(share * step(at), -limit, limit),
                          pole.imag() + std::clamp(share * step(at + 1), -limit, limit));
      next.push_back(admitted(problem, {std::min(moved.real(), 0.0), std::max(moved.imag(), 1e-6 * std::abs(pole))}));
      at += 2;
    }
  }
  return next;
}

void descend(const Problem& problem, const Eigen::MatrixXcd& fixed, FreeFit& fit, int steps) {
  for (int step = 0; step < steps; ++step) {
    // The first columns take the model out of the target, which leaves the residual to the last ones.
    const Triangle tangent(problem.weighted(beside(fixed, tangent_of(problem, fit))), problem.target);
    const Eigen::VectorXd change = tangent.solution(fixed.cols() + 2 * fit.width()).tail(fit.width());
    if (!change.allFinite()) return;
    const double before = fit.cost;
    for (double share = 1; share > 0.05 && fit.cost == before; share /= 3) {
      FreeFit next = fit_at(problem, fixed, stepped(problem, fit.poles, change, share));
      if (next.cost < fit.cost) fit = std::move(next);
    }
    if (!(fit.cost < before * (1 - 1e-4))) return;
  }
}

FreeFit fit_free(const Problem& problem, const Eigen::MatrixXcd& fixed, Eigen::Index pairs) {
  const double first = problem.log_omega(0), last = problem.log_omega(problem.size() - 1);
  Poles poles;
  for (Eigen::Index i = 0; i < pairs; ++i) {
    const double size = std::exp(first + (last - first) * (static_cast<double>(i) + 0.5) / static_cast<double>(pairs));
    poles.push_back(admitted(problem, size * Complex(-0.05, 1)));
  }
  Relocation at = relocated(problem, fixed, std::move(poles));
  FreeFit best = std::move(at.here);
  constexpr int relocations = 10;
  for (int i = 0; i < relocations && !at.next.empty(); ++i) {
    at = relocated(problem, fixed, std::move(at.next));
    const double before = best.cost;
    if (at.here.cost < best.cost) best = std::move(at.here);
    if (i > 2 && best.cost > before * 0.999) break;
  }
  descend(problem, fixed, best, 2);
  return best;
}

Eigen::Index parameters_of(const Problem& problem, Eigen::Index fixed, const FreeFit& fit) {
  const auto narrow = static_cast<Eigen::Index>(price_of_narrow_pair * narrow_pairs_of(problem, fit.poles));
  return fixed + 2 * fit.width() + narrow;
}

ConsistentModel converged(const Problem& problem, Eigen::Index grid, FreeFit fit) {
  const Eigen::MatrixXcd fixed = grid_columns(problem, grid, 0);
  descend(problem, fixed, fit, 10);
  const Eigen::MatrixXcd tangent = beside(fixed, tangent_of(problem, fit));
  ConsistentModel model = made(problem, tangent);
  const Eigen::VectorXcd value = tangent.leftCols(fit.coefficients.size()) * fit.coefficients;
  take_residual(problem, problem.target - rows(problem.weighted(value)), model);
  model.criterion = aicc(problem, fit.cost, parameters_of(problem, fixed.cols(), fit));
  model.grid_poles = static_cast<std::size_t>(grid);
  model.narrow_pairs = narrow_pairs_of(problem, fit.poles);
  model.free_poles = std::move(fit.poles);
  return model;
}

ConsistentModel on_grid(const Problem& problem, Eigen::Index poles, double margin) {
  ConsistentModel model = made(problem, grid_columns(problem, poles, margin));
  const Eigen::MatrixXd& q = model.projected.orthonormal;
  take_residual(problem, problem.target - q * (q.transpose() * problem.target), model);
  model.grid_poles = static_cast<std::size_t>(poles);
  model.margin = margin;
  model.criterion = aicc(problem, model.projected.square(), q.cols());
  return model;
}

double cost_on_grid(const Problem& problem, Eigen::Index poles, double margin) {
  throw_if_cancelled();
  return Triangle(problem.weighted(grid_columns(problem, poles, margin)), problem.target)
      .squared_distance(ends + poles);
}

// A smaller difference in AICc does not tell candidates apart.  The richer one is then taken: too poor a model raises a
// false alarm, one too rich costs little.
constexpr double alike = 2;

struct Candidate {
  Eigen::Index poles;
  double margin;
};

std::vector<Candidate> candidates_of(const Problem& problem) {
  const double decade = std::log(10.0), band = problem.log_omega(problem.size() - 1) - problem.log_omega(0);
  std::vector<Candidate> candidates;
  for (const double margin : {0.0, decade}) {
    const auto densest = static_cast<Eigen::Index>(6 * (band + 2 * margin) / decade) + 2;
    const Eigen::Index most = std::min(densest, problem.target.size() / 2 - ends);
    for (Eigen::Index poles = 0; poles <= most; poles += std::max<Eigen::Index>(1, poles / 6))
      candidates.push_back({poles, margin});
  }
  return candidates;
}

}  // namespace

ConsistentModel best_on_grid(const WeightedPoints& points, GridCosts& costs) {
  const Problem problem(points);
  const std::vector<Candidate> candidates = candidates_of(problem);
  const auto criterion = [&](std::size_t i) { return aicc(problem, costs.cost[i], ends + candidates[i].poles); };
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (costs.cost.empty()) {
    costs.cost.assign(candidates.size(), 0);
  } else {
    // Squares grow by the square of the least ratio of the weights at least, and so does the least sum of them.
    const double growth = problem.weight.cwiseQuotient(costs.weight).minCoeff();
    for (double& each : costs.cost) each *= growth * growth;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return criterion(a) < criterion(b); });
  }
  costs.weight = problem.weight;
  double least = std::numeric_limits<double>::infinity();
  std::size_t looked_at = 0;
  for (; looked_at < order.size() && criterion(order[looked_at]) <= least + alike; ++looked_at) {
    const std::size_t i = order[looked_at];
    costs.cost[i] = cost_on_grid(problem, candidates[i].poles, candidates[i].margin);
    least = std::min(least, criterion(i));
  }
  order.resize(looked_at);
  std::sort(order.begin(), order.end());
  Candidate best{0, 0};
  for (const std::size_t i : order)
    if (criterion(i) <= least + alike && candidates[i].poles >= best.poles) best = candidates[i];
  return on_grid(problem, best.poles, best.margin);
}

ConsistentModel on_grid(const WeightedPoints& points, std::size_t poles, double margin) {
  return on_grid(Problem(points), static_cast<Eigen::Index>(poles), margin);
}

ConsistentModel best_with_free_poles(const WeightedPoints& points, std::span<const std::size_t> pair_counts) {
  const Problem problem(points);
  const Eigen::Index equations = problem.target.size();
  const double decades = (problem.log_omega(problem.size() - 1) - problem.log_omega(0)) / std::log(10.0);
  double best = std::numeric_limits<double>::infinity();
  FreeFit chosen;
  Eigen::Index chosen_grid = 0;
  // Free poles beside fixed real ones, which follow a fractional background, and free poles alone.
  for (const Eigen::Index grid : {static_cast<Eigen::Index>(std::ceil(2 * decades)), Eigen::Index{0}}) {
    const Eigen::MatrixXcd fixed = grid_columns(problem, grid, 0);
    for (const std::size_t count : pair_counts) {
      const auto pairs = static_cast<Eigen::Index>(count);
      if (2 * (fixed.cols() + 4 * pairs) > equations) break;
      FreeFit fit = fit_free(problem, fixed, pairs);
      const double criterion = aicc(problem, fit.cost, parameters_of(problem, fixed.cols(), fit));
      if (!(criterion < best)) continue;
      best = criterion;
      chosen = std::move(fit);
      chosen_grid = grid;
    }
  }
  if (chosen.poles.empty()) {
    GridCosts unknown;
    return best_on_grid(points, unknown);
  }
  return converged(problem, chosen_grid, std::move(chosen));
}

ConsistentModel refitted(const WeightedPoints& points, const ConsistentModel& model) {
  const Problem problem(points);
  const auto grid = static_cast<Eigen::Index>(model.grid_poles);
  return converged(problem, grid, fit_at(problem, grid_columns(problem, grid, 0), model.free_poles));
}

}  // namespace frac::detail
