// SPDX-License-Identifier: BSD-3-Clause
#include "information.hpp"

#include <algorithm>
#include <cmath>

#include "frac/identification/statistics.hpp"

namespace frac::detail {

Information information(std::span<const double> residual, std::size_t parameters, double unit) {
  Information result{};
  for (const double r : residual) {
    result.cost += r * r;
    result.max_residual = std::max(result.max_residual, std::abs(r));
  }
  const auto n = static_cast<double>(residual.size());
  result.rms = std::sqrt(result.cost / n);
  const InformationCriteria criteria =
      information_criteria(result.cost, residual.size(), parameters, n * 1e-28 * unit * unit);
  result.aicc = criteria.aicc;
  result.bic = criteria.bic;
  return result;
}

}  // namespace frac::detail
