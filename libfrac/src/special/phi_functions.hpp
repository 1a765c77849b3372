// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <span>

namespace frac::detail {

/// e^z - 1 to relative accuracy near 0.
[[nodiscard]] std::complex<double> expm1(std::complex<double> z);

/// value[n - 1] = phi_n(z) = sum_k z^k/(k+n)!, n = 1 .. value.size().
void phi(std::complex<double> z, std::span<std::complex<double>> value);

}  // namespace frac::detail
