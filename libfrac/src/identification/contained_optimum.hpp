// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "formula/containment.hpp"
#include "frac/identification/model_library.hpp"
#include "identification/data/fit_data.hpp"

namespace frac::detail {

/// Limits that were in force in a fit, in the order of the structure's parameters.
[[nodiscard]] std::vector<ParameterLimits> limits_in_force(const FitResult& fit);
/// Limits of a model by itself, on data of units 1.
[[nodiscard]] std::vector<ParameterLimits> limits_of(const NamedModel& model);

/// The presets with fewer parameters that the structure contains whatever their parameters are, but those that another
/// one of them contains.
/// @param limits  of the structure's parameters
[[nodiscard]] std::vector<const NamedModel*> largest_contained(const Structure& structure,
                                                               const std::vector<ParameterLimits>& limits);

/// Where a structure is another one at its optimum, to rounding where it is that as a limit; empty where it is not
/// within its limits.
[[nodiscard]] std::optional<std::vector<double>> start_from_contained(const NamedModel& rich, const FitResult& simple);

/// A fit of the richer structure started where it is the simpler one at its optimum, or next to it where it is that as
/// a limit.  Empty where it may not start there or is no such structure.
/// @param rich, simple  of the same data and options
/// @param options       with the limits of the richer structure
template <class Data>
[[nodiscard]] std::optional<FitResult> fit_from_contained(const Data& data, const FitResult& rich,
                                                          const FitResult& simple, const OptionsOf<Data>& options);

/// A searched fit that is no worse than any preset the structure contains, nor than the structure without one of the
/// terms of its outermost sum: where one is better, it is where the fit starts anew, with intervals from the curvature.
/// Fits with a robust loss stay as they are.
template <class Data>
[[nodiscard]] FitResult no_worse_than_contained(const Data& data, const Structure& structure,
                                                const OptionsOf<Data>& options, FitResult fit);

}  // namespace frac::detail
