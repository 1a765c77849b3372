// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "frac/identification/model_choice.hpp"
#include "frac/identification/outliers.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac {

/// What is fitted, where the form of the model may follow from the data.
struct ModelRequest {
  /// A formula with its constraints, or a family, of which the member is fitted that suits the data.
  NamedModel model = {};
  /// A family to grow() in, in the place of `model`, with its constraints.
  std::optional<GrowthFamily> grow = std::nullopt;
  /// Constraints of the member of a family, whose parameters are known with the data only; its own where empty.
  std::function<std::vector<ParameterConstraint>(const NamedModel& member)> constraints_of_member = {};
  /// Fits the component by itself, see component_alone(); over time without meaning.
  bool component_alone = false;
  /// A fit of the same formula to similar data, at which the search begins, see fit_from(); over time without meaning.
  std::optional<FitResult> similar = std::nullopt;
};

/// A fit and what of its options followed from the data.
struct ModelFit {
  FitResult result;
  std::vector<ParameterConstraint> constraints;
  bool global_start;
  std::optional<Growth> growth = std::nullopt;  // of a grown one

  /// The options that the result was made with.
  template <class Options>
  [[nodiscard]] Options options_from(Options asked) const {
    asked.constraints = constraints;
    asked.global_start = global_start;
    if constexpr (std::is_same_v<Options, TimeFitOptions>) {
      if (std::exchange(asked.noise, RecordNoise::white) == RecordNoise::coloured)
        asked.noise_correlation = result.noise_correlation;
    }
    return asked;
  }
};

/// @param options  their constraints do not count: those of the request do
/// @throws std::invalid_argument  as fit(), resolved_model() and grow()
[[nodiscard]] ModelFit fit(const FrequencyResponseData& data, const ModelRequest& request, const FitOptions& options);
[[nodiscard]] ModelFit fit(const TimeResponseData& data, const ModelRequest& request, const TimeFitOptions& options);

/// Fits points.kept(), takes back what of the other points the model meets, and then fits anew.
/// @param points  keeps and tells what was taken back
/// @throws std::invalid_argument  as above
[[nodiscard]] ModelFit fit(ScreenedData& points, const ModelRequest& request, const FitOptions& options);

/// The same with a ranking, whose chosen model takes points back.
/// @param curves  of a value for each of all points, those left out among them
/// @throws std::invalid_argument, NoCandidateFits  as identify()
[[nodiscard]] IdentificationResult identify(ScreenedData& points, const std::vector<NamedModel>& models,
                                            const std::vector<FixedCurve>& curves, const FitOptions& options,
                                            int threads = 0);

/// Curves without their values at the points that are left out.
[[nodiscard]] std::vector<FixedCurve> at_kept(const ScreenedData& points, std::vector<FixedCurve> curves);

}  // namespace frac
