// SPDX-License-Identifier: BSD-3-Clause
#include "identification/statistics/first_order_likelihood.hpp"

#include <algorithm>
#include <cmath>

namespace frac::detail {

// With innovations of one variance the sum of squares is that of the whole series, r times twice that of neighbours and
// r^2 times that of all but both ends; the first value adds the factor sqrt(1 - r^2).
FirstOrderNoise first_order_likelihood(std::span<const double> residual) {
  double whole = 0, neighbours = 0, inner = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    whole += residual[i] * residual[i];
    if (i > 0) neighbours += residual[i] * residual[i - 1];
    if (i > 0 && i + 1 < residual.size()) inner += residual[i] * residual[i];
  }
  const auto count = static_cast<double>(residual.size());
  const auto at = [&](double r) {
    return 0.5 * std::log(1 - r * r) - 0.5 * count * std::log(whole - 2 * r * neighbours + r * r * inner);
  };
  // Even steps of Fisher's z = atanh r, in which the peak has the width 1/sqrt(count); a third of it costs 1/18.
  const double last = std::atanh(0.999), step = std::min(0.05, 1 / (3 * std::sqrt(count)));
  FirstOrderNoise best{0, at(0)};
  for (double z = step; z < last; z += step) {
    const double r = std::tanh(z), here = at(r);
    if (here > best.logarithm) best = {r, here};
  }
  return best;
}

}  // namespace frac::detail
