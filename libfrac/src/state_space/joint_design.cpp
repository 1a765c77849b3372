// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "approximation/log_pole_problem.hpp"
#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"
#include "model_on_band.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

// H = direct + fixed modes + sum coefficient_k p_k/(s + p_k), p_k = e^(u_k), on the band scaled to be centred at 1
// rad/s; everything is linear but the u_k.  Errors are e = H/G - 1.
class PoleProblem {
 public:
  PoleProblem(const ModelOnBand& model, double density) {
    for (const double omega : model.grid(density)) {
      s_.emplace_back(0, omega / model.centre());
      inverse_.push_back(1.0 / model.response(omega));
    }
    if (model.has_direct()) fixed_.emplace_back(s_.size(), 1.0);
    for (const Mode& mode : model.kept_poles()) {
      const Complex pole = mode.pole / model.centre();
      const double size = pole == 0.0 ? 1 : std::abs(pole);
      for (std::size_t order = 1; order <= mode.residues.size(); ++order) add_mode(pole, size, order);
    }
    weight_.assign(s_.size(), 1 / static_cast<double>(s_.size()));
  }

  // The best coefficients for given u under the present weights, and the errors they leave.
  bool evaluate(const std::vector<double>& u) {
    const Matrix matrix = basis(u, 0);
    const Vector solution = solved(matrix, right_side(0));
    if (!solution.allFinite()) return false;
    coefficients_.assign(solution.begin(), solution.end());
    const Matrix plain = rows(u);
    const Vector value = plain * solution;
    error_.resize(s_.size());
    largest_ = 0;
    mean_ = 0;
    for (std::size_t i = 0; i < s_.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(2 * i);
      error_[i] = std::hypot(value[row] - 1, value[row + 1]);
      largest_ = std::max(largest_, error_[i]);
      mean_ += weight_[i] * error_[i] * error_[i];
    }
    mean_ = std::sqrt(mean_);
    return std::isfinite(largest_);
  }
  [[nodiscard]] double largest() const { return largest_; }
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] const std::vector<double>& coefficients() const { return coefficients_; }

  struct Step {
    std::vector<double> change;  // of u; empty when not finite
    double predicted;            // weighted mean after it, to first order
  };
  // Gauss-Newton in all unknowns, displacements held by a ridge of `damping` times the error.
  [[nodiscard]] Step step(const std::vector<double>& u, double damping) const {
    const auto count = static_cast<Eigen::Index>(u.size());
    Matrix matrix = basis(u, count);
    const Eigen::Index columns = matrix.cols();
    matrix.conservativeResize(matrix.rows(), columns + count);
    matrix.rightCols(count).setZero();
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto index = static_cast<std::size_t>(k);
      const double p = std::exp(u[index]);
      const double coefficient = coefficients_[fixed_.size() + index];
      for (std::size_t i = 0; i < s_.size(); ++i) {
        const Complex sum = s_[i] + p;
        const Complex slope = std::sqrt(weight_[i]) * coefficient * p * s_[i] / (sum * sum) * inverse_[i];
        matrix(static_cast<Eigen::Index>(2 * i), columns + k) = slope.real();
        matrix(static_cast<Eigen::Index>(2 * i) + 1, columns + k) = slope.imag();
      }
      matrix(static_cast<Eigen::Index>(2 * s_.size()) + k, columns + k) = damping * mean_;
    }
    const Vector right = right_side(count);
    // The ridge keeps the columns that move apart, and a step may be wrong where a result may not: no pivoting, which
    // would take three times as long.
    const Vector solution = solved<PlainQr>(matrix, right);
    if (!solution.allFinite()) return {{}, 0};
    const Vector change = solution.tail(count);
    return {{change.begin(), change.end()}, (matrix * solution - right).norm()};
  }

  void sharpen(double power) {
    double sum = 0;
    for (std::size_t i = 0; i < s_.size(); ++i) {
      // A point without error keeps a little weight, because it may come to count again.
      weight_[i] *= std::pow(std::max(error_[i] / largest_, 1e-3), power);
      sum += weight_[i];
    }
    for (double& weight : weight_) weight /= sum;
  }

 private:
  void add_mode(Complex pole, double size, std::size_t order) {
    std::vector<Complex> real(s_.size());
    std::vector<Complex> imaginary(s_.size());
    for (std::size_t i = 0; i < s_.size(); ++i) {
      const Complex above = std::pow(size / (s_[i] - pole), static_cast<int>(order));
      const Complex below = std::pow(size / (s_[i] - std::conj(pole)), static_cast<int>(order));
      real[i] = pole.imag() == 0 ? above : above + below;
      imaginary[i] = Complex(0, 1) * (above - below);
    }
    fixed_.push_back(std::move(real));
    if (pole.imag() != 0) fixed_.push_back(std::move(imaginary));
  }

  // H/G by coefficient, real and imaginary parts below each other.
  [[nodiscard]] Matrix rows(const std::vector<double>& u) const {
    Matrix matrix(static_cast<Eigen::Index>(2 * s_.size()), static_cast<Eigen::Index>(fixed_.size() + u.size()));
    const auto set = [&](std::size_t i, std::size_t column, Complex value) {
      const auto row = static_cast<Eigen::Index>(2 * i);
      matrix(row, static_cast<Eigen::Index>(column)) = value.real();
      matrix(row + 1, static_cast<Eigen::Index>(column)) = value.imag();
    };
    for (std::size_t i = 0; i < s_.size(); ++i) {
      for (std::size_t k = 0; k < fixed_.size(); ++k) set(i, k, fixed_[k][i] * inverse_[i]);
      for (std::size_t k = 0; k < u.size(); ++k) {
        const double p = std::exp(u[k]);
        set(i, fixed_.size() + k, p / (s_[i] + p) * inverse_[i]);
      }
    }
    return matrix;
  }

  // The rows, weighted, above `more` rows of zeros.
  [[nodiscard]] Matrix basis(const std::vector<double>& u, Eigen::Index more) const {
    const Matrix plain = rows(u);
    Matrix matrix = Matrix::Zero(plain.rows() + more, plain.cols());
    for (Eigen::Index row = 0; row < plain.rows(); ++row) {
      matrix.row(row) = std::sqrt(weight_[static_cast<std::size_t>(row / 2)]) * plain.row(row);
    }
    return matrix;
  }

  [[nodiscard]] Vector right_side(Eigen::Index more) const {
    Vector right = Vector::Zero(static_cast<Eigen::Index>(2 * s_.size()) + more);
    for (std::size_t i = 0; i < s_.size(); ++i) right[static_cast<Eigen::Index>(2 * i)] = std::sqrt(weight_[i]);
    return right;
  }

  template <typename Decomposition = PivotedQr>
  static Vector solved(const Matrix& matrix, const Vector& right) {
    // All columns get the same length, so that their directions alone decide which of them are alike.
    const Vector length = matrix.colwise().norm().cwiseMax(std::numeric_limits<double>::min());
    const Matrix even = matrix * length.cwiseInverse().asDiagonal();
    return Decomposition(even).solve(right).cwiseQuotient(length);
  }

  std::vector<Complex> s_;
  std::vector<Complex> inverse_;             // 1/G
  std::vector<std::vector<Complex>> fixed_;  // columns that do not move
  std::vector<double> weight_;
  std::vector<double> coefficients_;
  std::vector<double> error_;
  double largest_ = 0;
  double mean_ = 0;
};

