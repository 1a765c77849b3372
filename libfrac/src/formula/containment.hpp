// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "frac/structure.hpp"

namespace frac::detail {

/// Limits in force of a parameter, equal for one that is held.  A positive coefficient has the lower limit 0, which it
/// may only approach.
struct ParameterLimits {
  double lower, upper;
};

/// Where a richer structure is a simpler one: parameter i is values[i] smallness^rates[i], as a limit for smallness ->
/// 0 where a rate is not 0.
struct Containment {
  std::vector<double> values, rates;

  [[nodiscard]] bool is_limit() const;
  [[nodiscard]] std::vector<double> at(double smallness) const;
};

/// Parameters with which the richer structure has the response of the simpler one at the given values; empty where none
/// are found within the limits.  An oscillator is a lag where b2 -> 0, an integrator where K and b1 -> infinity
/// together.
///
/// Both are written as sums of terms c s^q times powers of further sums and functions.  In the simpler one all are
/// numbers.  In the richer one q is a linear form in the orders, c a product of powers of parameters.  Each term of the
/// simpler one is matched with one of the richer, in every way there is.  The orders then follow from linear equations,
/// the coefficients from linear equations for their logarithms.  Terms of the richer one that are left over have to
/// vanish: exponents w with which c grows as smallness^-w, such that all that is matched stays and all that is left
/// over falls behind it.  A term of the same power of s as a matched one may instead be a part of that.
/// @param unit_of_value, unit_of_omega  natural units, in which a parameter that is left open is about 1
[[nodiscard]] std::optional<Containment> contained_in(const Structure& rich, std::span<const ParameterLimits> limits,
                                                      const Structure& simple, std::span<const double> values,
                                                      double unit_of_value, double unit_of_omega);

}  // namespace frac::detail
