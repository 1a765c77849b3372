// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/design/tune_with_backlash.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "backlash/loops/simulate_loop.hpp"
#include "base/short_text.hpp"
#include "formula/whole_orders.hpp"
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

// A body of a cycle: its harmonics by the speed that impacts give it, which makes corners that they follow slowly, and
// by what is smooth beside them.
class CycleMotion {
 public:
  CycleMotion(double omega, const std::vector<CycleHarmonic>& harmonics, const std::vector<CycleImpact>& impacts,
              const BacklashPlant& plant)
      : omega_(omega), impacts_(impacts) {
    const TwoMassSystem& system = plant.bodies.system();
    const bool is_load = plant.measured == Output::x1;
    corner_ = 1 / (pi * omega * (is_load ? system.mass1() : -system.mass2()));
    for (const CycleHarmonic& harmonic : harmonics) {
      std::complex<double> phasor = is_load ? harmonic.x1 : harmonic.x2;
      const double order = harmonic.order;
      for (const CycleImpact& impact : impacts)
        phasor += corner_ * impact.impulse / (order * order) * std::polar(1.0, -order * omega * impact.time);
      smooth_.push_back({order, phasor});
    }
  }
  // Half of peak to peak.
  [[nodiscard]] double swing() const {
    constexpr int instants = 400;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const auto consider = [&](double turned) {
      const double position = at(turned);
      low = std::min(low, position);
      high = std::max(high, position);
    };
    for (int i = 0; i < instants; ++i) consider(2 * pi * i / instants);
    for (const CycleImpact& impact : impacts_) consider(omega_ * impact.time);
    return (high - low) / 2;
  }

 private:
  // @param turned  omega t
  [[nodiscard]] double at(double turned) const {
    double position = 0;
    for (const auto& [order, phasor] : smooth_) position += (phasor * std::polar(1.0, order * turned)).real();
    for (const CycleImpact& impact : impacts_) {
      // sum cos(k angle)/k^2
      const double angle = std::fmod(turned - omega_ * impact.time + 2 * pi, 2 * pi);
      position -= corner_ * impact.impulse * (pi * pi / 6 - angle * (2 * pi - angle) / 4);
    }
    return position;
  }

  double omega_;
  double corner_;
  const std::vector<CycleImpact>& impacts_;
  std::vector<std::pair<double, std::complex<double>>> smooth_;
};

// Half of peak to peak over a part of the samples.
double sampled_swing(const std::vector<double>& positions, double from, double to) {
  const auto at = [&](double share) {
    return positions.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(positions.size()));
  };
  const auto [low, high] = std::minmax_element(at(from), at(to));
  return (*high - *low) / 2;
}

// A cycle by what persists of it; none where the swing is 0.
struct Swing {
  double swing = 0;
  double omega = std::numeric_limits<double>::quiet_NaN();
  bool stable = false;
};
const Swing& larger(const Swing& a, const Swing& b) {
  return b.swing > a.swing ? b : a;
}

class Design {
 public:
  Design(const BacklashPlant& plant, double crossover, const frac::TuningOptions& options)
      : plant_(plant), crossover_(crossover), filter_time_(options.derivative_filter_time), fastest_(10 * crossover) {
    is_quick_ = !plant.compliant && plant.bodies.are_free() && plant.measured == Output::x1 && filter_time_ == 0;
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
    PersistentMotion motion = plant_.compliant ? compliant_cycles_of(gains) : hard_cycles_of(gains);
    const std::vector<Swing> swings = swings_of(motion);
    Swing largest;
    double rate = crossover_;
    for (const Swing& each : swings) {
      if (!each.stable) continue;
      largest = larger(largest, each);
      rate = std::max(rate, each.omega);
    }
    for (const double speed : {0.1, 1.0, 10.0}) motion.simulations.push_back(simulated(gains, speed, rate, fine_steps));

    motion.swing = largest.swing;
    motion.omega = largest.omega;
    motion.verified = largest.swing == 0;
    for (const SimulatedMotion& each : motion.simulations) {
      if (each.dies_out) continue;
      const auto comes_to = [&](const Swing& cycle) {
        constexpr double of_steps = 0.08;
        return cycle.stable && std::abs(each.swing - cycle.swing) <= of_steps * cycle.swing;
      };
      motion.verified = motion.verified || comes_to(largest);
      const bool falls_to_it = largest.swing > 0 && each.swing < still_falls * each.before;
      if (each.swing > motion.swing && !falls_to_it && std::none_of(swings.begin(), swings.end(), comes_to)) {
        motion.swing = each.swing;
        motion.omega = std::numeric_limits<double>::quiet_NaN();
      }
    }
    return motion;
  }

  [[nodiscard]] double clearance() const { return plant_.bodies.system().clearance(); }

