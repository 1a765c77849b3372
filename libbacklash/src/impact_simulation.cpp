#include "backlash/impact_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "detail/check.hpp"
#include "detail/gap_motion.hpp"

namespace backlash {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double neglected_tail = 1e-13;

// Seconds from tau = 0, at half_period 1 and s = -pi/2.
double time_of(const detail::GapState& state, double omega) {
  return (static_cast<double>(state.half_period - 1) * pi + (state.s + pi / 2)) / omega;
}

Wall wall_of(const detail::GapState& state) {
  return state.wall == 0 ? Wall::near : Wall::far;
}

void check(const TwoMassSystem& system, double gamma, const RelativeState& start, int periods) {
  if (system.clearance() == 0) {
    throw std::invalid_argument(
        "clearance is 0; the masses then move as one, without impacts: it must be positive (m)");
  }
  if (!(gamma > 0 && gamma < 1e30)) {
    throw std::invalid_argument("F/(M2 clearance omega^2) is " + detail::text(gamma) + "; it must be in (0, 1e30)");
  }
  if (!(start.position >= 0 && start.position <= system.clearance())) {
    throw std::invalid_argument("start.position is " + detail::text(start.position) +
                                "; it must be in [0, clearance = " + detail::text(system.clearance()) + "] (m)");
  }
  const bool into_near = start.position == 0 && start.velocity < 0;
  const bool into_far = start.position == system.clearance() && start.velocity > 0;
  if (!std::isfinite(start.velocity) || into_near || into_far) {
    throw std::invalid_argument("start.velocity is " + detail::text(start.velocity) +
                                "; it must be finite and, at a wall, not into it (m/s)");
  }
  if (periods <= 0) throw std::invalid_argument("periods is " + std::to_string(periods) + "; it must be positive");
}

}  // namespace

ImpactHistory simulate_impacts(const TwoMassSystem& system, double force_amplitude, double omega,
                               const RelativeState& start, int periods, std::size_t max_impacts) {
  const double gamma = dimensionless_force(system, force_amplitude, omega);
  check(system, gamma, start, periods);
  const detail::GapMotion motion(gamma, system.restitution());
  const double speed_unit = system.clearance() * omega;
  const double total_mass = system.mass1() + system.mass2();
  // The centre of mass moves as F/((M1 + M2) omega) sin(omega t).
  const double mean_speed = force_amplitude / total_mass / omega;
  const std::int64_t last_peak = 1 + 2 * static_cast<std::int64_t>(periods);

  ImpactHistory history{{}, {}, 2 * pi * periods / omega, true, {}};
  detail::GapState state = detail::state_at_peak(start.position / system.clearance(), start.velocity / speed_unit);
  const auto end_at = [&](double position, double rate) {
    history.end = {std::clamp(position, 0.0, 1.0) * system.clearance(), rate * speed_unit};
  };
  for (;;) {
    if (motion.rests(state) || motion.chatter_tail(state).negligible(neglected_tail)) {
      const detail::GapState release = motion.release_after(state);
      const bool lasts = release.half_period >= last_peak;
      const double until = lasts ? history.duration : time_of(release, omega);
      const double reduced_mass = system.mass1() / total_mass * system.mass2();
      const double energy = reduced_mass * motion.chatter_tail(state).loss * speed_unit * speed_unit;
      history.rests.push_back({time_of(state, omega), until, wall_of(state), energy});
      if (lasts) {
        end_at(state.wall, 0);
        return history;
      }
      state = release;
    }
    const detail::Flight flight = motion.next_flight(state);
    const detail::GapState next = flight.hits ? motion.after_impact(state, flight) : state;
    if (!flight.hits || next.half_period >= last_peak) {
      const detail::GapState end =
          motion.peak_state(state.wall, motion.along(state, flight, detail::radians_to_half_period(state, last_peak)));
      end_at(end.position(), end.position_rate());
      return history;
    }
    // Relative velocity x2' - x1' just before: into the wall that is met.
    const double relative = (next.wall == 0 ? -flight.speed : flight.speed) * speed_unit;
    // sin(omega t) = -(-1)^K cos s
    const double mean = ((next.half_period & 1) != 0 ? next.cos_s : -next.cos_s) * mean_speed;
    const ImpactVelocities before{mean - system.mass2() / total_mass * relative,
                                  mean + system.mass1() / total_mass * relative};
    history.impacts.push_back({time_of(next, omega), wall_of(next), before, post_impact_velocities(system, before),
                               impact_energy_loss(system, relative)});
    state = next;
    if (history.impacts.size() >= max_impacts) {
      history.complete = false;
      history.duration = time_of(state, omega);
      end_at(state.position(), state.position_rate());
      return history;
    }
  }
}

}  // namespace backlash
