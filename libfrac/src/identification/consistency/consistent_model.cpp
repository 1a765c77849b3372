// SPDX-License-Identifier: BSD-3-Clause
#include "consistent_model.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "base/eigenvalues.hpp"
#include "base/linear_algebra.hpp"
#include "frac/identification/statistics.hpp"
#include "special/complex_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

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
    target = rows(value);
  }
  [[nodiscard]] Eigen::VectorXd rows(const Eigen::VectorXcd& column) const {
    Eigen::VectorXd result(2 * column.size());
    for (Eigen::Index k = 0; k < column.size(); ++k) {
      result(2 * k) = column(k).real() * weight(k);
      result(2 * k + 1) = column(k).imag() * weight(k);
    }
    return result;
  }
  /// Weighted columns of size 1.
  [[nodiscard]] Eigen::MatrixXd rows(const Eigen::MatrixXcd& columns) const {
    Eigen::MatrixXd result(2 * columns.rows(), columns.cols());
    for (Eigen::Index j = 0; j < columns.cols(); ++j) {
      result.col(j) = rows(Eigen::VectorXcd(columns.col(j)));
      const double size = result.col(j).norm();
      if (size > 0) result.col(j) /= size;
    }
    return result;
  }
  [[nodiscard]] Eigen::Index size() const { return s.size(); }
};

constexpr Eigen::Index ends = 3;

double aicc(const Problem& problem, double cost, Eigen::Index parameters) {
  return information_criteria(cost, static_cast<std::size_t>(problem.target.size()),
                              static_cast<std::size_t>(parameters), 1e-24 * problem.target.squaredNorm())
      .aicc;
}

ConsistentModel made(const Eigen::MatrixXd& tangent) {
  ConsistentModel model;
  model.rest.orthonormal = PlainQr(tangent).basis();
  return model;
}

void take_residual(const Problem& problem, const Eigen::VectorXd& residual, ConsistentModel& model) {
  model.rest.residual = residual;
  model.value.resize(problem.size());
  for (Eigen::Index k = 0; k < problem.size(); ++k)
    model.value(k) = problem.value(k) - Complex(residual(2 * k), residual(2 * k + 1)) / problem.weight(k);
}

// ---- Real poles on a grid.

/// 1/(s - pole), without the recovery of infinities that division of std::complex spends time on.
Eigen::ArrayXcd reciprocals(const Eigen::VectorXcd& s, Complex pole) {
  return (s.array() - pole).unaryExpr([](Complex each) { return reciprocal(each); });
}

