// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>

#include "frac/model/fractional_transfer_function.hpp"

namespace frac {

/// G(s) at any complex s (rad/s), dead time included, with the principal values of the powers: arg s in (-pi, pi], on
/// the branch cut the side that the sign of the imaginary part tells.  At s = 0 the limit: 0, a finite value or
/// infinity.  Not finite at a pole, and where G(s) exceeds a double.
[[nodiscard]] std::complex<double> laplace_value(const FractionalTransferFunction& model, std::complex<double> s);

}  // namespace frac
