// SPDX-License-Identifier: BSD-3-Clause
#include "sticking_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "disturbance.hpp"
#include "frac/cancellation.hpp"
#include "window_mean.hpp"

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double rounding = std::numeric_limits<double>::epsilon();

// Up to this error of the mean by rounding the computed orbit is the true one.
constexpr double known_orbit = 1e-6;
// From this error on the effect of rounding is no longer proportional to rounding: the orbit is another one.
constexpr double lost_orbit = 1e-3;
// Batches of a mean over several motions from release to release.
constexpr std::size_t batches = 16;
// Impacts of an orbit that is long enough to be divided into batches itself.
constexpr std::int64_t long_course = enough_impacts;
// A motion that does not stick for so many times the impacts of the first one has reached a state in which it does not.
constexpr std::int64_t most_delay = 64;

// Relative error of phase and velocity that an impact adds.
constexpr double rounding_per_impact = 8 * rounding;

// The error of the mean over a sequence of impacts by rounding.  Each impact adds to the error of phase and velocity,
// which grows with the motion like any small disturbance.
class RoundingGrowth {
 public:
  void advance(const GapMotion& motion, const GapState& from, const Flight& flight, const GapState& to) noexcept {
    error_ = error_ * disturbance_.advance(motion, from, flight, to) + rounding_per_impact * (1 + to.velocity);
    sum_ += error_ * (1 + to.velocity + flight.speed);
  }
  // The error of |U_1| over so many half periods.  Each impact changes the sum by its velocity jump times the error of
  // its phase.
  [[nodiscard]] double error_of_mean(double half_periods) const noexcept { return 2 / (pi * half_periods) * sum_; }
  // The change of |U_1| per relative change of the force, which changes phase and velocity at each impact by the same
  // share.
  [[nodiscard]] double force_sensitivity(double half_periods) const noexcept {
    return error_of_mean(half_periods) / rounding_per_impact;
  }

 private:
  Disturbance disturbance_;
  double error_ = 0;
  double sum_ = 0;
};

// The motion from one release to the next.
struct Cycle {
  GapState next_release;
  FlightSum flights;
  double half_periods = 0;
  std::int64_t impacts = 0;
  bool chatters = false;
  double neglected = 0;       // of the integral of the distance
  double squared_speeds = 0;  // before the impacts
  double tail_loss = 0;
  RoundingGrowth rounding_growth;
};

// Empty when the mass does not stick within that many impacts.
std::optional<Cycle> next_cycle(const GapMotion& motion, const GapState& release, double limit,
                                std::int64_t most_impacts) {
  Cycle cycle;
  GapState state = release;
  for (;;) {
    if (!motion.rests(state)) {
      if (cycle.impacts == most_impacts) return std::nullopt;
      const Flight flight = motion.next_flight(state);
      if (!flight.hits) return std::nullopt;
      const GapState next = motion.after_impact(state, flight);
      ++cycle.impacts;
      cycle.squared_speeds += flight.speed * flight.speed;
      cycle.flights.add_flight(state, flight);
      if (flight.crosses) cycle.flights.add_crossing(next);
      cycle.rounding_growth.advance(motion, state, flight, next);
      state = next;
      const ChatterTail tail = motion.chatter_tail(state);
      if (!tail.negligible(limit)) continue;
      if (state.velocity > 0) {
        cycle.chatters = true;
        cycle.flights.add_tail(state, tail);
        cycle.neglected = tail.area_error;
        cycle.tail_loss = tail.loss;
      }
    }
    cycle.next_release = motion.release_after(state);
    cycle.half_periods = static_cast<double>(cycle.next_release.half_period - release.half_period);
    return cycle;
  }
}

SteadyState orbit_of(const GapMotion& motion, const GapState& release, const Cycle& cycle, double limit) {
  SteadyState steady;
  const auto halves = static_cast<int>(cycle.half_periods);
  const bool mirrored = cycle.next_release.wall != release.wall;
  steady.regime = cycle.chatters ? Regime::chatter : Regime::periodic;
  steady.period = mirrored ? halves : halves / 2;
  steady.impacts_per_period = cycle.chatters ? std::numeric_limits<double>::infinity()
                                             : 2 * static_cast<double>(cycle.impacts) / cycle.half_periods;
  steady.harmonics = cycle.flights.harmonics(motion.gamma(), cycle.half_periods);
  steady.spectral_radius = 0;
  steady.energy_defect =
      energy_defect(motion, steady.harmonics, cycle.half_periods, cycle.squared_speeds, cycle.tail_loss);
  steady.lyapunov = -std::numeric_limits<double>::infinity();
  // A few dozen roundings of phases and of integrals over flights, each below 1.
  steady.uncertainty = 2 / (pi * cycle.half_periods) * cycle.neglected + 32 * rounding;
  // Within one period a stick leaves rounding no time to grow.
  if (steady.period > 1) steady.uncertainty += cycle.rounding_growth.error_of_mean(cycle.half_periods);
  steady.end = state_at_next_peak(motion, release, limit);
  return steady;
}

