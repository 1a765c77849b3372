// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_basins.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>

#include "backlash/compliant/compliant_history.hpp"
#include "base/check.hpp"
#include "compliant_point.hpp"
#include "steady_state/describing_function_point.hpp"
#include "steady_state/start_search.hpp"

namespace backlash {
namespace {

// What is kept of a start.
struct StartMotion {
  DescribingFunctionPoint point;
  std::complex<double> second;
  bool is_symmetric;
};

// In the order of StartOutcome; the rest of that is 0.
StartOutcome outcome_of(const detail::CompliantReached& reached) {
  const DescribingFunctionPoint& point = reached.point;
  return {static_cast<double>(point.regime),
          static_cast<double>(point.period),
          point.value.real(),
          point.value.imag(),
          point.impacts_per_period,
          point.uncertainty,
          point.third_harmonic_ratio,
          point.even_harmonic_ratio,
          point.energy_defect,
          point.lyapunov_exponent,
          point.periods_followed,
          point.transient_possible ? 1.0 : 0.0,
          reached.second.real(),
          reached.second.imag(),
          reached.is_symmetric ? 1.0 : 0.0};
}

StartMotion motion_of(const StartOutcome& outcome, double omega) {
  DescribingFunctionPoint point = detail::empty_point(omega);
  point.regime = static_cast<Regime>(outcome[0]);
  point.period = static_cast<int>(outcome[1]);
  point.value = {outcome[2], outcome[3]};
  point.impacts_per_period = outcome[4];
  point.uncertainty = outcome[5];
  point.third_harmonic_ratio = outcome[6];
  point.even_harmonic_ratio = outcome[7];
  point.energy_defect = outcome[8];
  point.lyapunov_exponent = outcome[9];
  point.periods_followed = outcome[10];
  point.transient_possible = outcome[11] != 0;
  return {point, {outcome[12], outcome[13]}, outcome[14] != 0};
}

// Of closed orbits phasors agree to this share of the clearance; twins differ in the sign of the second harmonic.
constexpr double same_orbit = 1e-6;

}  // namespace

BasinMap basins(const CompliantBodies& bodies, double force_amplitude, double omega,
                const std::vector<double>& position, const std::vector<double>& velocity, const SweepOptions& options,
                frac::Progress* progress) {
  return detail::in_memory([&](OutcomeStore& store) {
    return basins(bodies, force_amplitude, omega, position, velocity, options, progress, store);
  });
}

BasinMap basins(const CompliantBodies& bodies, double force_amplitude, double omega,
                const std::vector<double>& position, const std::vector<double>& velocity, const SweepOptions& options,
                frac::Progress* progress, OutcomeStore& store) {
  detail::require_positive("force_amplitude", "N", force_amplitude);
  detail::require_positive("omega", "rad/s", omega);
  detail::require_valid(options);
  detail::require_followed(bodies, omega);
  const TwoMassSystem& system = bodies.system();
  detail::require_starts(system, position, velocity);
  detail::StartSearch search(position.size() * velocity.size(), options.threads, store);
  search.follow(
      [&](std::size_t i) {
        detail::CompliantPoint point(bodies, force_amplitude, omega, options, true);
        return outcome_of(point.follow(start_about_mean(
            system, force_amplitude, omega, {position[i / velocity.size()], velocity[i % velocity.size()]})));
      },
      progress);

  BasinMap map{system, force_amplitude, omega, position, velocity, {}, {}};
  map.has_friction = bodies.friction().body1 > 0 || bodies.friction().body2 > 0 || !bodies.hard().are_free();
  const double size = same_orbit * system.clearance() / force_amplitude;
  const auto same = [size](const StartMotion& a, const StartMotion& b) {
    if (a.point.regime != b.point.regime) return false;
    if (a.point.regime == Regime::free) return true;
    const double apart = std::abs(a.point.value - b.point.value);
    if (a.point.regime == Regime::averaged) return apart <= a.point.uncertainty + b.point.uncertainty;
    return a.point.period == b.point.period && a.point.impacts_per_period == b.point.impacts_per_period &&
           apart <= size && std::abs(a.second - b.second) <= size;
  };
  detail::MotionsOfStarts<StartMotion, decltype(same)> motions(same);
  search.for_each_outcome([&](std::size_t, const StartOutcome& each) { motions.add(motion_of(each, omega)); });
  motions.write(map, [](const StartMotion& motion, std::size_t starts) {
    return Attractor{motion.point, motion.is_symmetric, starts};
  });
  return map;
}

}  // namespace backlash
