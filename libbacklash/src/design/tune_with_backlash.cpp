// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/design/tune_with_backlash.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "loop_stepper.hpp"

namespace backlash {
namespace {

constexpr double pi = std::numbers::pi;
constexpr const char* cycle_constraint = "no limit cycle";

// Impacts reach all frequencies: the loop is to fall at least as s^-0.5 there, or no step of a simulation, and no
// sample time of a controller, is short enough.
double steepest_mu(const frac::TuningOptions& options) {
  return 1.5 + (options.derivative_filter_time > 0 ? 1 : 0);
}

// Half of what the measured body of a cycle goes from peak to peak; the halves of its period are mirror images.
double swing_of(const SymmetricCycle& cycle, Output measured) {
  constexpr int instants = 200;
  double largest = 0;
  for (int i = 0; i < instants; ++i) {
    double position = 0;
    for (const CycleHarmonic& harmonic : cycle.harmonics) {
      const std::complex<double> phasor = measured == Output::x1 ? harmonic.x1 : harmonic.x2;
      position += (phasor * std::polar(1.0, harmonic.order * pi * i / instants)).real();
    }
    largest = std::max(largest, std::abs(position));
  }
  return largest;
}

// Half of peak to peak over a part of the samples.
double swing_of(const std::vector<double>& positions, double from, double to) {
  const auto at = [&](double share) {
    return positions.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(positions.size()));
  };
  const auto [low, high] = std::minmax_element(at(from), at(to));
  return (*high - *low) / 2;
}

// The largest cycle, with its swing.
struct Largest {
  const SymmetricCycle* cycle = nullptr;
  double swing = 0;
};

class Design {
 public:
  Design(const BacklashPlant& plant, double crossover, const frac::TuningOptions& options)
      : plant_(plant), crossover_(crossover), filter_time_(options.derivative_filter_time), fastest_(10 * crossover) {
    is_quick_ = plant.bodies.are_free() && plant.measured == Output::x1 && filter_time_ == 0;
  }

  // Cycles as fast as these may be looked for.  Faster than some crossovers no model holds.
  void allow(const std::vector<SymmetricCycle>& cycles) {
    for (const SymmetricCycle& cycle : cycles) fastest_ = std::max(fastest_, cycle.omega);
  }
  [[nodiscard]] bool is_at_limit(const std::vector<SymmetricCycle>& cycles) const {
    return is_quick_ && !cycles.empty() && cycles.back().omega > 0.99 * fastest_;
  }
  [[nodiscard]] double fastest() const { return fastest_; }

  // What tune() is to make least: the criterion where nothing persists, and far above it the swing.
  [[nodiscard]] double worth(const frac::FractionalPidGains& gains, double criterion) {
    constexpr double nothing_known = 1e8, with_motion = 1e4;
    const std::optional<double> swing = quick_swing(gains);
    if (!swing) return nothing_known;
    return *swing > 0 ? with_motion * (1 + std::min(*swing / clearance(), 1e3)) : std::min(criterion, with_motion);
  }

  // All of it, for an answer.
  [[nodiscard]] PersistentMotion persistent(const frac::FractionalPidGains& gains) const {
    const LimitCycles found = cycles_of(gains, many_harmonics);
    PersistentMotion motion{{}, found.searched, found.certain, 0, {}, false};
    const Largest largest = largest_of(found);
    for (const SymmetricCycle& cycle : found.cycles) {
      if (cycle.admissible) motion.cycles.push_back(cycle);
    }
    if (detail::can_be_stepped(plant_.bodies)) {
      for (const double speed : {0.1, 1.0, 10.0})
        motion.simulations.push_back(simulated(gains, speed, rate_of(largest), fine_steps));
    }
    double simulated_swing = 0;
    bool comes_to_it = false;
    for (const SimulatedMotion& each : motion.simulations) {
      constexpr double of_steps = 0.08;
      if (!each.dies_out) simulated_swing = std::max(simulated_swing, each.swing);
      comes_to_it = comes_to_it || std::abs(each.swing - largest.swing) <= of_steps * largest.swing;
    }
    const bool is_stable = largest.cycle != nullptr && largest.cycle->stability.stable;
    motion.swing = is_stable && (comes_to_it || motion.simulations.empty()) ? largest.swing
                   : is_stable                                              ? std::max(largest.swing, simulated_swing)
                                                                            : simulated_swing;
    motion.verified = !motion.simulations.empty() && (!is_stable || comes_to_it);
    return motion;
  }

  [[nodiscard]] double clearance() const { return plant_.bodies.system().clearance(); }

