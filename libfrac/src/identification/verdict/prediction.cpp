// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/prediction.hpp"

#include <algorithm>

namespace frac::detail {

std::vector<Block> even_blocks(std::size_t points, std::size_t count) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < count; ++i) blocks.emplace_back(i * points / count, (i + 1) * points / count);
  return blocks;
}

std::vector<Block> half_decades(const FrequencyResponseData& data) {
  // Over a longer gap structures of many parameters say nothing.
  const double count = 2 * std::log10(data.omega().back() / data.omega().front());
  return even_blocks(data.size(), static_cast<std::size_t>(std::clamp(std::round(count), 5.0, 10.0)));
}

std::vector<Block> end_blocks(const FrequencyResponseData& data) {
  const double half_decade = std::sqrt(10.0);
  const std::vector<double>& omega = data.omega();
  const auto below = std::upper_bound(omega.begin(), omega.end(), omega.front() * half_decade);
  const auto above = std::lower_bound(omega.begin(), omega.end(), omega.back() / half_decade);
  const auto lower = static_cast<std::size_t>(below - omega.begin());
  const auto upper = static_cast<std::size_t>(omega.end() - above);
  if (3 * (lower + upper) > 2 * omega.size()) return {};
  return {{0, lower}, {omega.size() - upper, omega.size()}};
}

}  // namespace frac::detail
