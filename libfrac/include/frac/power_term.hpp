// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace frac {

/// coefficient s^order.  Sums of them make the numerators and denominators of all models here; the order is any real
/// number.
struct PowerTerm {
  double coefficient;
  double order;
  bool operator==(const PowerTerm&) const = default;
};

}  // namespace frac
