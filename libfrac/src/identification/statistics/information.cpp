// SPDX-License-Identifier: BSD-3-Clause
#include "information.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace frac::detail {

InformationCriteria criteria_of(double cost, double residuals, double parameters, double rounding_cost) {
  const double n = residuals, k = parameters + 1;
  const double fit = n * std::log(std::max(cost, rounding_cost) / n);
  return {n > k + 1 ? fit + 2 * k + 2 * k * (k + 1) / (n - k - 1) : std::numeric_limits<double>::infinity(),
          fit + k * std::log(n)};
}

Information information(std::span<const double> residual, double parameters, double unit) {
  Information result{};
  for (const double r : residual) {
    result.cost += r * r;
    result.max_residual = std::max(result.max_residual, std::abs(r));
  }
  const auto n = static_cast<double>(residual.size());
  result.rms = std::sqrt(result.cost / n);
  const InformationCriteria criteria = criteria_of(result.cost, n, parameters, n * 1e-28 * unit * unit);
  result.aicc = criteria.aicc;
  result.bic = criteria.bic;
  return result;
}

double heavy_tailed_misfit(std::span<const double> residual) {
  constexpr double degrees = 4;
  const auto n = static_cast<double>(residual.size());
  double variance = 0;
  for (const double r : residual) variance += r * r / n;
  if (!(variance > 0) || !std::isfinite(variance)) return std::numeric_limits<double>::infinity();
  // Each round weighs residuals by what the scale before makes of them (expectation and maximisation).
  constexpr int most_rounds = 200;
  for (int round = 0; round < most_rounds; ++round) {
    double next = 0;
    for (const double r : residual) next += (degrees + 1) * r * r / (degrees + r * r / variance) / n;
    const bool settled = std::abs(next - variance) <= 1e-9 * variance;
    variance = next;
    if (settled || !(variance > 0)) break;
  }
  if (!(variance > 0)) return std::numeric_limits<double>::infinity();
  double value = n * std::log(variance);
  for (const double r : residual) value += (degrees + 1) * std::log1p(r * r / (degrees * variance));
  const double norm =
      std::lgamma((degrees + 1) / 2) - std::lgamma(degrees / 2) - std::log(degrees * std::numbers::pi) / 2;
  return value - n * (2 * norm + 1 + std::log(2 * std::numbers::pi));
}

}  // namespace frac::detail
