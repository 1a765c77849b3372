// SPDX-License-Identifier: BSD-3-Clause
#include "steady_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "closed_orbit.hpp"
#include "disturbance.hpp"
#include "frac/cancellation.hpp"
#include "sticking_motion.hpp"
#include "two_impact_orbit.hpp"
#include "window_mean.hpp"

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double rounding = std::numeric_limits<double>::epsilon();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Longest period of a closed orbit, in force periods; what closes later is averaged.
constexpr int longest_period = 64;
// Force periods left to the transient.
constexpr std::int64_t transient_periods = 256;
// A mean with a goal (MeanGoal) begins after fewer periods, once the impacts have taken the energy of the start
// energy_memory times over, and is judged when its window holds 32, 64, 128, ... periods.  It ends early only where a
// small disturbance has grown by e^certain_growth: slow transients and undamped motions, whose batches may all agree on
// what is not yet the mean, are followed to the end.
constexpr std::int64_t quick_transient_periods = 64;
constexpr double energy_memory = 10;
constexpr std::size_t first_judged = 32;
constexpr std::int64_t least_judged_impacts = 256;
constexpr double certain_growth = 18;
// At high restitution chaotic transients that end on orbits last long: of 1600 random scenes those at restitution 0.85,
// 0.87, 0.95 and 0.97 had transients up to 4500, 10 700, 45 000 and 37 000 periods; below 0.7 none lasted beyond the
// usual window.
constexpr double transient_scale = 800;
constexpr double long_transient_loss = 0.5;
constexpr std::int64_t most_periods = 100'000;
// Force periods for a motion in which small disturbances do not grow enough to be called chaotic.
constexpr std::int64_t slow_periods = 16'384;
// While the impacts have not taken the energy of the start energy_memory times over the transient goes on to here.
constexpr std::int64_t most_transient_periods = 20'000;
// Flights longer than a transient, after each of which a new one begins.
constexpr int most_long_flights = 64;
// Impacts after which transient and window end early: bounds the work per point at any restitution.
constexpr std::int64_t transient_impacts = 100'000;
constexpr std::int64_t window_impacts = 300'000;
// Returns are looked for every few periods.  A state that has come back within very_near_return starts the search for a
// closed orbit; so does, after 8, 16, 32, ... periods, one within near_return, for the sake of slowly attracting
// orbits.
constexpr std::int64_t return_interval = 8;
constexpr double near_return = 1e-3;
constexpr double very_near_return = 1e-6;
// A state this near to a stable closed orbit is on its way to it.
constexpr double captured = 1e-6;
constexpr int capture_rounds = 50;
// Multipliers so near to the unit circle are on it, give or take what rounding makes of them beside a bifurcation.
constexpr double neutral = 1e-9;
// Multipliers of an orbit beyond which another one is looked for, its distance at most, and that in distances of the
// state.
constexpr double slowly_repelling = 0.01;
constexpr double furthest_beyond = 0.3;
constexpr double most_beyond = 1024;

constexpr auto usual_window = static_cast<std::int64_t>(window_records);

// Force periods after which a chaotic motion is taken for the long-run one.  `lost`: share of the energy of relative
// motion that an impact takes.
std::int64_t longest_transient(double lost) {
  if (lost == 0 || lost > long_transient_loss) return usual_window;
  return std::min(most_periods, static_cast<std::int64_t>(std::min(1e9, transient_scale / (lost * lost))));
}

double distance_between(const GapState& a, const GapState& b) {
  return std::abs(a.s - b.s) + std::abs(a.velocity - b.velocity) / (1 + b.velocity);
}

// |U_1| changes by at most about the change of the state.  A state error grows over one period by the rounding of its
// impacts and accumulates like a geometric series in the spectral radius.  Newton's next step is a third of the way to
// the orbit where three of them meet, and nearly all of it elsewhere.
double orbit_uncertainty(const ClosedOrbit& orbit, double radius) {
  const double per_period = orbit.residual + 8 * rounding * (1 + orbit.start.velocity) * orbit.impacts;
  const double accumulated = per_period / std::max(std::abs(1 - radius), rounding);
  // Where the attraction vanishes it is of third order, and keeps an error of rounding to its cube root.
  return 4 * std::min(std::max(accumulated, 3 * orbit.step), std::cbrt(per_period));
}

