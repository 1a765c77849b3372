#pragma once

#include <span>
#include <vector>

#include "expression.hpp"
#include "frac/fractional_transfer_function.hpp"

namespace frac::detail {

/// e^{-delay s} numerator/denominator.
struct RatioOfPowerSums {
  std::vector<PowerTerm> numerator;  // empty: zero
  std::vector<PowerTerm> denominator;
  double delay = 0;
};

/// The expression at given parameter values as a ratio of sums of powers.
/// @throws std::invalid_argument  it is none; the text says which part.
[[nodiscard]] RatioOfPowerSums reduce(const Expression& expression, std::span<const double> parameters);

}  // namespace frac::detail
