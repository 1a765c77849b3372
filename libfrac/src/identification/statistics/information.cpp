// SPDX-License-Identifier: BSD-3-Clause
#include "information.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace frac::detail