// In order, apart by a hundredth, and within reach of the band.
bool acceptable(const std::vector<double>& u, double half_width) {
  for (std::size_t k = 0; k < u.size(); ++k) {
    if (!(std::abs(u[k]) < half_width + 12)) return false;
    if (k > 0 && !(u[k] > u[k - 1] + 0.01)) return false;
  }
  return true;
}

struct Best {
  std::vector<double> u;
  std::vector<double> coefficients;
  double error = std::numeric_limits<double>::infinity();
};

// As the ladder is designed (approximation/ladder.cpp): Gauss-Newton steps under weights that are sharpened towards the
// largest error (Lawson 1961) once a step no longer changes much.
Best optimal_poles(PoleProblem& least, std::vector<double> u, double half_width) {
  constexpr int most_steps = 80;
  constexpr int most_sharpenings = 24;
  constexpr double close_enough = 1.03;
  constexpr double least_damping = 1e-9;
  constexpr double most_damping = 10;
  Best best;
  const auto keep = [&] {
    if (least.largest() < best.error) best = {u, least.coefficients(), least.largest()};
  };
  if (!least.evaluate(u)) return best;
  keep();
  if (u.empty()) {
    for (int i = 0; i < most_sharpenings && least.evaluate(u); ++i) {
      keep();
      least.sharpen(1);
    }
    return best;
  }
  double damping = 1e-3;
  int sharpenings = 0;
  for (int i = 0; i < most_steps; ++i) {
    throw_if_cancelled();
    const PoleProblem::Step step = least.step(u, damping);
    if (step.change.empty()) break;
    const bool settled = least.mean() < 1.3 * step.predicted;
    const double mean = least.mean();
    bool improved = false;
    for (double share = 1; share > 0.03 && !improved; share /= 2) {
      throw_if_cancelled();
      std::vector<double> trial = u;
      for (std::size_t k = 0; k < u.size(); ++k) trial[k] += std::clamp(share * step.change[k], -1.0, 1.0);
      if (!acceptable(trial, half_width) || !least.evaluate(trial)) continue;
      improved = least.mean() < mean * (1 + 1e-3);
      if (improved) u = std::move(trial);
    }
    if (!improved) {
      least.evaluate(u);
      damping *= 10;
      if (damping > most_damping) {
        if (sharpenings >= most_sharpenings) break;
        damping = 1e-3;
        least.sharpen(1);
        ++sharpenings;
        least.evaluate(u);
        keep();
      }
      continue;
    }
    damping = least.mean() > 0.7 * mean ? std::min(3 * damping, 1e-2) : std::max(damping / 10, least_damping);
    keep();
    if (settled) {
      if (best.error < close_enough * step.predicted || sharpenings == most_sharpenings) break;
      least.sharpen(sharpenings < 3 ? 1.5 : 1);
      ++sharpenings;
      least.evaluate(u);
      keep();
    }
  }
  return best;
}

}  // namespace

