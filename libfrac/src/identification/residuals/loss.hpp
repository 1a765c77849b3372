// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/fit.hpp"

namespace frac::detail {

/// A loss at a residual of `x` times its scale, in units of that scale: twice rho (x^2 without a loss), its half
/// derivative psi, and the derivative of psi.
struct LossAt {
  double cost, psi, slope;
};
[[nodiscard]] LossAt loss_at(Loss loss, double x);

}  // namespace frac::detail
