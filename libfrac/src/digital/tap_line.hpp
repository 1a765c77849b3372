// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace frac::detail {

// taps_0 x + sum taps_k past_(k-1) over an even number of taps, past_0 the newest.  Even and odd taps are summed apart,
// which halves the time of a sum.  Every form below and the exported C code give the same bits.

/// past(k) gives the sample k + 1 steps ago.
template <typename Real, typename Past>
[[nodiscard]] inline Real tapped(const Real* taps, std::size_t count, const Past& past, Real x) noexcept {
  Real even = taps[0] * x;
  Real odd = taps[1] * past(0);
  for (std::size_t k = 2; k < count; k += 2) {
    even += taps[k] * past(k - 1);
    odd += taps[k + 1] * past(k);
  }
  return even + odd;
}

/// y_n for `size` samples x_n, before which `count` - 1 older ones lie in memory; y apart from x.
template <std::size_t size, typename Real>
inline void tapped_block(const Real* taps, std::size_t count, const Real* x, Real* y) noexcept {
  Real odd[size];
  for (std::size_t n = 0; n < size; ++n) y[n] = taps[0] * x[n];
  for (std::size_t n = 0; n < size; ++n) odd[n] = taps[1] * *(x + n - 1);
  for (std::size_t k = 2; k < count; k += 2) {
    const Real* const older = x - k;
    for (std::size_t n = 0; n < size; ++n) y[n] += taps[k] * older[n];
    for (std::size_t n = 0; n < size; ++n) odd[n] += taps[k + 1] * *(older + n - 1);
  }
  for (std::size_t n = 0; n < size; ++n) y[n] += odd[n];
}

/// Filled up with a zero to an even number.
[[nodiscard]] constexpr std::size_t even_count(std::size_t taps) {
  return taps + taps % 2;
}

}  // namespace frac::detail
