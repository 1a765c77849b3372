// SPDX-License-Identifier: BSD-3-Clause
// Linear least squares by Householder reflections, and variable projection on top of it.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace judging {

/// Matrix by columns, all of one length.
using Columns = std::vector<std::vector<double>>;

inline double norm_of(const std::vector<double>& x, std::size_t from = 0) {
  double largest = 0;
  for (std::size_t i = from; i < x.size(); ++i) largest = std::fmax(largest, std::abs(x[i]));
  if (!(largest > 0) || !std::isfinite(largest)) return largest;
  double sum = 0;
  for (std::size_t i = from; i < x.size(); ++i) sum += (x[i] / largest) * (x[i] / largest);
  return largest * std::sqrt(sum);
}

/// Solution of min |A x - b|, and the residual A x - b.  Columns that add nothing get the coefficient 0.
inline std::pair<std::vector<double>, std::vector<double>> solve_least_squares(Columns a, std::vector<double> b) {
  const std::size_t rows = b.size();
  const std::size_t columns = a.size();
  std::vector<double> scale(columns);
  std::vector<double> diagonal(columns, 0);
  std::vector<std::vector<double>> reflectors;
  for (std::size_t j = 0; j < columns; ++j) {
    scale[j] = norm_of(a[j]);
    for (double& value : a[j]) value = scale[j] > 0 ? value / scale[j] : 0;
  }
  const auto reflect = [rows](const std::vector<double>& v, std::size_t from, std::vector<double>& x) {
    double dot = 0;
    for (std::size_t i = from; i < rows; ++i) dot += v[i] * x[i];
    for (std::size_t i = from; i < rows; ++i) x[i] -= 2 * dot * v[i];
  };
  for (std::size_t j = 0; j < columns && j < rows; ++j) {
    std::vector<double> v(rows, 0);
    for (std::size_t i = j; i < rows; ++i) v[i] = a[j][i];
    const double length = norm_of(v, j);
    if (length > 1e-14) {
      diagonal[j] = v[j] > 0 ? -length : length;
      v[j] -= diagonal[j];
      const double size = norm_of(v, j);
      for (std::size_t i = j; i < rows; ++i) v[i] /= size;
      for (std::size_t k = j; k < columns; ++k) reflect(v, j, a[k]);
      reflect(v, j, b);
    } else {
      v.assign(rows, 0);
    }
    reflectors.push_back(std::move(v));
  }
  std::vector<double> x(columns, 0);
  for (std::size_t j = reflectors.size(); j-- > 0;) {
    if (diagonal[j] == 0) continue;
    double sum = b[j];
    for (std::size_t k = j + 1; k < columns; ++k) sum -= a[k][j] * x[k];
    x[j] = sum / diagonal[j];
  }
  std::vector<double> residual(rows, 0);
  for (std::size_t i = 0; i < rows; ++i) {
    const bool spanned = i < reflectors.size() && diagonal[i] != 0;
    residual[i] = spanned ? 0 : -b[i];
  }
  for (std::size_t j = reflectors.size(); j-- > 0;) reflect(reflectors[j], j, residual);
  for (std::size_t j = 0; j < columns; ++j) x[j] = scale[j] > 0 ? x[j] / scale[j] : 0;
  return {std::move(x), std::move(residual)};
}

struct ProjectedFit {
  std::vector<double> nonlinear;
  /// Sum of squares.
  double cost = std::numeric_limits<double>::infinity();
};

/// Levenberg-Marquardt over the parameters that enter nonlinearly; those that enter linearly are solved for at each
/// step.  `basis(theta)` gives the weighted columns of the linear ones, `target` what they shall add up to.
inline ProjectedFit fit_by_projection(const std::function<Columns(const std::vector<double>&)>& basis,
                                      const std::vector<double>& target, std::vector<double> theta, int iterations) {
  const auto residual_at = [&](const std::vector<double>& t) { return solve_least_squares(basis(t), target).second; };
  std::vector<double> residual = residual_at(theta);
  double norm = norm_of(residual);
  if (!std::isfinite(norm)) return {std::move(theta), std::numeric_limits<double>::infinity()};
  double damping = 1e-2;
  for (int iteration = 0; iteration < iterations && norm > 0; ++iteration) {
    Columns jacobian;
    for (std::size_t i = 0; i < theta.size(); ++i) {
      std::vector<double> moved = theta;
      const double step = 1e-6 * std::fmax(std::abs(theta[i]), 1e-3);
      moved[i] += step;
      std::vector<double> column = residual_at(moved);
      for (std::size_t k = 0; k < column.size(); ++k) column[k] = (column[k] - residual[k]) / step;
      jacobian.push_back(std::move(column));
    }
    bool improved = false;
    for (int attempt = 0; attempt < 8 && !improved; ++attempt) {
      Columns system = jacobian;
      std::vector<double> right = residual;
      for (double& value : right) value = -value;
      for (std::size_t i = 0; i < theta.size(); ++i) {
        const double length = norm_of(jacobian[i]);
        for (std::size_t j = 0; j < theta.size(); ++j) {
          system[j].push_back(i == j ? std::sqrt(damping) * (length > 0 ? length : 1) : 0);
        }
        right.push_back(0);
      }
      const std::vector<double> step = solve_least_squares(system, right).first;
      std::vector<double> moved = theta;
      for (std::size_t i = 0; i < theta.size(); ++i) moved[i] += step[i];
      std::vector<double> next = residual_at(moved);
      const double next_norm = norm_of(next);
      if (std::isfinite(next_norm) && next_norm < norm) {
        improved = next_norm < norm * (1 - 1e-4);
        theta = std::move(moved);
        residual = std::move(next);
        norm = next_norm;
        damping = std::fmax(damping / 5, 1e-12);
        if (!improved) return {std::move(theta), norm * norm};
      } else {
        damping *= 6;
      }
    }
    if (!improved) break;
  }
  return {std::move(theta), norm * norm};
}

}  // namespace judging
