// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace frac {

/// coefficient s^order.  Sums of them make the numerators and denominators of all models here; the order is any real
/// number.
struct PowerTerm {
  double coefficient;
  double order;
  bool operator==(const PowerTerm&) const = default;
};

/// (sum of terms)^power.
struct PowerFactor {
  std::vector<PowerTerm> sum;
  int power;  // 1 or more
  bool operator==(const PowerFactor&) const = default;
};

}  // namespace frac
