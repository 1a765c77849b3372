// SPDX-License-Identifier: BSD-3-Clause
#include "identification/data/first_order_whitening.hpp"

#include <cmath>

namespace frac::detail {

FirstOrderWhitening::FirstOrderWhitening(const std::vector<std::size_t>& index, double r) {
  if (r == 0) return;
  for (std::size_t i = 0; i < index.size(); ++i) {
    carried_.push_back(i == 0 ? 0 : std::pow(r, static_cast<double>(index[i] - index[i - 1])));
    factor_.push_back(1 / std::sqrt((1 - carried_.back()) * (1 + carried_.back())));
  }
}

void FirstOrderWhitening::apply(std::span<double> values) const {
  if (changes_nothing()) return;
  for (std::size_t i = values.size(); i-- > 1;) values[i] = factor_[i] * (values[i] - carried_[i] * values[i - 1]);
}

}  // namespace frac::detail
