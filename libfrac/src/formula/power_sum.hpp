// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/power_term.hpp"

namespace frac::detail {

/// Terms by falling order, equal orders added up, zero coefficients dropped.
[[nodiscard]] std::vector<PowerTerm> collected(std::vector<PowerTerm> terms);

/// Sum of two sums, what is left of terms that cancel to rounding dropped.
[[nodiscard]] std::vector<PowerTerm> merged(const std::vector<PowerTerm>& a, const std::vector<PowerTerm>& b);

/// @throws std::invalid_argument  the product has too many terms to be of use.
[[nodiscard]] std::vector<PowerTerm> product(const std::vector<PowerTerm>& a, const std::vector<PowerTerm>& b);

/// Each term times factor s^order.
[[nodiscard]] std::vector<PowerTerm> scaled(std::vector<PowerTerm> terms, double factor, double order);

}  // namespace frac::detail
