// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "backlash/identification/scene_identification.hpp"
#include "backlash/loops/linear_bodies.hpp"
#include "frac/structure.hpp"

namespace backlash {

/// Two bodies with clearance whose receptances have names in them, such as 1/(m1 s^2 + b1 s).  A name that stands in
/// both has one value.
struct BodiesStructure {
  frac::Structure load;   // displacement per force of body 1, m/N
  frac::Structure drive;  // that of body 2, on which the force acts

  /// @param values  of the parameters in the order of BodiesIdentification, clearance and restitution at the end
  /// @throws std::invalid_argument  as LinearBodies.
  [[nodiscard]] LinearBodies bodies(const std::vector<double>& values) const;
};

/// What describing functions tell of bodies with friction and springs.
struct BodiesIdentification {
  /// The search settled.  SceneEstimate::identified says which parameters the data determine.
  [[nodiscard]] bool usable() const noexcept { return termination == frac::FitTermination::converged; }
  /// Parameters with their 95 % intervals, and the message.
  [[nodiscard]] std::string summary() const;

  /// Names in the formula of the load, those of the drive that are not in it, clearance, restitution.
  std::vector<SceneEstimate> parameters;
  std::vector<std::string> misfits;  // as in SceneIdentification
  double residual_correlation;       // of neighbours; 0 where it may be chance
  std::vector<ScenePoint> points;
  std::size_t points_used;
  std::size_t residuals;                        // count
  std::size_t free_parameters;                  // count of what the data determine
  double cost;                                  // sum of squared residuals of the points used
  double rms;                                   // sqrt(cost/residuals)
  double max_residual;                          // largest part of a residual used, in magnitude
  double condition;                             // of the scaled Fisher matrix; above 1e6 a direction counts as free
  std::vector<std::vector<double>> covariance;  // NaN beside a parameter without standard error, 0 beside fixed
  frac::FitTermination termination;
  std::string message;         // one sentence
  std::size_t starts;          // local solves made
  std::size_t starts_at_best;  // of which ended at the same estimate
  double seconds;

  /// The bodies at the estimate; empty without a usable start.
  std::optional<LinearBodies> bodies;
};

/// Estimates the parameters of both receptances, clearance and restitution from describing functions at one or several
/// force amplitudes.  Where both bodies are free masses identify_scene() knows more motions and is faster.
///
/// The model of a point is the symmetric orbit of two impacts per period, exact and from sums over its harmonics, where
/// it exists and is stable; of x2 also a drive that moves without impacts.  Points where the bodies move in another way
/// (asymmetric, more impacts, rests in contact, irregular) are left out and listed as irregular; those far from the
/// orbit as off-branch.  A point left out costs as much evidence as in identify_scene().
///
/// The search begins with masses, clearance and restitution from the grid of identify_scene(), friction and springs at
/// 1 and 20 % of the forces of inertia, and orders at 1 unless they have starts of their own.  What is known of an
/// order should be given: over a short band mass, friction and its order take each other's place.  Masses are positive;
/// friction and springs, the coefficients that move no mass, are estimated from 0 on unless a lower limit below it is
/// given, and the intervals of the others hold for all of it that the data allow, also where the estimate is 0.  With
/// such a limit the answer is that from 0 on where the search finds no steady motion with it.  Where
/// fewer than twice as many residuals as parameters lie on the orbit nothing is estimated.
/// @param options  constraints by the names in the formulas, clearance and restitution; contacts take no time and
///                 bodies have no dry friction
/// @throws std::invalid_argument  as identify_scene() and LinearBodies; a formula that uses the names clearance or
///                                restitution; a limit below 0 of a mass or of the clearance, or of restitution
///                                beyond [0, 1]; contacts asked to be compliant, friction asked for.
[[nodiscard]] BodiesIdentification identify_bodies(const std::vector<MeasuredDescribingFunction>& curves,
                                                   const BodiesStructure& structure,
                                                   const SceneIdentificationOptions& options = {});

}  // namespace backlash
