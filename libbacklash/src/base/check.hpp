// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/number_text.hpp"

namespace backlash::detail {

/// Shortest decimal text that reads back as the same number.
[[nodiscard]] inline std::string text(double value) {
  return frac::detail::number_text(value);
}

/// Each throws std::invalid_argument naming the quantity, its value and what is allowed.
void require_positive(std::string_view quantity, std::string_view unit, double value);
void require_not_negative(std::string_view quantity, std::string_view unit, double value);
void require_restitution(double value);
/// Positive, finite, strictly increasing, not empty; names the first index concerned.
void require_frequency_grid(const std::vector<double>& omega);

}  // namespace backlash::detail
