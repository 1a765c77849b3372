// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

namespace frac {

/// How an input runs between its samples.
enum class Hold {
  zero_order,   // constant until the next sample
  first_order,  // straight to the next sample
  /// As the one signal with nothing from half the sampling rate on that repeats itself and passes through the samples,
  /// at even steps of time.  It has run so for ever, and so has the output: the periodic steady state.
  band_limited,
};
/// zero-order, first-order, band-limited.
[[nodiscard]] std::string_view to_string(Hold hold);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] Hold hold_from_string(std::string_view text);
[[nodiscard]] std::span<const Hold> holds();

}  // namespace frac
