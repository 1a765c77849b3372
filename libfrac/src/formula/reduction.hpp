// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "expression.hpp"
#include "frac/power_term.hpp"

namespace frac::detail {

/// Derivatives by each parameter; empty where none are wanted.
using Slope = std::vector<double>;

/// A term c s^q with its derivative by each parameter, (by_coefficient + by_order ln s) s^q: by_coefficient = dc,
/// by_order = c dq.
struct SensitiveTerm {
  double coefficient;
  double order;
  Slope by_coefficient;
  Slope by_order;
  bool operator==(const SensitiveTerm&) const = default;
};
void add_to(SensitiveTerm& sum, const SensitiveTerm& term);
[[nodiscard]] SensitiveTerm times(const SensitiveTerm& a, const SensitiveTerm& b);
[[nodiscard]] bool is_nothing(const SensitiveTerm& term);

/// Terms by falling order.  A coefficient may be 0 while its derivative is not.
using SensitiveSum = std::vector<SensitiveTerm>;

/// e^{-delay s} numerator/denominator.
struct RatioOfPowerSums {
  SensitiveSum numerator;  // empty: zero
  SensitiveSum denominator;
  double delay = 0;
  Slope delay_slope;
};

/// Whether the derivatives by all parameters are wanted too.
enum class Sensitivity { none, all };

/// The expression at given parameter values as a ratio of sums of powers.
/// @throws std::invalid_argument  it is none, or, with derivatives, a parameter is the power of a sum; the text says
///                                which part.
[[nodiscard]] RatioOfPowerSums reduce(const Expression& expression, std::span<const double> parameters,
                                      Sensitivity sensitivity = Sensitivity::none);

/// The terms alone, those with coefficient 0 left out.
[[nodiscard]] std::vector<PowerTerm> plain_terms(const SensitiveSum& sum);

}  // namespace frac::detail