 private:
  // Per period of the crossover: two for each of a cycle ten times as fast.
  static constexpr double contacts_of_fast_cycles = 20, any_number = 1e15;
  static constexpr int few_harmonics = 10, many_harmonics = 100;
  // Share of the quarter before below which a simulated swing has not settled.
  static constexpr double still_falls = 0.9;
  static constexpr double coarse_steps = 600, fine_steps = 2000;  // per period
  static PersistentMotion without_cycles(FrequencyRange searched) {
    return {{}, searched, false, {}, {}, 0, 0, {}, false};
  }
  [[nodiscard]] PersistentMotion hard_cycles_of(const frac::FractionalPidGains& gains) const {
    const LimitCycles found = cycles_of(gains, many_harmonics);
    PersistentMotion motion = without_cycles(found.searched);
    motion.certain = found.certain;
    for (const SymmetricCycle& cycle : found.cycles) {
      if (cycle.admissible) motion.cycles.push_back(cycle);
    }
    ImpactCycleOptions request;
    request.harmonics = 2 * many_harmonics;  // even ones too
    const ImpactCycles settled = impact_cycles(loop_of(gains), request);
    for (const ImpactCycle* cycle : further_cycles(settled.cycles, motion.cycles)) motion.further.push_back(*cycle);
    return motion;
  }
  [[nodiscard]] PersistentMotion compliant_cycles_of(const frac::FractionalPidGains& gains) const {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    PersistentMotion motion = without_cycles({unknown, unknown});
    const CompliantLoop loop = compliant_loop_of(gains);
    // Newton's method on realised powers takes minutes: of these simulations alone tell.
    for (const auto* part : {&loop.controller(), &plant_.bodies.load(), &plant_.bodies.drive()})
      if (!frac::detail::has_whole_orders(part->numerator()) || !frac::detail::has_whole_orders(part->denominator()))
        return motion;
    CompliantCycleOptions request;
    // Corners of the motion last as long as contacts: beyond them harmonics fall as k^-4, and the sum leaves out less
    // than 1 % of what contacts of that speed differ from a restitution in.
    const TwoMassSystem& system = plant_.bodies.system();
    const double ratio =
        free_contact(plant_.compliant->contact(), system.mass1(), system.mass2()).frequency / crossover_;
    request.harmonics = static_cast<int>(std::clamp(4 * ratio, 2.0 * many_harmonics, 2e4));
    motion.compliant = compliant_cycles(loop, request).cycles;
    return motion;
  }

  // What persists, as far as a search can afford to know; empty where it is not known or too fast.
  [[nodiscard]] std::optional<double> quick_swing(const frac::FractionalPidGains& gains) {
    // Flights through contacts that take time cost a multiple of impacts.
    const int most_simulated = plant_.compliant ? 60 : 300;
    constexpr int most_exact = 1000;
    if (is_quick_) {
      if (++exact_ > most_exact) return {};
      const LimitCycles found = cycles_of(gains, few_harmonics);
      for (const SymmetricCycle& cycle : found.cycles) {
        if (cycle.admissible && cycle.omega > fastest_) return {};
      }
      Swing largest;
      for (const SymmetricCycle& cycle : found.cycles) {
        if (cycle.admissible) largest = larger(largest, swing_with(cycle));
      }
      if (largest.stable) return largest.swing;
    }
    if (simulated_ >= most_simulated) return {};
    ++simulated_;
    double swing = 0;
    for (const double speed : {1.0, 10.0}) {
      const SimulatedMotion motion = simulated(gains, speed, crossover_, coarse_steps, contacts_of_fast_cycles);
      if (!motion.dies_out) swing = std::max(swing, motion.swing);
    }
    return swing;
  }

  [[nodiscard]] ControlLoop loop_of(const frac::FractionalPidGains& gains) const {
    return {plant_.bodies, frac::controller_transfer_function(gains, filter_time_), plant_.measured};
  }
  [[nodiscard]] CompliantLoop compliant_loop_of(const frac::FractionalPidGains& gains) const {
    return {*plant_.compliant, frac::controller_transfer_function(gains, filter_time_), plant_.measured};
  }
  [[nodiscard]] LimitCycles cycles_of(const frac::FractionalPidGains& gains, int harmonics) const {
    LimitCycleOptions request;
    request.harmonics = harmonics;
    return symmetric_cycles(loop_of(gains), request);
  }

