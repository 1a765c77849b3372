// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "frac/structure.hpp"

namespace frac::detail {

/// Unit of a parameter as [whole formula]^value_exponent [omega]^frequency_exponent.
struct ParameterDimension {
  double value_exponent;
  double frequency_exponent;
};

/// Units of the parameters that make the terms of every sum alike, the arguments of exp, tanh and coth dimensionless,
/// and the whole formula of unit [value], when s has the unit of a frequency and numbers have none: K/(T s^a + 1) gives
/// [value] for K and [omega]^-a for T.  Least squares where that cannot be met, smallest exponents where it leaves a
/// choice.
/// @param parameters  one value per parameter, of which those of role order are used.
[[nodiscard]] std::vector<ParameterDimension> parameter_dimensions(const Structure& structure,
                                                                   std::span<const double> parameters);

/// Whether the exponents of [value] meet all that is asked of them, so that parameters times a factor to these multiply
/// the whole formula by the factor: not where a number stands in a sum with the unit of the formula.
[[nodiscard]] bool scales_with_parameters(const Structure& structure, std::span<const double> parameters);

/// The same as far as it follows: empty where the formula leaves a choice, and for all parameters where no units of
/// theirs meet its conditions.
struct KnownDimension {
  std::optional<double> value_exponent, frequency_exponent;
};
/// A number that multiplies the whole formula may carry the unit of its value, if the parameters cannot.
[[nodiscard]] std::vector<KnownDimension> known_dimensions(const Structure& structure,
                                                           std::span<const double> parameters);

}  // namespace frac::detail
