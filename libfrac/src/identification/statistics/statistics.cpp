// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/statistics.hpp"

#include <limits>

#include "information.hpp"
#include "special/distributions.hpp"

namespace frac {

double student_t_95(double degrees_of_freedom) {
  if (!(degrees_of_freedom >= 1)) return std::numeric_limits<double>::quiet_NaN();
  return detail::student_t_quantile(0.975, degrees_of_freedom);
}

InformationCriteria information_criteria(double cost, std::size_t residuals, std::size_t parameters,
                                         double rounding_cost) {
  return detail::criteria_of(cost, static_cast<double>(residuals), static_cast<double>(parameters), rounding_cost);
}

}  // namespace frac
