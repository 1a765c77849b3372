// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "special/distributions.hpp"

namespace frac {

double student_t_95(double degrees_of_freedom) {
  if (!(degrees_of_freedom >= 1)) return std::numeric_limits<double>::quiet_NaN();
  return detail::student_t_quantile(0.975, degrees_of_freedom);
}

InformationCriteria information_criteria(double cost, std::size_t residuals, std::size_t parameters,
                                         double rounding_cost) {
  const auto n = static_cast<double>(residuals);
  const auto k = static_cast<double>(parameters) + 1;
  const double fit = n * std::log(std::max(cost, rounding_cost) / n);
  return {n > k + 1 ? fit + 2 * k + 2 * k * (k + 1) / (n - k - 1) : std::numeric_limits<double>::infinity(),
          fit + k * std::log(n)};
}

}  // namespace frac