// True where the motion from `state` approaches the orbit, which it may merely pass near.
bool is_captured(const GapMotion& motion, const ClosedOrbit& orbit, GapState state, double tolerance) {
  const double first = distance_between(state, orbit.start);
  if (motion.restitution() == 1) return first <= tolerance;
  for (int round = 0; round < capture_rounds; ++round) {
    const double distance = distance_between(state, orbit.start);
    if (distance <= captured || distance < 0.3 * first) return true;
    if (distance > 5 * first) return false;
    const std::int64_t expected = state.half_period + orbit.half_periods;
    for (int i = 0; i < orbit.impacts; ++i) {
      if (motion.rests(state)) return false;
      const Flight flight = motion.next_flight(state);
      if (!flight.hits) return false;
      state = motion.after_impact(state, flight);
    }
    if (state.wall != orbit.start.wall || std::abs(state.half_period - expected) > 1) return false;
  }
  return distance_between(state, orbit.start) < first;
}

// The shortest orbit that this one repeats.
ClosedOrbit without_repeats(const GapMotion& motion, const ClosedOrbit& orbit, double tolerance) {
  const std::int64_t period = orbit.half_periods / 2;
  for (std::int64_t shorter = 1; shorter < period; ++shorter) {
    if (period % shorter != 0) continue;
    const std::int64_t repeats = period / shorter;
    if (orbit.impacts % repeats != 0) continue;
    const std::optional<ClosedOrbit> once =
        close_orbit(motion, orbit.start, static_cast<int>(orbit.impacts / repeats), 2 * shorter, tolerance);
    if (once && distance_between(once->start, orbit.start) < captured + 3 * (once->step + orbit.step)) return *once;
  }
  return orbit;
}

double orbit_energy_defect(const GapMotion& motion, const ClosedOrbit& orbit, const Harmonics& harmonics) {
  double squared_speeds = 0;
  GapState state = orbit.start;
  for (int i = 0; i < orbit.impacts; ++i) {
    const Flight flight = motion.next_flight(state);
    squared_speeds += flight.speed * flight.speed;
    state = motion.after_impact(state, flight);
  }
  return energy_defect(motion, harmonics, static_cast<double>(orbit.half_periods), squared_speeds);
}

double radius_of(const GapMotion& motion, const ClosedOrbit& orbit) {
  // Exact value of the determinant; the product of the factors loses it where the motion is strongly contracting.
  return spectral_radius(orbit.jacobian.trace(), std::pow(motion.restitution(), 2.0 * orbit.impacts));
}

bool is_attracting(const GapMotion& motion, const ClosedOrbit& orbit) {
  // Rounding decides on which side of a bifurcation an orbit lies that is this near to it.
  return radius_of(motion, orbit) <= (motion.restitution() < 1 ? 1 + neutral : 1);
}

// A motion that leaves an orbit slowly is near a pitchfork or a period doubling: the orbit born there lies further out
// on the same side, where Newton's iteration begins that comes to the repelling one from here.
std::optional<ClosedOrbit> orbit_beyond(const GapMotion& motion, const ClosedOrbit& repelling, const GapState& state,
                                        double tolerance) {
  if (radius_of(motion, repelling) > 1 + slowly_repelling) return std::nullopt;
  const int rounds = repelling.jacobian.trace() < 0 ? 2 : 1;
  const double phase =
      static_cast<double>(state.half_period - repelling.start.half_period) * pi + state.s - repelling.start.s;
  const double velocity = state.velocity - repelling.start.velocity;
  for (double scale = 2; scale * (std::abs(phase) + std::abs(velocity)) < furthest_beyond; scale *= 2) {
    GapState guess = repelling.start;
    advance_phase(guess, scale * phase);
    guess.velocity += scale * velocity;
    if (guess.velocity < 0 || scale > most_beyond) break;
    std::optional<ClosedOrbit> orbit =
        close_orbit(motion, guess, rounds * repelling.impacts, rounds * repelling.half_periods, tolerance);
    if (orbit && is_attracting(motion, *orbit)) return orbit;
  }
  return std::nullopt;
}

