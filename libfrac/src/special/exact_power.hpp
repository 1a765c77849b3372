// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>

namespace frac::detail {

/// e^{j order pi/2}, exact for whole orders and to the last digit for any size of order.
[[nodiscard]] std::complex<double> quarter_turns(double order);

/// omega^order, omega > 0, correctly rounded for the orders -1, 0, 1/2, 1, 2.
[[nodiscard]] double real_power(double omega, double order);

}  // namespace frac::detail
