// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numeric>
#include <string>

#include "backlash/identification/scene_identification.hpp"

namespace support {

/// Errors that count as none, relative to the truth: an interval reaches at least as far as `rounding`, and no estimate
/// within `near` is far off.
struct SceneAllowance {
  double rounding = 0, near = 0;
};

/// The estimates of one scene against the truth.  An estimate is stated where it is called identified, held where its
/// 95 % interval holds the truth, far off where it misses the truth by more than twice its interval on that side.
class SceneScore {
 public:
  SceneScore(const backlash::SceneIdentification& result, const backlash::TwoMassSystem& system,
             const SceneAllowance& allowance = {})
      : allowance_(allowance) {
    const std::array<double, 4> truth = {system.mass1(), system.mass2(), system.clearance(), system.restitution()};
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const backlash::SceneEstimate& estimate = result.parameters[k];
      if (estimate.fixed) continue;
      free[k] = 1;
      const bool holds = add(estimate, truth[k]);
      stated[k] = estimate.identified ? 1 : 0;
      held[k] = estimate.identified && holds ? 1 : 0;
    }
  }

  /// Counts one estimate.
  /// @return whether its interval holds the truth
  bool add(const backlash::SceneEstimate& estimate, double truth) {
    char shown[160];
    std::snprintf(shown, sizeof shown, " %s %.5g %s%.5g (%.5g..%.5g)", estimate.name.c_str(), truth,
                  estimate.identified ? "" : "? ", estimate.value, estimate.ci95_lower, estimate.ci95_upper);
    text += shown;
    const double rounding = allowance_.rounding * truth;
    const double lower = std::min(estimate.ci95_lower, estimate.value - rounding);
    const double upper = std::max(estimate.ci95_upper, estimate.value + rounding);
    const bool holds = lower <= truth && truth <= upper;
    if (!estimate.identified) return holds;
    const double half_width = truth > estimate.value ? upper - estimate.value : estimate.value - lower;
    far_off = far_off || std::abs(estimate.value - truth) > std::max(2 * half_width, allowance_.near * truth);
    answered = true;
    any_held = any_held || holds;
    return holds;
  }

  /// Whether something is stated, and each interval stated excludes the truth.
  [[nodiscard]] bool wrong() const { return answered && !any_held; }
  [[nodiscard]] const char* word() const { return wrong() ? "WRONG" : far_off ? "FAR" : "ok"; }

  std::array<int, 4> free{}, stated{}, held{};  // mass1, mass2, clearance, restitution: 0 or 1
  bool answered = false, any_held = false, far_off = false;
  std::string text;  // name, truth, estimate and interval of each

 private:
  SceneAllowance allowance_;
};

/// Sums over scenes.
struct SceneTally {
  int scenes = 0, unusable = 0, flagged = 0, answered = 0, wrong = 0, far_off = 0;
  std::array<int, 4> free{}, stated{}, held{};
  double seconds = 0;

  void add(const backlash::SceneIdentification& result, const SceneScore& score) {
    unusable += result.termination == frac::FitTermination::no_usable_start ? 1 : 0;
    flagged += result.misfits.empty() ? 0 : 1;
    answered += score.answered ? 1 : 0;
    wrong += score.wrong() ? 1 : 0;
    far_off += score.far_off ? 1 : 0;
    add(score.free, score.stated, score.held);
  }
  SceneTally& operator+=(const SceneTally& other) {
    scenes += other.scenes;
    unusable += other.unusable;
    flagged += other.flagged;
    answered += other.answered;
    wrong += other.wrong;
    far_off += other.far_off;
    add(other.free, other.stated, other.held);
    seconds += other.seconds;
    return *this;
  }
  [[nodiscard]] static int sum(const std::array<int, 4>& counts) {
    return std::accumulate(counts.begin(), counts.end(), 0);
  }

  /// The heads of the columns that print_held() fills.
  static void print_names() { std::printf(" mass1 | mass2 | clearance | restitution | all | coverage |"); }
  /// How many intervals of each parameter hold, of how many stated ones, and the same of all.
  void print_held() const {
    for (std::size_t k = 0; k < held.size(); ++k) std::printf(" %d of %d |", held[k], stated[k]);
    std::printf(" %d of %d | %.1f %% |", sum(held), sum(stated), 100.0 * sum(held) / std::max(1, sum(stated)));
  }

 private:
  void add(const std::array<int, 4>& of_free, const std::array<int, 4>& of_stated, const std::array<int, 4>& of_held) {
    for (std::size_t k = 0; k < 4; ++k) {
      free[k] += of_free[k];
      stated[k] += of_stated[k];
      held[k] += of_held[k];
    }
  }
};

}  // namespace support