std::optional<SteadyState> closed_orbit_near(const GapMotion& motion, const GapState& state, int impacts, int period,
                                             double tolerance) {
  std::optional<ClosedOrbit> orbit = close_orbit(motion, state, impacts, 2 * std::int64_t{period}, tolerance);
  if (!orbit) return std::nullopt;
  orbit = without_repeats(motion, *orbit, tolerance);
  if (!is_attracting(motion, *orbit)) orbit = orbit_beyond(motion, *orbit, state, tolerance);
  if (!orbit || !is_captured(motion, *orbit, state, tolerance)) return std::nullopt;
  const double radius = radius_of(motion, *orbit);

  if (orbit->impacts == 2 && orbit->half_periods == 2 &&
      motion.gamma() <= symmetry_breaking_gamma(motion.restitution())) {
    const std::optional<TwoImpactOrbit> symmetric = symmetric_two_impact_orbit(motion.gamma(), motion.restitution());
    if (symmetric && std::abs(orbit->start.velocity - symmetric->start.velocity) < 1e-4 &&
        std::abs(orbit->start.s - symmetric->start.s) < 1e-4) {
      return two_impact_steady_state(*symmetric, motion.restitution());
    }
  }
  SteadyState steady;
  steady.regime = Regime::periodic;
  steady.period = static_cast<int>(orbit->half_periods / 2);
  steady.impacts_per_period = static_cast<double>(orbit->impacts) / steady.period;
  steady.harmonics = orbit_harmonics(motion, *orbit);
  steady.uncertainty = orbit_uncertainty(*orbit, radius);
  steady.spectral_radius = radius;
  steady.energy_defect = orbit_energy_defect(motion, *orbit, steady.harmonics);
  steady.lyapunov = std::log(radius) / steady.period;
  steady.end = state_at_next_peak(motion, orbit->start, 0);
  return steady;
}

SteadyState free_motion(double gamma, const GapState& end) {
  SteadyState steady;
  steady.regime = Regime::free;
  steady.period = 1;
  steady.impacts_per_period = 0;
  steady.harmonics.u[0] = -gamma;
  steady.uncertainty = 0;
  steady.spectral_radius = nan;
  steady.energy_defect = 0;
  steady.lyapunov = nan;
  steady.end = end;
  return steady;
}

// Finds the shortest period after which the state at the peaks of the force has come back near to itself, and leaves a
// period alone for a while after it led nowhere.  A motion that is followed for long is looked at in rounds.
class ReturnDetector {
 public:
  explicit ReturnDetector(double gamma) : velocity_scale_(1 / (1 + std::sqrt(gamma))) { wait_.fill(return_interval); }

  struct Return {
    int period;
    int impacts;
  };
  std::optional<Return> add(std::int64_t count, const Strobe& strobe) {
    std::optional<Return> found;
    if (count - begin_ > round_length) {
      begin_ += round_length;
      wait_.fill(return_interval);
      wait_until_.fill(0);
    }
    if (count % return_interval == 0) {
      const std::int64_t age = count - begin_;
      const bool is_power_of_two = (age & (age - 1)) == 0;
      found = shortest_return(count, strobe, is_power_of_two ? near_return : very_near_return);
    }
    ring_[slot(count)] = strobe;
    return found;
  }
  void reject(std::int64_t count, int period) {
    const auto i = static_cast<std::size_t>(period);
    wait_until_[i] = count + wait_[i];
    wait_[i] *= 2;
  }

 private:
  static std::size_t slot(std::int64_t count) { return static_cast<std::size_t>(count % longest_period); }

  std::optional<Return> shortest_return(std::int64_t count, const Strobe& strobe, double limit) const {
    for (int period = 1; period <= longest_period && period < count; ++period) {
      const Strobe& earlier = ring_[slot(count - period)];
      const double distance = std::abs(strobe.position - earlier.position) +
                              std::abs(strobe.position_rate - earlier.position_rate) * velocity_scale_;
      if (distance > limit) continue;
      const std::int64_t impacts = strobe.impacts - earlier.impacts;
      if (impacts > 0 && count >= wait_until_[static_cast<std::size_t>(period)]) {
        return Return{period, static_cast<int>(impacts)};
      }
    }
    return std::nullopt;
  }

  static constexpr std::int64_t round_length = 2048;

  double velocity_scale_;
  std::int64_t begin_ = 0;
  std::array<Strobe, longest_period> ring_{};
  std::array<std::int64_t, longest_period + 1> wait_until_{};
  std::array<std::int64_t, longest_period + 1> wait_{};
};