  [[nodiscard]] Swing swing_with(const SymmetricCycle& cycle) const {
    const std::vector<CycleImpact> impacts{{0, cycle.impulse, cycle.impact_speed},
                                           {pi / cycle.omega, -cycle.impulse, cycle.impact_speed}};
    return {CycleMotion(cycle.omega, cycle.harmonics, impacts, plant_).swing(), cycle.omega, cycle.stability.stable};
  }
  [[nodiscard]] std::vector<Swing> swings_of(const PersistentMotion& motion) const {
    std::vector<Swing> swings;
    for (const SymmetricCycle& cycle : motion.cycles) swings.push_back(swing_with(cycle));
    for (const ImpactCycle& cycle : motion.further) {
      const double omega = 2 * pi / cycle.period;
      swings.push_back({CycleMotion(omega, cycle.harmonics, cycle.impacts, plant_).swing(), omega, true});
    }
    // Forces of such contacts are finite: the motion has no corners.
    const std::vector<CycleImpact> none;
    for (const CompliantCycle& cycle : motion.compliant) {
      const double swing = CycleMotion(cycle.omega, cycle.harmonics, none, plant_).swing();
      swings.push_back({swing, cycle.omega, cycle.stability.stable});
    }
    return swings;
  }

  // @param rate   rad/s, of the fastest thing to be seen
  // @param speed  of the driven body at the start, in clearances per time 1/crossover
  [[nodiscard]] SimulatedMotion simulated(const frac::FractionalPidGains& gains, double speed, double rate,
                                          double steps_per_period, double contacts_per_period = any_number) const {
    constexpr double most_steps = 4e5, least = 0.01;
    const double step = 2 * pi / (steps_per_period * rate);
    SimulatedMotion motion{speed * crossover_ * clearance(), 0, 0, false};
    // What still falls is followed for longer.
    for (const double periods : {40.0, 160.0}) {
      const auto steps = static_cast<std::size_t>(std::min(2 * pi * periods / (crossover_ * step), most_steps));
      const double contacts = std::min(contacts_per_period * periods, any_number);
      const auto positions = positions_from(motion.speed, gains, step, steps, static_cast<std::size_t>(contacts));
      if (!positions) {
        motion.before = motion.swing = std::numeric_limits<double>::infinity();
        return motion;
      }
      motion.before = sampled_swing(*positions, 0.5, 0.75);
      motion.swing = sampled_swing(*positions, 0.75, 1);
      motion.dies_out = motion.swing <= least * clearance() && motion.swing <= motion.before;
      if (motion.dies_out || motion.swing > still_falls * motion.before) break;
    }
    return motion;
  }

  // Of the measured body; empty where the motion grows without bound, or has more contacts that take time than that.
  [[nodiscard]] std::optional<std::vector<double>> positions_from(double speed, const frac::FractionalPidGains& gains,
                                                                  double step, std::size_t steps,
                                                                  std::size_t most_contacts) const {
    std::vector<double> positions;
    if (!plant_.compliant && detail::can_be_stepped(plant_.bodies)) {
      positions = detail::step_loop({plant_.bodies, plant_.measured, gains, filter_time_}, speed, step, steps);
      if (positions.size() < steps) return std::nullopt;
      return positions;
    }
    // Between impacts the motion is exact, and samples are to show its peaks only.
    constexpr double steps_per_sample = 10;
    LoopSimulationOptions options;
    options.sample_time = steps_per_sample * step;
    options.duration = step * static_cast<double>(steps);
    options.most_impacts = plant_.compliant ? most_contacts : std::numeric_limits<std::size_t>::max();
    options.tolerance = 1e-4;
    options.rows_at_impacts = false;
    const auto read = [&](const auto& history) {
      for (const auto& row : history.rows) positions.push_back(plant_.measured == Output::x1 ? row.x1 : row.x2);
      return history.end != LoopEnd::diverged && history.end != LoopEnd::most_impacts;
    };
    const LoopStart start{0, 0, 0, speed};
    const bool is_bounded = plant_.compliant ? read(simulate_loop(compliant_loop_of(gains), start, {}, options))
                                             : read(simulate_loop(loop_of(gains), start, {}, options));
    if (!is_bounded) return std::nullopt;
    return positions;
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

std::string motion_text(const PersistentMotion& motion) {
  if (std::isinf(motion.swing)) return "a simulation that runs away";
  std::string text = "a motion of " + frac::detail::four_digits(motion.swing) + " m to either side";
  if (std::isfinite(motion.omega)) text += " at " + frac::detail::four_digits(motion.omega) + " rad/s";
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
           frac::detail::four_digits(result.regardless.max_sensitivity) + " instead of " +
           frac::detail::four_digits(result.linear.max_sensitivity) + ", with " + motion_text(result.of_regardless) +
           ".";
  } else {
    text = "No controller was found that keeps the demands and leaves no motion; the smallest is " +
           motion_text(result.persistent) + " (without regard to it " +
           (std::isinf(without) ? "a simulation runs away" : frac::detail::four_digits(without) + " m") +
           "). It is held there by";
    const char* separator = " ";
    for (const TuningConstraint& constraint : result.constraints) {
      if (!constraint.active || constraint.name == cycle_constraint) continue;
      text += separator + constraint.name;
      separator = "; ";
    }
    text += ".";
  }
  if (!result.persistent.verified) text += " Simulations do not come to that cycle.";
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