ModalDesign joint_design(const ModelOnBand& model, int cut_poles) {
  // Six points to every pole, and what the model itself needs.
  const double density = std::max(3.0, 3.0 * (cut_poles + 1) / model.half_width());
  if (cut_poles == 0 && !model.has_direct() && model.kept_poles().empty()) return {0, {}, density};
  PoleProblem least(model, density);
  std::vector<double> u;
  if (cut_poles > 0) {
    for (const long double each : starting_log_poles({0.5, model.half_width()}, cut_poles))
      u.push_back(static_cast<double>(each));
  }
  const Best best = optimal_poles(least, std::move(u), model.half_width());
  ModalDesign design;
  design.density = density;
  std::size_t next = 0;
  if (best.coefficients.empty()) return design;
  if (model.has_direct()) design.direct = best.coefficients[next++];
  for (Mode mode : model.kept_poles()) {
    const double size = mode.pole == 0.0 ? model.centre() : std::abs(mode.pole);
    double scale = 1;
    for (Complex& residue : mode.residues) {
      scale *= size;
      residue = best.coefficients[next++];
      if (mode.pole.imag() != 0) residue += Complex(0, best.coefficients[next++]);
      residue *= scale;
    }
    design.modes.push_back(std::move(mode));
  }
  for (const double each : best.u) {
    const double p = model.centre() * std::exp(each);
    design.modes.push_back({-p, {best.coefficients[next++] * p}});
  }
  return design;
}

}  // namespace frac::detail
