// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace frac {

double student_t_95(double degrees_of_freedom) {
  if (!(degrees_of_freedom >= 1)) return std::numeric_limits<double>::quiet_NaN();
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.975);
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
