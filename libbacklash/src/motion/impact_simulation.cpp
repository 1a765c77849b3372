// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/impact_simulation.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/check.hpp"
#include "frac/cancellation.hpp"
#include "gap_motion.hpp"
#include "motion_piece.hpp"
#include "simulation_start.hpp"

namespace backlash {
namespace {

constexpr double pi = std::numbers::pi;

// Seconds from tau = 0, at half_period 1 and s = -pi/2.
double time_of(const detail::GapState& state, double omega) {
  return (static_cast<double>(state.half_period - 1) * pi + (state.s + pi / 2)) / omega;
}

}  // namespace

namespace detail {

SimulationStart simulation_start(const TwoMassSystem& system, double force_amplitude, double omega,
                                 const RelativeState& start, int periods) {
  const double gamma = dimensionless_force(system, force_amplitude, omega);
  if (system.clearance() == 0) {
    throw std::invalid_argument(
        "clearance is 0; the masses then move as one, without impacts: it must be positive (m)");
  }
  if (!(gamma > 0 && gamma < 1e30)) {
    throw std::invalid_argument("F/(M2 clearance omega^2) is " + text(gamma) + "; it must be in (0, 1e30)");
  }
  if (!(start.position >= 0 && start.position <= system.clearance())) {
    throw std::invalid_argument("start.position is " + text(start.position) +
                                "; it must be in [0, clearance = " + text(system.clearance()) + "] (m)");
  }
  const bool into_near = start.position == 0 && start.velocity < 0;
  const bool into_far = start.position == system.clearance() && start.velocity > 0;
  if (!std::isfinite(start.velocity) || into_near || into_far) {
    throw std::invalid_argument("start.velocity is " + text(start.velocity) +
                                "; it must be finite and, at a wall, not into it (m/s)");
  }
  if (periods <= 0) throw std::invalid_argument("periods is " + std::to_string(periods) + "; it must be positive");
  const double speed_unit = system.clearance() * omega;
  return {GapMotion(gamma, system.restitution()),
          state_at_peak(start.position / system.clearance(), start.velocity / speed_unit), speed_unit};
}

}  // namespace detail

ImpactHistory simulate_impacts(const TwoMassSystem& system, double force_amplitude, double omega,
                               const RelativeState& start, int periods, std::size_t max_impacts) {
  const auto [motion, begin, speed_unit] = detail::simulation_start(system, force_amplitude, omega, start, periods);
  const double total_mass = system.mass1() + system.mass2();
  const double reduced_mass = system.mass1() / total_mass * system.mass2();
  // The centre of mass moves as F/((M1 + M2) omega) sin(omega t).
  const double mean_speed = force_amplitude / total_mass / omega;
  const std::int64_t last_peak = 1 + 2 * static_cast<std::int64_t>(periods);

  ImpactHistory history{{}, {}, 2 * pi * periods / omega, true, {}};
  const auto end_at = [&history, &system, unit = speed_unit](const detail::GapState& end) {
    history.end = {end.position() * system.clearance(), end.position_rate() * unit};
  };
  detail::GapState state = begin;
  for (;;) {
    frac::throw_if_cancelled();
    const detail::MotionPiece piece = detail::piece_from(motion, state, detail::neglected_tail);
    const bool lasts = piece.end.half_period >= last_peak;
    if (piece.is_rest) {
      history.rests.push_back({time_of(piece.begin, omega), lasts ? history.duration : time_of(piece.end, omega),
                               detail::wall_of(piece.begin), reduced_mass * piece.tail_loss * speed_unit * speed_unit});
      if (lasts) {
        end_at(detail::state_at_peak(piece.begin.wall, 0));
        return history;
      }
      state = piece.end;
      continue;
    }
    if (!piece.flight.hits || lasts) {
      const double rest_of_time = detail::radians_to_half_period(piece.begin, last_peak);
      end_at(motion.peak_state(piece.begin.wall, motion.along(piece.begin, piece.flight, rest_of_time)));
      return history;
    }
    // Relative velocity x2' - x1' just before: into the wall that is met.
    const double relative = (piece.end.wall == 0 ? -piece.flight.speed : piece.flight.speed) * speed_unit;
    // sin(omega t) = -(-1)^K cos s
    const double mean = ((piece.end.half_period & 1) != 0 ? piece.end.cos_s : -piece.end.cos_s) * mean_speed;
    const ImpactVelocities before{mean - system.mass2() / total_mass * relative,
                                  mean + system.mass1() / total_mass * relative};
    history.impacts.push_back({time_of(piece.end, omega), detail::wall_of(piece.end), before,
                               post_impact_velocities(system, before), impact_energy_loss(system, relative)});
    state = piece.end;
    if (history.impacts.size() >= max_impacts) {
      history.complete = false;
      history.duration = time_of(state, omega);
      end_at(state);
      return history;
    }
  }
}

}  // namespace backlash
