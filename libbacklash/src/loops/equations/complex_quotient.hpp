// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>

namespace backlash::detail {

/// a/b; the library's division also bears what leaves the range of numbers on the way, at ten times the cost.
inline std::complex<double> quotient(std::complex<double> a, std::complex<double> b) {
  const double size = std::norm(b);
  const bool is_plain = size > 1e-200 && size < 1e200 && std::norm(a) < 1e200;
  return is_plain ? a * std::conj(b) / size : a / b;
}

}  // namespace backlash::detail
