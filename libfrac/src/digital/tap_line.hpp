#pragma once

#include <cstddef>

namespace frac::detail {

/// taps_0 x + sum taps_k past_(k-1) over an even number of taps, past_0 the newest.  Even and odd taps are summed
/// apart, which halves the time; the exported C code does the same and gives the same bits.
template <typename Real>
[[nodiscard]] inline Real tapped(const Real* taps, std::size_t count, const Real* past, Real x) noexcept {
  Real even = taps[0] * x;
  Real odd = taps[1] * past[0];
  for (std::size_t k = 2; k < count; k += 2) {
    even += taps[k] * past[k - 1];
    odd += taps[k + 1] * past[k];
  }
  return even + odd;
}

/// Takes x in as the newest of `count` samples.
template <typename Real>
inline void shift_in(Real* past, std::size_t count, Real x) noexcept {
  for (std::size_t k = count - 1; k > 0; --k) past[k] = past[k - 1];
  past[0] = x;
}

/// Filled up with a zero to an even number.
[[nodiscard]] constexpr std::size_t even_count(std::size_t taps) {
  return taps + taps % 2;
}

}  // namespace frac::detail
