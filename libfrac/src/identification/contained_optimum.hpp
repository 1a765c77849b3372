// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/model_library.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac::detail {

/// A preset that contains a simpler one.
struct Containment {
  std::string_view rich, simple;
};
/// All of the library, simpler ones first.
[[nodiscard]] std::vector<Containment> containments();

/// The richer preset started where it is the simpler one at its optimum, or next to it where it is that as a limit.
/// Empty where it may not start there.
/// @param rich    as it is written among the candidates
/// @param simple  of the same data and options
[[nodiscard]] std::optional<FitResult> fit_from_contained(const FrequencyResponseData& data, const Containment& pair,
                                                          const NamedModel& rich, const FitResult& simple,
                                                          const FitOptions& options);
[[nodiscard]] std::optional<FitResult> fit_from_contained(const TimeResponseData& data, const Containment& pair,
                                                          const NamedModel& rich, const FitResult& simple,
                                                          const TimeFitOptions& options);

/// A searched fit that is no worse than any preset the structure contains: where one is better, it is where the fit
/// starts anew.  Structures that are no presets and fits with a robust loss stay as they are.
[[nodiscard]] FitResult no_worse_than_contained(const FrequencyResponseData& data, const Structure& structure,
                                                const FitOptions& options, FitResult fit);
[[nodiscard]] FitResult no_worse_than_contained(const TimeResponseData& data, const Structure& structure,
                                                const TimeFitOptions& options, FitResult fit);

}  // namespace frac::detail
