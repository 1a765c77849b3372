// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace frac::detail {

/// So many significant digits, for sentences.
[[nodiscard]] inline std::string short_text(double value, int digits = 3) {
  std::array<char, 32> buffer;
  std::snprintf(buffer.data(), buffer.size(), "%.*g", digits, value);
  return buffer.data();
}

[[nodiscard]] inline std::string four_digits(double value) {
  return short_text(value, 4);
}

}  // namespace frac::detail
