// SPDX-License-Identifier: BSD-3-Clause
#include "robust.hpp"

#include <algorithm>
#include <cmath>

namespace frac::detail {
namespace {

/// Loss scales that keep 95 % efficiency on normal residuals (Huber 1981; Holland, Welsch 1977).
double tuning_constant(Loss loss) {
  return loss == Loss::huber ? 1.345 : 2.385;
}

/// Residuals below this, in units of the data, are rounding.
constexpr double rounding = 1e-13;

}  // namespace

double loss_cost(std::span<const double> residual, std::size_t per_point, const LocalOptions& options) {
  double sum = 0;
  for (std::size_t i = 0; i < residual.size(); i += per_point) {
    double square = 0;
    for (std::size_t k = 0; k < per_point; ++k) square += residual[i + k] * residual[i + k];
    sum += loss_at(options.loss, std::sqrt(square) / options.loss_scale).cost;
  }
  return sum * options.loss_scale * options.loss_scale;
}

double robust_spread(std::span<const double> residual) {
  std::vector<double> size(residual.begin(), residual.end());
  for (double& value : size) value = std::abs(value);
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  return 1.4826 * *middle;
}

std::vector<std::size_t> outliers(std::span<const double> residual, std::size_t per_point) {
  std::vector<std::size_t> points;
  const double limit = std::max(5 * robust_spread(residual), rounding);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const std::size_t point = i / per_point;
    if (std::abs(residual[i]) > limit && (points.empty() || points.back() != point)) points.push_back(point);
  }
  return points;
}

LocalOptions robust_refinement(Residuals& residuals, Loss loss, std::optional<double> scale, LocalSolution& solution) {
  LocalOptions options;
  options.loss = loss;
  if (scale) {
    options.loss_scale = *scale;
    residuals.set_loss(options.loss, options.loss_scale);
    solution = local_solve(residuals, solution.theta, options);
    return options;
  }
  double spread = robust_spread(residuals_at(residuals, solution.theta));
  for (int pass = 0; pass < 30 && spread > 0; ++pass) {
    options.loss_scale = tuning_constant(loss) * spread;
    residuals.set_loss(options.loss, options.loss_scale);
    solution = local_solve(residuals, solution.theta, options);
    const double next = robust_spread(residuals_at(residuals, solution.theta));
    const bool settled = std::abs(next - spread) <= 1e-3 * spread;
    spread = next;
    if (settled) break;
  }
  return options;
}

std::vector<double> residuals_at(const Residuals& residuals, std::span<const double> theta) {
  std::vector<double> residual(residuals.count());
  residuals.evaluate(theta, residual.data(), nullptr);
  return residual;
}

}  // namespace frac::detail