/// Ends and poles, unweighted.
Eigen::MatrixXcd grid_columns(const Problem& problem, Eigen::Index poles, double reach) {
  Eigen::MatrixXcd columns(problem.size(), ends + poles);
  columns.col(0).setOnes();
  columns.col(1) = problem.s;
  columns.col(2) = problem.s.cwiseInverse();
  const double first = problem.log_omega(0) - reach, last = problem.log_omega(problem.size() - 1) + reach;
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

Eigen::VectorXd solve(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) {
  Eigen::VectorXd scale = columns.colwise().norm();
  for (double& each : scale) each = each > 0 ? each : 1;
  const Eigen::MatrixXd scaled = columns * scale.cwiseInverse().asDiagonal();
  return PlainQr(scaled).solve(target).cwiseQuotient(scale);
}

Eigen::MatrixXd unscaled_rows(const Problem& problem, const Eigen::MatrixXcd& columns) {
  Eigen::MatrixXd result(2 * columns.rows(), columns.cols());
  for (Eigen::Index j = 0; j < columns.cols(); ++j) result.col(j) = problem.rows(Eigen::VectorXcd(columns.col(j)));
  return result;
}

/// What stays in the model while poles move: its space is taken out of all columns once.
struct Fixed {
  Eigen::MatrixXd orthonormal;
  Eigen::VectorXd target;  // what it leaves of the target

  Fixed(const Problem& problem, Eigen::Index grid)
      : orthonormal(PlainQr(problem.rows(grid_columns(problem, grid, 0))).basis()),
        target(problem.target - orthonormal * (orthonormal.transpose() * problem.target)) {}
  [[nodiscard]] Eigen::Index width() const { return orthonormal.cols(); }
  /// Weighted rows of the columns beside it.
  [[nodiscard]] Eigen::MatrixXd beside(const Problem& problem, const Eigen::MatrixXcd& columns) const {
    Eigen::MatrixXd rows = unscaled_rows(problem, columns);
    remove_span(orthonormal, rows);
    return rows;
  }
};

/// One step of vector fitting: the zeros of 1 + sum of the poles that makes its product with the data a sum of the same
/// poles.
bool relocate(const Problem& problem, const Fixed& fixed, Poles& poles) {
  const Eigen::MatrixXcd basis = pole_columns(problem, poles);
  const Eigen::Index width = basis.cols();
  Eigen::MatrixXcd columns(problem.size(), 2 * width);
  columns << basis, -(problem.value.asDiagonal() * basis);
  const Eigen::VectorXd sum = solve(fixed.beside(problem, columns), fixed.target).tail(width);
  if (!sum.allFinite()) return false;
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
  if (width_of(next) != width) return false;
  poles = std::move(next);
  return true;
}

struct FreeFit {
  Poles poles;
  Eigen::VectorXd coefficients, residual;  // coefficients of the poles
  double cost = std::numeric_limits<double>::infinity();
};

FreeFit fit_at(const Problem& problem, const Fixed& fixed, Poles poles) {
  const Eigen::MatrixXd rows = fixed.beside(problem, pole_columns(problem, poles));
  FreeFit fit;
  fit.poles = std::move(poles);
  fit.coefficients = solve(rows, fixed.target);
  fit.residual = fixed.target - rows * fit.coefficients;
  fit.cost = fit.coefficients.allFinite() ? fit.residual.squaredNorm() : std::numeric_limits<double>::infinity();
  return fit;
}

/// Columns of the poles, and derivatives of the model by the logarithm of a real pole, by the real and the imaginary
/// part of one of a pair.
Eigen::MatrixXcd tangent_of(const Problem& problem, const FreeFit& fit) {
  const Eigen::Index width = width_of(fit.poles);
  Eigen::MatrixXcd columns(problem.size(), 2 * width);
  columns.leftCols(width) = pole_columns(problem, fit.poles);
  Eigen::Index at = 0;
  for (const Complex& pole : fit.poles) {
    const Eigen::ArrayXcd upper = reciprocals(problem.s, pole).square();
    const Eigen::Index to = width + at;
    if (pole.imag() == 0) {
      columns.col(to) = fit.coefficients(at) * pole.real() * upper;
      at += 1;
      continue;
    }
    const Complex residue(fit.coefficients(at), fit.coefficients(at + 1));
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

void descend(const Problem& problem, const Fixed& fixed, FreeFit& fit, int steps) {
  for (int step = 0; step < steps; ++step) {
    const Eigen::MatrixXd tangent = fixed.beside(problem, tangent_of(problem, fit));
    const Eigen::VectorXd change = solve(tangent, fit.residual).tail(width_of(fit.poles));
    if (!change.allFinite()) return;
    const double before = fit.cost;
    for (double share = 1; share > 0.05 && fit.cost == before; share /= 3) {
      FreeFit next = fit_at(problem, fixed, stepped(problem, fit.poles, change, share));
      if (next.cost < fit.cost) fit = std::move(next);
    }
    if (!(fit.cost < before * (1 - 1e-4))) return;
  }
}

FreeFit fit_free(const Problem& problem, const Fixed& fixed, Eigen::Index pairs) {
  const double first = problem.log_omega(0), last = problem.log_omega(problem.size() - 1);
  Poles poles;
  for (Eigen::Index i = 0; i < pairs; ++i) {
    const double size = std::exp(first + (last - first) * (static_cast<double>(i) + 0.5) / static_cast<double>(pairs));
    poles.push_back(admitted(problem, size * Complex(-0.05, 1)));
  }
  FreeFit best = fit_at(problem, fixed, poles);
  constexpr int relocations = 10;
  for (int i = 0; i < relocations && relocate(problem, fixed, poles); ++i) {
    const double before = best.cost;
    FreeFit here = fit_at(problem, fixed, poles);
    if (here.cost < best.cost) best = std::move(here);
    if (i > 2 && best.cost > before * 0.999) break;
  }
  descend(problem, fixed, best, 2);
  return best;
}

Eigen::Index parameters_of(const Problem& problem, const Fixed& fixed, const FreeFit& fit) {
  const auto narrow = static_cast<Eigen::Index>(price_of_narrow_pair * narrow_pairs_of(problem, fit.poles));
  return fixed.width() + 2 * width_of(fit.poles) + narrow;
}

ConsistentModel settled(const Problem& problem, const Fixed& fixed, Eigen::Index grid, FreeFit fit) {
  descend(problem, fixed, fit, 10);
  Eigen::MatrixXcd tangent(problem.size(), fixed.width() + 2 * width_of(fit.poles));
  tangent << grid_columns(problem, grid, 0), tangent_of(problem, fit);
  ConsistentModel model = made(problem.rows(tangent));
  take_residual(problem, fit.residual, model);
  model.criterion = aicc(problem, fit.cost, parameters_of(problem, fixed, fit));
  model.grid_poles = static_cast<std::size_t>(grid);
  model.narrow_pairs = narrow_pairs_of(problem, fit.poles);
  model.free_poles = std::move(fit.poles);
  return model;
}

ConsistentModel on_grid(const Problem& problem, Eigen::Index poles, double reach) {
  ConsistentModel model = made(problem.rows(grid_columns(problem, poles, reach)));
  const Eigen::MatrixXd& q = model.rest.orthonormal;
  take_residual(problem, problem.target - q * (q.transpose() * problem.target), model);
  model.grid_poles = static_cast<std::size_t>(poles);
  model.reach = reach;
  model.criterion = aicc(problem, model.rest.square(), q.cols());
  return model;
}

// A smaller difference in AICc does not tell candidates apart.  The richer one is then taken: too poor a model raises a
// false alarm, one too rich costs little.
constexpr double alike = 2;

}  // namespace

ConsistentModel best_on_grid(const WeightedPoints& points) {
  const Problem problem(points);
  const Eigen::Index rows = problem.target.size();
  const double decades = (problem.log_omega(problem.size() - 1) - problem.log_omega(0)) / std::log(10.0);
  struct Candidate {
    Eigen::Index poles;
    double reach, criterion;
  };
  std::vector<Candidate> candidates;
  double least = std::numeric_limits<double>::infinity();
  for (const double reach : {0.0, std::log(10.0)}) {
    const auto densest = static_cast<Eigen::Index>(6 * (decades + 2 * reach / std::log(10.0))) + 2;
    const Eigen::Index most = std::min(densest, rows / 2 - ends);
    for (Eigen::Index poles = 0; poles <= most; poles += std::max<Eigen::Index>(1, poles / 6)) {
      const Eigen::MatrixXd columns = problem.rows(grid_columns(problem, poles, reach));
      const double criterion = aicc(problem, PlainQr(columns).squared_distance(problem.target), columns.cols());
      candidates.push_back({poles, reach, criterion});
      least = std::min(least, criterion);
    }
  }
  Candidate best{0, 0, least};
  for (const Candidate& each : candidates)
    if (each.criterion <= least + alike && each.poles >= best.poles) best = each;
  return on_grid(problem, best.poles, best.reach);
}

ConsistentModel on_grid(const WeightedPoints& points, std::size_t poles, double reach) {
  return on_grid(Problem(points), static_cast<Eigen::Index>(poles), reach);
}

ConsistentModel best_with_free_poles(const WeightedPoints& points, std::span<const std::size_t> pair_counts) {
  const Problem problem(points);
  const Eigen::Index rows = problem.target.size();
  const double decades = (problem.log_omega(problem.size() - 1) - problem.log_omega(0)) / std::log(10.0);
  double best = std::numeric_limits<double>::infinity();
  FreeFit chosen;
  Eigen::Index chosen_grid = 0;
  // Free poles beside fixed real ones, which follow a fractional background, and free poles alone.
  for (const Eigen::Index grid : {static_cast<Eigen::Index>(std::ceil(2 * decades)), Eigen::Index{0}}) {
    const Fixed fixed(problem, grid);
    for (const std::size_t count : pair_counts) {
      const auto pairs = static_cast<Eigen::Index>(count);
      if (2 * (fixed.width() + 4 * pairs) > rows) break;
      FreeFit fit = fit_free(problem, fixed, pairs);
      const double criterion = aicc(problem, fit.cost, parameters_of(problem, fixed, fit));
      if (!(criterion < best)) continue;
      best = criterion;
      chosen = std::move(fit);
      chosen_grid = grid;
    }
  }
  if (chosen.poles.empty()) return best_on_grid(points);
  return settled(problem, Fixed(problem, chosen_grid), chosen_grid, std::move(chosen));
}

ConsistentModel refitted(const WeightedPoints& points, const ConsistentModel& model) {
  const Problem problem(points);
  const auto grid = static_cast<Eigen::Index>(model.grid_poles);
  const Fixed fixed(problem, grid);
  return settled(problem, fixed, grid, fit_at(problem, fixed, model.free_poles));
}

}  // namespace frac::detail
