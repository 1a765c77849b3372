// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>
#include <string_view>

namespace frac {

/// In which sentences and axes name a frequency; numbers are rad/s everywhere.
enum class FrequencyUnit { rad_per_s, hertz };

/// "rad/s" or "Hz".
[[nodiscard]] constexpr std::string_view to_string(FrequencyUnit unit) {
  return unit == FrequencyUnit::hertz ? "Hz" : "rad/s";
}

/// @param omega  rad/s
[[nodiscard]] constexpr double in_unit(double omega, FrequencyUnit unit) {
  return unit == FrequencyUnit::hertz ? omega / (2 * std::numbers::pi) : omega;
}

}  // namespace frac
