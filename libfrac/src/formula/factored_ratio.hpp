// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "expression.hpp"
#include "frac/power_term.hpp"

namespace frac::detail {

/// numerator/denominator.  Every sum starts at the order 0; a factor of a single term stands first.
struct FactoredRatio {
  std::vector<PowerFactor> numerator;
  std::vector<PowerFactor> denominator;
};

/// The factors that an expression is written in, dead time left out: powers of sums stay powers, and a sum of fractions
/// has their least common denominator.  Empty where neither part has more than one factor of several terms, so that
/// its expansion says the same, and where the expression is no ratio of sums of powers of s.
[[nodiscard]] std::optional<FactoredRatio> factored_ratio(const Expression& expression,
                                                          std::span<const double> parameters);

}  // namespace frac::detail
