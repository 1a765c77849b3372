// SPDX-License-Identifier: BSD-3-Clause
#include "identification/search/thinned.hpp"

#include <algorithm>
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

std::optional<Thinned> binned(const FrequencyResponseData& data, const ResidualRule& rule, std::size_t count) {
  const bool is_difference =
      rule.form == ResidualForm::cartesian || rule.form == ResidualForm::real || rule.form == ResidualForm::imaginary;
  const std::vector<double>& from = data.omega();
  const double width = std::log(from.back() / from.front()) / static_cast<double>(count);
  if (!is_difference || !(width > 0)) return std::nullopt;
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  ResidualRule means{rule.form, {}, rule.unit, rule.floor};
  for (std::size_t first = 0, last = 0; first < from.size(); first = last) {
    const double end = from.front() * std::exp(width * (std::floor(std::log(from[first] / from.front()) / width) + 1));
    double largest = 0;  // squares of the weights themselves may overflow
    for (last = first; last < from.size() && (last == first || from[last] < end); ++last)
      largest = std::max(largest, rule.weight[last]);
    double sum = 0, shift = 0;
    std::complex<double> rest = 0;
    for (std::size_t i = first; i < last; ++i) {
      const double share = std::pow(rule.weight[i] / largest, 2);
      sum += share;
      shift += share * (from[i] - from[first]);
      rest += share * (data.value()[i] - data.value()[first]);
    }
    omega.push_back(from[first] + shift / sum);
    value.push_back(data.value()[first] + rest / sum);
    means.weight.push_back(largest * std::sqrt(sum));
  }
  return Thinned{{std::move(omega), std::move(value)}, std::move(means)};
}

}  // namespace frac::detail