// Uncertainty of U_1.  An asymmetric orbit is known as well as its gamma: by the change of U_1 to a neighbour.
double two_impact_uncertainty(const TwoImpactOrbit& orbit, double restitution, std::complex<double> u1) {
  if (orbit.symmetric()) return SymmetricFamily(restitution).at(orbit.gamma).uncertainty;
  const double asymmetry = 0.5 * std::abs(pi - orbit.flight_time);
  const TwoImpactOrbit other = asymmetric_two_impact_orbit(0.999 * asymmetry, restitution);
  const double slope =
      std::abs(two_impact_harmonics(other, restitution).u[0] - u1) / std::abs(other.gamma - orbit.gamma);
  const double rounded = rounding * (1 + orbit.gamma);
  return (std::isfinite(slope) ? 16 * (1 + slope) : 64) * rounded;
}

}  // namespace

SteadyState two_impact_steady_state(const TwoImpactOrbit& orbit, double restitution) {
  const TwoImpactStability stability = two_impact_stability(orbit, restitution);
  const GapMotion motion(orbit.gamma, restitution);
  SteadyState steady;
  steady.regime = orbit.symmetric() ? Regime::symmetric : Regime::periodic;
  steady.period = 1;
  steady.impacts_per_period = 2;
  steady.harmonics = two_impact_harmonics(orbit, restitution);
  steady.uncertainty = two_impact_uncertainty(orbit, restitution, steady.harmonics.u[0]);
  steady.spectral_radius = spectral_radius(stability.trace, stability.determinant);
  steady.energy_defect = energy_defect(motion, steady.harmonics, 2, 2 * orbit.speed * orbit.speed);
  steady.lyapunov = std::log(steady.spectral_radius);
  steady.end = state_at_next_peak(motion, orbit.start, 0);
  return steady;
}

namespace {

/// Follows a motion impact by impact until it is known what it does in the long run: it closes, sticks, leaves both
/// walls, or fills a window over which it is averaged.
class LongRun {
 public:
  LongRun(const GapMotion& motion, const GapState& start, double tolerance, const MeanGoal& goal)
      : motion_(motion),
        tolerance_(tolerance),
        goal_(goal),
        limit_(tail_limit(motion, tolerance)),
        lost_(1 - motion.restitution() * motion.restitution()),
        wanted_(goal.transients == Transients::outlasted ? longest_transient(lost_) : 0),
        most_impacts_(transient_impacts + (wanted_ > usual_window ? 2 : 1) * window_impacts),
        is_quick_(goal.relative > 0 && lost_ > 0),
        returns_(motion.gamma()),
        state_(start),
        last_peak_(start),
        next_peak_(start.half_period + 2) {}

  SteadyState found() {
    for (;;) {
      if (motion_.rests(state_) || motion_.chatter_tail(state_).negligible(limit_)) {
        if (released_) return sticking();
        skip_rest();
      }
      const Flight flight = motion_.next_flight(state_);
      if (!flight.hits) return free_motion(motion_.gamma(), last_peak_);
      const GapState next = motion_.after_impact(state_, flight);
      if (next.half_period - next_peak_ >= 2 * transient_periods && long_flights_ < most_long_flights) {
        begin_anew_after(next);
      }
      while (next.half_period >= next_peak_) {
        if (!pass_peak(state_.wall, motion_.along(state_, flight, radians_to_half_period(state_, next_peak_))))
          return averaged_motion();
      }
      jumps_.add(next, flight.speed);
      if (!window_.empty()) disturbance_.advance(motion_, state_, flight, next);
      ++impacts_;
      state_ = next;
      if (impacts_ >= most_impacts_) return averaged_motion();
      if (candidate_) {
        if (std::optional<SteadyState> steady = closed_orbit()) return *steady;
      }
    }
  }

 private:
  [[nodiscard]] bool in_transient() const {
    const std::int64_t passed = periods_ - transient_begin_;
    if (passed >= most_transient_periods || impacts_ >= transient_impacts) return false;
    const bool is_forgotten = lost_ == 0 || static_cast<double>(impacts_) * lost_ >= energy_memory;
    return passed < (is_quick_ ? quick_transient_periods : transient_periods) ||
           (!is_forgotten && (is_quick_ || goal_.transients == Transients::outlasted));
  }

  /// Growth of a small disturbance within the window, as a logarithm.
  [[nodiscard]] double growth() const {
    return window_.records().back().log_growth - window_.records().front().log_growth;
  }

