// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/tune.hpp"

namespace frac {

/// The model of a fit with its values.
/// @throws std::invalid_argument  it is no ratio of sums of powers of s.
[[nodiscard]] FractionalTransferFunction fitted_plant(const FitResult& fit);

/// Plants that the data of a fit leave possible: on the border of the joint 95 % region of its parameters (F
/// quantile), at the ends of its principal axes and in seeded random directions besides.  A coefficient above 0 moves
/// by its logarithm, upwards only as far as its own size and from there in proportion; an order or a delay stays at 0
/// or above.
/// @param directions  random ones, on top of the axes
/// @throws std::invalid_argument  no covariance is known, or as fitted_plant.
[[nodiscard]] std::vector<FractionalTransferFunction> plants_of_region(const FitResult& fit,
                                                                       std::size_t directions = 64);

/// A controller for all plants of the region.
struct RobustTuningResult {
  /// The specification is kept by the fitted plant, and its inequalities on |S| and |T| by every plant of the region.
  [[nodiscard]] bool usable() const noexcept { return status == TuningStatus::met; }
  /// Controller, what the fitted plant makes of it, and the worst of the region.
  [[nodiscard]] std::string summary() const;

  TuningResult nominal;  // controller, and what the fitted plant makes of it
  TuningStatus status = TuningStatus::not_met;
  std::string message;         // one sentence
  std::size_t plants = 0;      // of the region, and others, that were looked at
  std::size_t not_stable = 0;  // of these, loops that are not stable
  /// Largest and smallest over the nominal loop and all stable loops of the region: max |S|, max |T|, phase margin in
  /// rad, crossover in rad/s.
  double max_sensitivity = 0;
  double max_complementary_sensitivity = 0;
  double least_phase_margin = 0;
  double lowest_crossover = 0, highest_crossover = 0;
};

/// Tunes for the fitted plant, and again with tighter bounds on max |S| and max |T| until every plant of the region
/// keeps those asked for.  Crossover, phase margin and flat phase are those of the fitted plant.  mu is searched where
/// the loop of every plant falls as s^-0.2 or faster at high frequency.
/// @param others  plants besides the region that have to keep the bounds too, such as those of other formulas that the
///                same data leave possible
/// @throws std::invalid_argument  as tune() for any of these plants, and plants_of_region().
[[nodiscard]] RobustTuningResult tune_for_region(const FitResult& fit, const LoopSpecification& specification,
                                                 const TuningOptions& options = {},
                                                 const std::vector<FractionalTransferFunction>& others = {});

}  // namespace frac
