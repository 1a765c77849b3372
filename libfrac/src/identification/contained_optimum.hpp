// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "formula/containment.hpp"
#include "frac/identification/model_library.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/statistics/curvature_fit.hpp"

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

/// Whether a structure is another one at its optimum, within its limits in force.
[[nodiscard]] bool contains(const FitResult& rich, const FitResult& simple);

/// How a structure is fitted: by a search, from start values alone, or as refit() does.
enum class FitFrom { search, start, search_for_residuals };
/// Fits structures to the same data under the same weights, each with its constraints.
using FitOfData = std::function<FitResult(const Structure&, const std::vector<ParameterConstraint>&, FitFrom)>;

/// A fit of the richer structure started where it is the simpler one at its optimum, or next to it where it is that as
/// a limit.  Empty where it may not start there or is no such structure.
/// @param rich, simple  of the same data
/// @param constraints   with the limits of the richer structure
[[nodiscard]] std::optional<FitResult> fit_from_contained(const FitResult& rich, const FitResult& simple,
                                                          const std::vector<ParameterConstraint>& constraints,
                                                          const FitOfData& fit_of);
/// The same of data with options.
template <class Data>
[[nodiscard]] std::optional<FitResult> fit_from_contained(const Data& data, const FitResult& rich,
                                                          const FitResult& simple, OptionsOf<Data> options) {
  options.global_start = false;
  const std::vector<ParameterConstraint> given = options.constraints;
  return fit_from_contained(rich, simple, given, [&](const Structure& structure, const auto& constraints, FitFrom) {
    options.constraints = constraints;
    return fit(data, structure, options);
  });
}

/// A searched fit that is no worse than any preset the structure contains, nor than the structure without one of the
/// terms of its outermost sum: where one is better, it is where the fit starts anew, with intervals from the curvature.
[[nodiscard]] FitResult no_worse_than_contained(const Structure& structure,
                                                const std::vector<ParameterConstraint>& constraints,
                                                const FitOfData& fit_of, FitResult fit);
/// The same of data with options.  Fits with a robust loss stay as they are.
template <class Data>
[[nodiscard]] FitResult no_worse_than_contained(const Data& data, const Structure& structure, OptionsOf<Data> options,
                                                FitResult fit) {
  if (options.loss != Loss::none) return fit;
  // All structures compared have the same weights.
  if constexpr (is_response<Data>) options = settled(options, fit);
  return no_worse_than_contained(
      structure, options.constraints,
      [&](const Structure& each, const auto& constraints, FitFrom from) {
        OptionsOf<Data> own = options;
        own.constraints = constraints;
        if (from == FitFrom::start) own.global_start = false;
        return from == FitFrom::search_for_residuals ? refit(data, each, own) : unprofiled_fit(data, each, own);
      },
      std::move(fit));
}

}  // namespace frac::detail
