// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "scene_search.hpp"

namespace backlash::detail {

/// What is stated of data, whichever family their scenes are of.
struct SceneAnswer {
  std::vector<SceneEstimate> estimates;  // as the family states them, stretched over rivals
  std::vector<LocalScene> rivals;        // those that say something else, best first
  std::vector<std::string> free_directions;
  std::vector<std::string> misfits;
  bool is_tested = false;  // whether there could be misfits, see SceneAdequacy
  double residual_correlation = 0;
  double least_variance = 0;                    // that residuals count as
  std::vector<std::vector<double>> covariance;  // of the parameters
  double condition = 0;
  std::size_t rank = 0;
  std::vector<ScenePoint> points;
  std::size_t points_used = 0, residuals = 0;
  double cost = 0, rms = 0, max_residual = 0;
  bool converged = false;
};

/// Scenes of a wider family that the data do not tell from the best one.
struct UndecidedScenes {
  const SceneFamily* family = nullptr;
  std::vector<LocalScene> scenes;
};

/// @param found  with a usable best scene
/// @param sigma_is_measured  see SceneIdentificationOptions
[[nodiscard]] SceneAnswer answer_of(const SceneFamily& family, const SceneSearch& found, bool sigma_is_measured,
                                    const UndecidedScenes& undecided = {});

/// Leaves nothing identified but what is fixed.
void take_back(std::span<SceneEstimate> estimates);

/// The members that results of all families have, but parameters and covariance.
template <typename Result>
void fill_in(const SceneAnswer& answer, const SceneSearch& found, Result& result) {
  result.misfits = answer.misfits;
  result.residual_correlation = answer.residual_correlation;
  result.points = answer.points;
  result.points_used = answer.points_used;
  result.residuals = answer.residuals;
  result.free_parameters = answer.rank;
  result.cost = answer.cost;
  result.rms = answer.rms;
  result.max_residual = answer.max_residual;
  result.condition = answer.condition;
  result.termination = answer.converged ? frac::FitTermination::converged : frac::FitTermination::not_converged;
  result.starts = found.starts;
  result.starts_at_best = found.starts_at_best;
}

/// What a message says beside what all do.
struct MessageParts {
  std::string of_family;      // after what is determined
  bool ends = false;          // there: nothing else counts, but whether a given scene describes the data
  bool lists_rivals = false;  // elsewhere
  std::string of_misfit;      // where there are misfits, at the end
};
/// @param parameters  as they are stated
[[nodiscard]] std::string message_of(const SceneAnswer& answer, std::span<const SceneEstimate> parameters,
                                     const MessageParts& parts);

}  // namespace backlash::detail
