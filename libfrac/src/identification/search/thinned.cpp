// SPDX-License-Identifier: BSD-3-Clause
#include "identification/search/thinned.hpp"

#include <cmath>
#include <complex>
#include <utility>
#include <vector>

namespace frac::detail {

Thinned thinned(const FrequencyResponseData& data, const ResidualRule& rule, std::size_t count) {
  const std::size_t size = data.size();
  std::vector<double> length(size, 0.0);
  for (std::size_t i = 1; i < size; ++i) {
    const std::complex<double> before = data.value()[i - 1], after = data.value()[i];
    const double mean = (std::abs(before) + std::abs(after)) / 2;
    length[i] = length[i - 1] + (mean > 0 ? std::abs(after - before) / mean : 0);  // at most 2: also of an outlier
  }
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  ResidualRule thin{rule.form, {}, rule.unit};
  const double total = length.back() > 0 ? length.back() : 1;
  double next = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const double place = 0.5 * static_cast<double>(i) / static_cast<double>(size) + 0.5 * length[i] / total;
    if (count < size && place < next && i + 1 < size) continue;
    next = (std::floor(place * static_cast<double>(count)) + 1) / static_cast<double>(count);
    omega.push_back(data.omega()[i]);
    value.push_back(data.value()[i]);
    thin.weight.push_back(rule.weight[i]);
  }
  return {{std::move(omega), std::move(value)}, std::move(thin)};
}

}  // namespace frac::detail
