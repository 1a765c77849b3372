// SPDX-License-Identifier: BSD-3-Clause
#include "identification/statistics/first_order_likelihood.hpp"

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
  return likeliest_noise(count, [&](double r) {
    return 0.5 * std::log(1 - r * r) - 0.5 * count * std::log(whole - 2 * r * neighbours + r * r * inner);
  });
}

}  // namespace frac::detail
