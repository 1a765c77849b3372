// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/identification/scene_identification.hpp"
#include "frac/identification/model_library.hpp"

namespace backlash {

enum class Explanation { two_masses, static_backlash, fractional, integer_order };
[[nodiscard]] std::string_view to_string(Explanation explanation);

/// One explanation of all curves together.
struct ExplanationFit {
  Explanation explanation;
  std::string name;  // of the structure for fractional and integer order
  double cost;       // sum of squared residuals over all curves
  double rms;
  std::size_t free_parameters;  // over all curves: a structure is fitted to each curve anew, the scenes to all at once
  double aicc;
  double delta_aicc;  // aicc minus the best one
};

struct SceneComparison {
  std::vector<ExplanationFit> ranking;  // the best of each explanation, best first
  std::size_t points;                   // compared, the same for all
  std::size_t residuals;
  std::vector<std::string> skipped;  // what could not be compared, with the reason
  std::string sentence;              // which explanation the data support
};

/// Says which of the two masses, the static backlash (its mass and clearance fitted), fractional and integer-order
/// structures explains the data best, by AICc over the same residuals.  Compared are the points at which the identified
/// scene has a definite motion, those far from it among them: they count against it.
/// @param identification  of identify_scene on the same curves with the same options; not one without a usable start
/// @throws std::invalid_argument  curves and identification do not belong together, or no point can be compared.
[[nodiscard]] SceneComparison compare_explanations(const std::vector<MeasuredDescribingFunction>& curves,
                                                   const SceneIdentificationOptions& options,
                                                   const SceneIdentification& identification,
                                                   const std::vector<frac::NamedModel>& models = frac::model_library());

}  // namespace backlash
