// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "contact_response.hpp"
#include "scene_model.hpp"

namespace backlash::detail {

struct SceneBounds {
  SceneVector lower, upper;  // equal where fixed
  [[nodiscard]] bool is_free(std::size_t k) const { return lower[k] < upper[k]; }
  [[nodiscard]] bool has_friction() const { return upper[first_friction] > 0 || upper[first_friction + 1] > 0; }
  [[nodiscard]] std::size_t free_count() const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < scene_size; ++k) count += is_free(k) ? 1 : 0;
    return count;
  }
};

/// The steady motion a point is compared with.
struct PointChoice {
  /// two_impact: also the symmetric orbit of contacts that take time; sticking: also any other orbit of one period of
  /// these, and any of masses with friction.
  enum class Kind { none, two_impact, sticking, free };
  Kind kind = Kind::none;
  bool used = false;           // forms residuals, see scene_evidence
  std::complex<double> model;  // at the estimate; of kind none: about where an irregular motion has its mean
  int means = 0;               // of kind none: motions it may have, of which model is the nearest; 0: not known
  double accuracy = 0.03;      // of kind none: to which share N of such a motion is known; here means of a table, of
                               // which half lie within that of the irregular points, one in ten beyond 10 %
  double misfit = 0;           // |model - data| of the fitted parts over its deviation; 0 of kind none
};

/// Of one point: its residuals and their derivatives.  The second ones are 0 when there is only one.
struct PointResiduals {
  std::array<double, 2> value{};
  std::array<std::array<double, 2>, scene_size> gradient{};
};

/// Sums of products over the residuals.
struct NormalEquations {
  std::array<std::array<double, scene_size>, scene_size> matrix{};
  std::array<double, scene_size> gradient{};
  double cost = 0;
  std::size_t residuals = 0;
  std::vector<PointResiduals> points;  // what the sums are made of
};
/// At an estimate, each residual divided by its deviation at that estimate; points whose motion has ended do not enter.
struct LocalScene;
[[nodiscard]] NormalEquations normal_equations(const SceneData& data, const LocalScene& local);

struct LocalScene {
  SceneVector theta{};
  std::vector<PointChoice> choices;
  // Per point, at the place of its motion, where the contact time is not held at 0, else empty; so with friction.
  std::vector<FoundMotions> found;
  std::vector<FoundOrbit> orbits;  // per point where friction is not held at 0, else empty
  double deviance = 0;             // see scene_evidence
  bool converged = false;
  bool usable = false;  // at least as many residuals as free parameters
};

enum class Effort {
  glance,  // a few steps with what a table knows of sticking motion, to see whether the place is worth more
  rough,   // with the table until nothing changes
  settle,  // with exact motions until nothing changes
};

/// Motions that points may be compared with.
enum class Motions {
  all,
  two_impact,  // in closed form, so that many starts cost little
};

/// Alternates between choosing the steady motion of each point at the estimate and least squares over the points with
/// which the evidence is greatest, until neither changes.
[[nodiscard]] LocalScene solve_scene(const SceneData& data, const SceneBounds& bounds, const SceneVector& start,
                                     Effort effort, Motions motions);

}  // namespace backlash::detail