  [[nodiscard]] SteadyState averaged_motion() const {
    SteadyState steady = averaged(window_.records(), motion_);
    steady.end = last_peak_;
    steady.periods_followed = static_cast<double>(periods_);
    // A motion that attracts nothing, at restitution 1, has no transients.
    steady.transient_possible = lost_ > 0 && (window_.empty() || periods_ < longest_transient(lost_) ||
                                              longest_transient(lost_) == most_periods || growth() < certain_growth);
    return steady;
  }

  [[nodiscard]] bool meets_goal() const {
    const std::vector<WindowRecord>& records = window_.records();
    const std::size_t length = records.size() - 1;
    if (!is_quick_ || records.back().period != periods_ || length < first_judged || (length & (length - 1)) != 0)
      return false;
    if (records.back().strobe.impacts - records.front().strobe.impacts < least_judged_impacts) return false;
    if (growth() < certain_growth) return false;
    const SteadyState mean = averaged(records, motion_);
    return mean.uncertainty <= goal_.relative * std::abs(mean.harmonics.u[0] - goal_.zero);
  }

  /// A motion that has lost its disturbances, or let them grow but little, is drawn slowly to an orbit.
  [[nodiscard]] std::int64_t wanted_periods() const {
    if (lost_ == 0 || goal_.transients == Transients::ignored || window_.empty()) return wanted_;
    return growth() < certain_growth ? std::max(wanted_, slow_periods) : wanted_;
  }

  /// False when the window is complete.
  bool pass_peak(int wall, const DistanceAndVelocity& at) {
    frac::throw_if_cancelled();
    ++periods_;
    last_peak_ = motion_.peak_state(wall, at);
    // The impacts counted so far are those before; a contact at the peak itself is still to come.
    const Strobe strobe{last_peak_.position(), wall == 0 ? at.velocity : -at.velocity, impacts_};
    if (!candidate_) candidate_ = returns_.add(periods_, strobe);
    next_peak_ += 2;
    if (!released_ && window_.empty() && in_transient()) return true;
    if (!window_.takes(periods_)) return true;
    return window_.add({strobe, periods_, jumps_, disturbance_.log_growth()}, wanted_periods()) && !meets_goal();
  }

  [[nodiscard]] SteadyState sticking() const {
    if (goal_.leaves_rests) return averaged_motion();
    return sticking_motion(motion_, *released_, tolerance_, goal_, longest_period,
                           averaged(window_.records(), motion_));
  }

  /// The motion after a rest depends on nothing before it, and velocity jumps do not describe one: a window that would
  /// be complete within the rest is given up like any other.
  void skip_rest() {
    const GapState release = motion_.release_after(state_);
    while (release.half_period >= next_peak_) pass_peak(state_.wall, {0, 0});
    window_.clear();
    candidate_.reset();
    released_ = release;
    state_ = release;
  }

  /// A flight that outlasts a transient belongs to it: what is to be averaged begins after the impact.
  void begin_anew_after(const GapState& impact) {
    ++long_flights_;
    const std::int64_t passed = (impact.half_period - next_peak_) / 2 + 1;
    next_peak_ += 2 * passed;
    periods_ += passed;
    transient_begin_ = periods_;
    window_.clear();
    returns_ = ReturnDetector(motion_.gamma());
    candidate_.reset();
  }

  /// The orbit near a return of the motion, if there is one.
  std::optional<SteadyState> closed_orbit() {
    const ReturnDetector::Return found = *candidate_;
    candidate_.reset();
    std::optional<SteadyState> steady = closed_orbit_near(motion_, state_, found.impacts, found.period, tolerance_);
    if (!steady) returns_.reject(periods_, found.period);
    return steady;
  }

  const GapMotion& motion_;
  double tolerance_;
  const MeanGoal& goal_;
  double limit_;
  double lost_;  // share of the energy of relative motion that an impact takes
  std::int64_t wanted_;
  std::int64_t most_impacts_;
  bool is_quick_;
  ReturnDetector returns_;
  std::optional<ReturnDetector::Return> candidate_;
  std::optional<GapState> released_;
  Window window_;
  JumpSum jumps_;
  Disturbance disturbance_;
  GapState state_;
  GapState last_peak_;
  std::int64_t next_peak_;
  std::int64_t periods_ = 0;
  std::int64_t transient_begin_ = 0;
  std::int64_t impacts_ = 0;
  int long_flights_ = 0;
};

}  // namespace

SteadyState find_steady_state(const GapMotion& motion, const GapState& start, double tolerance, const MeanGoal& goal) {
  return LongRun(motion, start, tolerance, goal).found();
}

}  // namespace backlash::detail