// Half width of the mean of U_1 over cycles, whose means U with weights h are those of a ratio: the deviations of
// batches are h (U - mean) over the mean h of a batch.
double half_width(const std::vector<std::complex<double>>& integral, const std::vector<double>& half_periods,
                  std::complex<double> mean) {
  std::array<std::complex<double>, batches> deviations{};
  const std::size_t length = integral.size() / batches;
  double sum = 0;
  for (std::size_t i = 0; i < integral.size(); ++i) {
    deviations[i / length] += integral[i] - half_periods[i] * mean;
    sum += half_periods[i];
  }
  for (auto& deviation : deviations) deviation *= batches / sum;
  return half_width_of_mean(deviations);
}

// Rounding decides which of many orbits is computed, and any disturbance of the true motion which of them it follows
// from stick to stick: gamma is changed by another few last digits, up and down, for each.
std::optional<SteadyState> mean_of_sticking_motion(const GapMotion& motion, const GapState& release, const Cycle& first,
                                                   double limit, const MeanGoal& goal) {
  const std::int64_t most_impacts = most_delay * std::max<std::int64_t>(first.impacts, batches);
  FlightSum flights;
  std::vector<std::complex<double>> integral;
  std::vector<double> half_periods;
  double periods = 0, squared_speeds = 0, tail_loss = 0;
  std::int64_t impacts = 0;
  GapState state = release;
  Cycle cycle = first;
  for (std::size_t count = batches;; count *= 2) {
    while (integral.size() < count) {
      frac::throw_if_cancelled();
      flights += cycle.flights;
      half_periods.push_back(cycle.half_periods);
      integral.push_back(cycle.half_periods * cycle.flights.harmonics(motion.gamma(), cycle.half_periods).u[0]);
      periods += 0.5 * cycle.half_periods;
      squared_speeds += cycle.squared_speeds;
      tail_loss += cycle.tail_loss;
      impacts += cycle.impacts;
      state = cycle.next_release;
      const std::size_t step = integral.size() / 2 + 1;
      const auto digits = static_cast<double>(step) * (integral.size() % 2 == 0 ? 1 : -1);
      const GapMotion disturbed(motion.gamma() * (1 + digits * rounding), motion.restitution());
      const std::optional<Cycle> next = next_cycle(disturbed, state, limit, most_impacts);
      if (!next) return std::nullopt;
      cycle = *next;
    }
    SteadyState steady;
    steady.harmonics = flights.harmonics(motion.gamma(), 2 * periods);
    steady.uncertainty = half_width(integral, half_periods, steady.harmonics.u[0]);
    const bool is_enough = periods >= static_cast<double>(window_records) && impacts >= enough_impacts;
    const bool is_good = steady.uncertainty <= goal.relative * std::abs(steady.harmonics.u[0] - goal.zero);
    if (!is_enough && !is_good) continue;
    steady.energy_defect = energy_defect(motion, steady.harmonics, 2 * periods, squared_speeds, tail_loss);
    return steady;
  }
}

}  // namespace

SteadyState sticking_motion(const GapMotion& motion, const GapState& release, double tolerance, const MeanGoal& goal,
                            int longest_period, const SteadyState& course) {
  const double limit = tail_limit(motion, tolerance);
  const Cycle first = *next_cycle(motion, release, limit, std::numeric_limits<std::int64_t>::max());
  const SteadyState orbit = orbit_of(motion, release, first, limit);
  if (orbit.period <= longest_period && orbit.uncertainty < known_orbit) return orbit;
  SteadyState steady = course;
  // From stick to stick the motion repeats: it has no transient.
  steady.periods_followed = 0.5 * first.half_periods;
  steady.harmonics = orbit.harmonics;
  steady.energy_defect = orbit.energy_defect;
  steady.end = orbit.end;
  if (orbit.uncertainty < known_orbit) {
    steady.uncertainty = orbit.uncertainty;
    return steady;
  }
  steady.force_sensitivity = first.rounding_growth.force_sensitivity(first.half_periods);
  // The batches of one such orbit tell as much as many orbits do.
  if (first.impacts > long_course) return steady;
  if (const auto mean = mean_of_sticking_motion(motion, release, first, limit, goal)) {
    steady.harmonics = mean->harmonics;
    const double rounded = orbit.uncertainty < lost_orbit ? orbit.uncertainty : 0;
    steady.uncertainty = std::max(rounded, mean->uncertainty);
    steady.energy_defect = mean->energy_defect;
  }
  return steady;
}

}  // namespace backlash::detail