 private:
  static constexpr int few_harmonics = 40, many_harmonics = 200;
  static constexpr double coarse_steps = 600, fine_steps = 2000;  // per period
  // What persists, as far as a search can afford to know; empty where it is not known or too fast.
  [[nodiscard]] std::optional<double> quick_swing(const frac::FractionalPidGains& gains) {
    constexpr int most_simulated = 300, most_exact = 1000;
    if (is_quick_) {
      if (++exact_ > most_exact) return {};
      const LimitCycles found = cycles_of(gains, few_harmonics);
      for (const SymmetricCycle& cycle : found.cycles) {
        if (cycle.admissible && cycle.omega > fastest_) return {};
      }
      const Largest largest = largest_of(found);
      if (largest.cycle != nullptr && largest.cycle->stability.stable) return largest.swing;
    }
    if (simulated_ >= most_simulated || !detail::can_be_stepped(plant_.bodies)) return {};
    ++simulated_;
    double swing = 0;
    for (const double speed : {1.0, 10.0}) {
      const SimulatedMotion motion = simulated(gains, speed, crossover_, coarse_steps);
      if (!motion.dies_out) swing = std::max(swing, motion.swing);
    }
    return swing;
  }

  [[nodiscard]] LimitCycles cycles_of(const frac::FractionalPidGains& gains, int harmonics) const {
    LimitCycleOptions request;
    request.harmonics = harmonics;
    return symmetric_cycles({plant_.bodies, frac::controller_transfer_function(gains, filter_time_), plant_.measured},
                            request);
  }

  [[nodiscard]] Largest largest_of(const LimitCycles& found) const {
    Largest largest;
    for (const SymmetricCycle& cycle : found.cycles) {
      if (!cycle.admissible) continue;
      const double swing = swing_of(cycle, plant_.measured);
      if (swing > largest.swing) largest = {&cycle, swing};
    }
    return largest;
  }

  // Frequency of the fastest motion that a simulation has to show, rad/s.
  [[nodiscard]] double rate_of(const Largest& largest) const {
    return std::max(crossover_, largest.cycle == nullptr ? 0 : largest.cycle->omega);
  }

  // @param rate   rad/s, of the fastest thing to be seen
  // @param speed  of the driven body at the start, in clearances per time 1/crossover
  [[nodiscard]] SimulatedMotion simulated(const frac::FractionalPidGains& gains, double speed, double rate,
                                          double steps_per_period) const {
    constexpr double most_steps = 4e5, least = 0.01, still_falls = 0.9;
    const double step = 2 * pi / (steps_per_period * rate);
    SimulatedMotion motion{speed * crossover_ * clearance(), 0, 0, false};
    // What still falls is followed for longer.
    for (const double periods : {40.0, 160.0}) {
      const auto steps = static_cast<std::size_t>(std::min(2 * pi * periods / (crossover_ * step), most_steps));
      const std::vector<double> positions =
          detail::step_loop({plant_.bodies, plant_.measured, gains, filter_time_}, motion.speed, step, steps);
      if (positions.size() < steps) {
        motion.before = motion.swing = std::numeric_limits<double>::infinity();
        return motion;
      }
      motion.before = swing_of(positions, 0.5, 0.75);
      motion.swing = swing_of(positions, 0.75, 1);
      motion.dies_out = motion.swing <= least * clearance() && motion.swing <= motion.before;
      if (motion.dies_out || motion.swing > still_falls * motion.before) break;
    }
    return motion;
  }

