// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frac/digital/fractional_pid_gains.hpp"
#include "frac/model/fractional_transfer_function.hpp"
#include "frac/stability.hpp"

namespace frac {

/// kp + ki s^-lambda + kd s^mu/(1 + derivative_filter_time s), exactly.
/// @throws std::invalid_argument  all gains 0, an entry not finite, derivative_filter_time (s) negative.
[[nodiscard]] FractionalTransferFunction controller_transfer_function(const FractionalPidGains& gains,
                                                                      double derivative_filter_time = 0);

/// |.| <= gain from a frequency on, or up to one.
struct GainBound {
  double omega;  // rad/s, > 0
  double gain;   // > 0
};

/// What a loop L = plant C is to have, with S = 1/(1 + L) and T = L/(1 + L).  What is not given is free.
struct LoopSpecification {
  std::optional<double> crossover = {};     // rad/s where |L| = 1
  std::optional<double> phase_margin = {};  // rad, arg L + pi there; needs crossover
  bool flat_phase = false;                  // d arg L/d omega = 0 there (iso-damping); needs crossover
  double max_sensitivity = std::numeric_limits<double>::infinity();                // max |S|
  double max_complementary_sensitivity = std::numeric_limits<double>::infinity();  // max |T|
  std::optional<GainBound> high_frequency = {};  // |T| <= gain for all omega >= omega: noise
  std::optional<GainBound> low_frequency = {};   // |S| <= gain for all omega <= omega: disturbances
};

/// What is made least among the controllers that keep the specification.
enum class TuningCriterion {
  sensitivity,  // max |S|
  iae,          // integral of |error| of a step response, simulated
  itae,         // integral of t |error|
};
/// sensitivity, iae, itae.
[[nodiscard]] std::string_view to_string(TuningCriterion criterion);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] TuningCriterion tuning_criterion_from_string(std::string_view text);
[[nodiscard]] std::span<const TuningCriterion> tuning_criteria();

/// Terms that the controller has.  A series PID is K (1 + 1/(Ti s)) (1 + Td s): the orders are 1 and the zeros real,
/// kp^2 >= 4 ki kd, as those of a position controller around a speed controller.
enum class ControllerStructure { pid, pi, pd, series };
/// pid, pi, pd, series.
[[nodiscard]] std::string_view to_string(ControllerStructure structure);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] ControllerStructure controller_structure_from_string(std::string_view text);
[[nodiscard]] std::span<const ControllerStructure> controller_structures();

struct OrderRange {
  double lower;
  double upper;
};

struct TuningOptions {
  ControllerStructure structure = ControllerStructure::pid;
  OrderRange lambda{0.1, 1.9};        // 0.001 to 1.999; lower = upper holds the order, 1 is the classical controller's
  OrderRange mu{0.1, 1.9};            // taken no further than leaves the loop falling at high frequency
  double derivative_filter_time = 0;  // s
  TuningCriterion criterion = TuningCriterion::sensitivity;
  bool load_step = false;  // the step of iae and itae enters at the plant's input instead of the set point
  double horizon = 0;      // s, of that step response; needed for iae and itae
  std::uint64_t seed = 1;  // of the global search
  /// What is made least instead of the criterion, from the controller and its value of the criterion; asked only of
  /// controllers that keep the specification, or its bounds to 2 %.  Ranked by its value up to 1e9.
  std::function<double(const FractionalPidGains& gains, double criterion)> objective = {};
};

/// What is within reach where not all that is asked of a crossover is: of each the nearest that was found, the other
/// demands kept.
struct FeasibleNearby {
  std::optional<double> phase_margin = {};                            // rad, at the crossover asked for
  std::optional<double> lower_crossover = {}, higher_crossover = {};  // rad/s, at the margin asked for
};

/// One line of the specification and what became of it.
struct ReachedSpecification {
  std::string name;  // e.g. "phase margin, deg"
  double asked;
  double reached;
  bool met;
};

enum class TuningStatus {
  met,      // closed loop stable and the whole specification kept
  not_met,  // no controller was found that keeps it; the nearest one is given
};
/// met, not-met.
[[nodiscard]] std::string_view to_string(TuningStatus status);

struct TuningResult {
  /// The closed loop is stable and the whole specification kept.
  [[nodiscard]] bool usable() const noexcept { return status == TuningStatus::met; }
  /// Gains, orders and what was reached.
  [[nodiscard]] std::string summary() const;

  FractionalPidGains gains;
  double derivative_filter_time = 0;  // s, as given
  TuningStatus status = TuningStatus::not_met;
  /// One sentence, one more for each other crossover, and one where mu_at_limit.
  std::string message;
  double mu_limit = 0;       // order of differentiation with which the loop falls as s^-0.2 at high frequency
  bool mu_at_limit = false;  // that limit, below options.mu.upper, holds back mu
  std::vector<ReachedSpecification> specification;
  FeasibleNearby nearby;                            // where a crossover and margin asked for are not met
  Stability closed_loop = Stability::undetermined;  // of the exact loop, dead time included, by the argument principle
  double crossover = 0;     // rad/s; of all with |L| = 1 the one nearest to what was asked, else the highest; NaN: none
  double phase_margin = 0;  // rad, there
  std::vector<Crossover> other_crossovers;  // where |L| = 1 besides
  double phase_slope = 0;                   // d arg L/d ln omega there, rad
  double gain_margin = 0;  // that of margins(): smallest factor above 1 with a pole on the axis; infinite: none
  /// Supremum over all omega, 1 at infinity where |S| stays below that.
  double max_sensitivity = 0;
  double omega_max_sensitivity = 0;
  double max_complementary_sensitivity = 0;
  double omega_max_complementary_sensitivity = 0;
  double iae = 0;   // NaN without a horizon, or where the loop is not stable; extrapolated from two step sizes
  double itae = 0;  // likewise
  int evaluations = 0;
};

/// Gains and orders of a fractional PID for a plant.  Crossover, phase margin and flat phase are linear in the gains
/// for given orders and hold to rounding; the orders, and what remains free of the gains, by a seeded global search
/// (CRS2) and a local one under the inequalities (COBYLA), gains not negative. Idea of the specification: Monje,
/// Vinagre, Feliu, Chen (2008).
/// @throws std::invalid_argument  a number out of range; flat phase or phase margin without crossover; no criterion:
/// the specification is empty and the criterion is not iae or itae; horizon missing; plant growing with frequency, or
/// with the least mu allowed the loop not falling.
[[nodiscard]] TuningResult tune(const FractionalTransferFunction& plant, const LoopSpecification& specification,
                                const TuningOptions& options = {});

}  // namespace frac
