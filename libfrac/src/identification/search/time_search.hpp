// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

#include "frac/identification/time_fit.hpp"
#include "global_search.hpp"
#include "identification/residuals/time_residuals.hpp"

namespace frac::detail {

/// Simulations of the final solve, at rounding.
inline constexpr double finest_simulation = 1e-13;

/// The data of a fit over time and how its residuals are formed.
struct TimeProblem {
  const TimeResponseData& data;
  const Structure& structure;
  const ParameterMap& map;
  const TimeFitOptions& options;
  double unit;  // of the residuals
  /// Cost, in the unit of FitResult, above which nobody looks about the best fit to the transforms.
  double hopeless = std::numeric_limits<double>::infinity();
  double settled = LocalOptions{}.cost_tolerance;  // of the last solve

  [[nodiscard]] TimeResiduals residuals(std::vector<std::size_t> index, double tolerance) const {
    return {data,      structure, map, {options.offset, options.trend, options.earlier_input}, std::move(index),
            tolerance, unit};
  }
};

[[nodiscard]] bool is_complete(const std::vector<double>& start, const ParameterMap& map);

/// Fits the Laplace transforms of the record, weighed towards its beginning in three ways, and simulations of a part of
/// the samples from there and from the given starts; then looks about the best of them, seeded, until enough of the
/// solves from there come back.  The best ends in a solve of all samples.
[[nodiscard]] GlobalSolution time_search(const TimeProblem& problem);

}  // namespace frac::detail