  const BacklashPlant& plant_;
  double crossover_, filter_time_;
  double fastest_;  // rad/s
  bool is_quick_ = false;
  int exact_ = 0, simulated_ = 0;
};

void add_demands(const frac::LoopSpecification& asked, const frac::TuningResult& result,
                 std::vector<TuningConstraint>& constraints) {
  // Where a bound holds the answer the search stops within this share of it.
  constexpr double at_bound = 0.99;
  std::size_t equations = 1;
  if (asked.phase_margin) ++equations;
  if (asked.flat_phase) ++equations;
  for (std::size_t i = 0; i < result.specification.size(); ++i) {
    const frac::ReachedSpecification& line = result.specification[i];
    constraints.push_back(
        {line.name, line.asked, line.reached, i < equations || line.reached >= at_bound * line.asked});
  }
}

void add_limits(const frac::TuningOptions& options, const frac::TuningResult& result,
                std::vector<TuningConstraint>& constraints) {
  constexpr double at_end = 1e-3;
  const frac::FractionalPidGains& gains = result.gains;
  const auto order = [&](const std::string& name, double gain, double value, frac::OrderRange range) {
    if (gain == 0) return;
    if (range.lower == range.upper) {
      constraints.push_back({name + " held", range.lower, value, true});
      return;
    }
    if (value < range.lower + at_end) constraints.push_back({name + " at its lower end", range.lower, value, true});
    if (value > range.upper - at_end) constraints.push_back({name + " at its upper end", range.upper, value, true});
  };
  order("lambda", gains.ki, gains.lambda, options.lambda);
  order("mu", gains.kd, gains.mu, {options.mu.lower, std::min(options.mu.upper, result.mu_limit)});
  const auto gain = [&](const char* name, double value, bool is_used) {
    if (is_used && value == 0) constraints.push_back({std::string(name) + " not negative", 0, 0, true});
  };
  gain("kp", gains.kp, true);
  gain("ki", gains.ki, options.structure != frac::ControllerStructure::pd);
  gain("kd", gains.kd, options.structure != frac::ControllerStructure::pi);
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string motion_text(const PersistentMotion& motion) {
  if (std::isinf(motion.swing)) return "a simulation that runs away";
  std::string text = "a motion of " + number(motion.swing) + " m to either side";
  const SymmetricCycle* largest = nullptr;
  for (const SymmetricCycle& cycle : motion.cycles) {
    if (cycle.stability.stable) largest = &cycle;
  }
  if (largest != nullptr) text += " at " + number(largest->omega) + " rad/s";
  return text;
}

std::string message_of(const BacklashTuning& result) {
  if (!result.usable()) return result.linear.message;
  const double without = result.of_regardless.swing, left = result.persistent.swing;
  std::string text;
  if (left == 0 && without == 0) {
    text = "No motion persists; the clearance changes nothing about the answer.";
  } else if (left == 0) {
    text = "No motion persists. The clearance is an active constraint: without regard to it max |S| would be " +
           number(result.regardless.max_sensitivity) + " instead of " + number(result.linear.max_sensitivity) +
           ", with " + motion_text(result.of_regardless) + ".";
  } else {
    text = "No controller was found that keeps the demands and leaves no motion; the smallest is " +
           motion_text(result.persistent) + " (without regard to it " +
           (std::isinf(without) ? "a simulation runs away" : number(without) + " m") + "). It is held there by";
    const char* separator = " ";
    for (const TuningConstraint& constraint : result.constraints) {
      if (!constraint.active || constraint.name == cycle_constraint) continue;
      text += separator + constraint.name;
      separator = "; ";
    }
    text += ".";
  }
  if (result.persistent.simulations.empty()) {
    text += " No simulation has verified it: it needs receptances 1/(M s^2 + sum of c s^a).";
  } else if (!result.persistent.verified) {
    text += " Simulations do not come to that cycle.";
  }
  return text;
}

}  // namespace

std::string BacklashTuning::summary() const {
  return usable() ? linear.summary() + " " + message : linear.summary();
}

BacklashTuning tune_with_backlash(const BacklashPlant& plant, const frac::LoopSpecification& specification,
                                  const frac::TuningOptions& options) {
  if (!specification.crossover) throw std::invalid_argument("tune with backlash: needed is a crossover");
  if (options.objective) throw std::invalid_argument("tune with backlash: the objective is that of the motions left");
  const frac::FractionalTransferFunction rigid = rigid_receptance(plant.bodies);
  frac::TuningOptions falling = options;
  falling.mu.upper = std::max(options.mu.lower, std::min(options.mu.upper, steepest_mu(options)));
  BacklashTuning result;
  result.regardless = frac::tune(rigid, specification, falling);
  result.linear = result.regardless;
  Design design(plant, *specification.crossover, options);
  if (result.regardless.usable()) {
    result.persistent = result.of_regardless = design.persistent(result.regardless.gains);
    if (result.of_regardless.swing > 0) {
      design.allow(result.of_regardless.cycles);
      frac::TuningOptions with_motions = falling;
      with_motions.objective = [&](const frac::FractionalPidGains& gains, double criterion) {
        return design.worth(gains, criterion);
      };
      frac::TuningResult found = frac::tune(rigid, specification, with_motions);
      if (found.usable()) {
        PersistentMotion motion = design.persistent(found.gains);
        if (motion.swing < result.persistent.swing) {
          result.linear = std::move(found);
          result.persistent = std::move(motion);
        }
      }
    }
  }
  add_demands(specification, result.linear, result.constraints);
  add_limits(falling, result.linear, result.constraints);
  if (result.usable()) {
    if (design.is_at_limit(result.persistent.cycles)) {
      result.constraints.push_back(
          {"search for cycles, up to rad/s", design.fastest(), result.persistent.cycles.back().omega, true});
    }
    result.constraints.push_back({cycle_constraint, 0, result.persistent.swing, result.of_regardless.swing > 0});
  }
  result.message = message_of(result);
  return result;
}

}  // namespace backlash
