// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdint>
#include <optional>
#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/orbit_continuation.hpp"
#include "motion/gap_motion.hpp"
#include "steady_state/steady_state.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "support/long_run.hpp"
#include "support/random.hpp"
#include "support/stable_orbits.hpp"

namespace support {

/// How many stated intervals miss the truth.
struct Tally {
  int scenes = 0;
  int closed = 0;
  int averaged = 0;
  int flagged = 0;         // averaged, and said to be of a transient perhaps
  int missed = 0;          // of those not flagged
  int missed_flagged = 0;  // of the others
  double seconds = 0;      // of the library
  [[nodiscard]] int stated() const { return scenes - flagged; }

  void add(const backlash::detail::SteadyState& steady, bool hit) {
    ++scenes;
    if (steady.regime == backlash::Regime::averaged) {
      ++averaged;
    } else {
      ++closed;
    }
    if (steady.transient_possible) ++flagged;
    if (!hit) ++(steady.transient_possible ? missed_flagged : missed);
  }
};

struct HonestScene {
  double restitution;
  double gamma;
  backlash::detail::GapState start;
};

/// 1 - restitution, log-uniform: from 0.9 to 0.999 chaotic transients last longest, at moderate restitution they are
/// followed for fewer periods.
struct Losses {
  double least = 1e-3;
  double most = 0.1;
};
inline constexpr Losses moderate_losses{0.05, 0.3};

inline HonestScene transient_scene(Random& random, Losses losses = {}) {
  const double restitution = 1 - random.log_uniform(losses.least, losses.most);
  const double omega = random.log_uniform(0.5, 4);
  return {restitution, 1 / (omega * omega), backlash::detail::state_at_peak(random.unit(), 0)};
}

template <typename Work>
backlash::detail::SteadyState timed(double& seconds, const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  const backlash::detail::SteadyState steady = work();
  seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return steady;
}

/// Stated intervals against the motion after 10^5 force periods.  @param early  with the early stop of maps
inline Tally transients(int scenes, std::uint64_t seed, bool early, Losses losses = {}, std::int64_t periods = 96'000) {
  Random random(seed);
  Tally tally;
  for (int i = 0; i < scenes; ++i) {
    const HonestScene scene = transient_scene(random, losses);
    const backlash::detail::GapMotion motion(scene.gamma, scene.restitution);
    const backlash::detail::SteadyState steady = timed(tally.seconds, [&] {
      return find_steady_state(motion, scene.start, 1e-10, {early ? 0.01 : 0.0, -scene.gamma});
    });
    const LongRun truth = long_run(motion, scene.start, 100'000, periods);
    tally.add(steady, std::abs(steady.harmonics.u[0] - truth.u1) <= steady.uncertainty + truth.uncertainty);
  }
  return tally;
}

/// Two-impact orbits within 2e-4 of the frequency at which their symmetry breaks, against the closed form.
inline Tally pitchforks(int scenes, std::uint64_t seed) {
  Random random(seed);
  Tally tally;
  for (int i = 0; i < scenes; ++i) {
    const double restitution = random.uniform(0.1, 0.95);
    const double offset = random.log_uniform(1e-12, 4e-4) * (random.unit() < 0.5 ? -1 : 1);
    const double gamma = backlash::detail::symmetry_breaking_gamma(restitution) * (1 + offset);
    const auto orbit = backlash::detail::stable_two_impact_orbit(gamma, restitution);
    if (!orbit) continue;
    const std::complex<double> truth = two_impact_harmonics(*orbit, restitution).u[0];
    const backlash::detail::GapMotion motion(gamma, restitution);
    const backlash::detail::GapState start = state_at_next_peak(motion, orbit->start, 0);
    // Near the orbit, so that the scene does not lead elsewhere; far enough to be drawn to it slowly.
    const backlash::detail::GapState beside =
        backlash::detail::state_at_peak(start.position(), start.position_rate() + random.uniform(-0.02, 0.02));
    const backlash::detail::SteadyState steady =
        timed(tally.seconds, [&] { return find_steady_state(motion, beside, 1e-10); });
    // The asymmetric orbit and its mirror image have one describing function.
    tally.add(steady, std::abs(steady.harmonics.u[0] - truth) <= steady.uncertainty + 1e-12);
  }
  return tally;
}

/// U_1 + gamma of the symmetric two-impact orbit from the closed form in a wider type.  Masses and clearance are 1.
template <typename Wide>
std::complex<double> symmetric_u1_plus_gamma(double force, double omega, double restitution) {
  using std::sqrt;
  const Wide pi = 3.14159265358979323846264338327950288419716939937510L;
  const Wide gamma = Wide(force) / (Wide(omega) * Wide(omega));
  const Wide lost = 1 - Wide(restitution);
  const Wide kept = 1 + Wide(restitution);
  const Wide a = lost * lost + pi * pi * kept * kept / 4;
  const Wide half_b = pi * kept / 2;
  // half_b^2 - a (1 - 4 gamma^2), which is the difference of two numbers near 2.5 where restitution is near 1.
  const Wide discriminant = 4 * a * gamma * gamma - lost * lost;
  const Wide speed = (half_b + (discriminant > 0 ? sqrt(discriminant) : Wide(0))) / a;
  const Wide jump = -2 * kept * speed / pi / (2 * gamma);
  return {static_cast<double>(jump * (1 - half_b * speed)), static_cast<double>(jump * speed * lost)};
}

/// The symmetric orbit near its saddle-node, against long double: 64 bits of mantissa leave 2^-11 of the uncertainty.
inline Tally saddle_nodes(int scenes, std::uint64_t seed) {
  Random random(seed);
  Tally tally;
  for (int i = 0; i < scenes; ++i) {
    const double restitution = random.uniform(0.1, 0.99);
    const double omega = random.log_uniform(0.1, 10);
    const double above = random.log_uniform(1e-15, 0.1);
    const double force = backlash::detail::saddle_node_gamma(restitution) * (1 + above) * omega * omega;
    backlash::SweepOptions options;
    options.protocol = backlash::Protocol::two_impact;
    const auto point =
        backlash::describing_function_sweep({1, 1, 1, restitution}, force, {omega}, options).points.front();
    if (point.regime != backlash::Regime::symmetric) continue;
    const std::complex<double> truth = symmetric_u1_plus_gamma<long double>(force, omega, restitution) / (-2 * force);
    ++tally.scenes;
    ++tally.closed;
    if (!(std::abs(point.value - truth) <= point.uncertainty)) ++tally.missed;
  }
  return tally;
}

/// True where a branch of the diagram holds a stable orbit of that pattern and describing function at a value of its
/// parameter, between two neighbouring orbits.  A step along a branch changes phases and speeds by 0.03 at most, and
/// the value between two by the square of that.
inline bool lists(const backlash::OrbitDiagram& diagram, double parameter, const StableOrbit& orbit,
                  std::complex<double> value) {
  for (const backlash::OrbitBranch& branch : diagram.branches) {
    if (branch.period != orbit.period || branch.impacts != orbit.impacts) continue;
    for (std::size_t i = 0; i + 1 < branch.orbits.size(); ++i) {
      const backlash::PeriodicOrbit& a = branch.orbits[i];
      const backlash::PeriodicOrbit& b = branch.orbits[i + 1];
      if ((a.parameter - parameter) * (b.parameter - parameter) > 0 || !(a.stable || b.stable)) continue;
      const double share = a.parameter == b.parameter ? 0 : (parameter - a.parameter) / (b.parameter - a.parameter);
      const std::complex<double> there = a.value + share * (b.value - a.value);
      if (std::abs(there - value) < 1e-3 * std::abs(value) + 0.1 * std::abs(b.value - a.value)) return true;
    }
  }
  return false;
}

/// Describing function of the mass that is not forced.
inline std::complex<double> value_of(const StableOrbit& orbit, const backlash::TwoMassSystem& system, double omega,
                                     double gamma) {
  return -(1.0 + orbit.u1 / gamma) / ((system.mass1() + system.mass2()) * omega * omega);
}

/// Stable orbits that random starts settle on, of those that a diagram with its default limits holds, over random
/// pieces of the frequencies around: `missed` counts those it does not list.
/// @param starts  of each scene; more of them find orbits that attract fewer
/// @param widest  most that the diagram spans on either side of the frequency, as a factor
inline Tally listed_orbits(int orbits, std::uint64_t seed, int starts, double widest = 2) {
  Random random(seed);
  Tally tally;
  const backlash::OrbitContinuationOptions limits;
  while (tally.scenes < orbits) {
    const double restitution = random.uniform(0.05, 0.95);
    const double omega = random.log_uniform(0.7, 5);
    const backlash::TwoMassSystem system(random.log_uniform(0.1, 10), 1, 1, restitution);
    const double from = omega / random.log_uniform(1.05, widest);
    const double to = omega * random.log_uniform(1.05, widest);
    const backlash::detail::GapMotion motion(1 / (omega * omega), restitution);
    std::vector<StableOrbit> found;
    for (int i = 0; i < starts; ++i) {
      const auto start = motion.peak_state(0, {random.unit(), random.uniform(-2, 2)});
      const std::optional<StableOrbit> orbit = settle(motion, start, limits.longest_period);
      // The two-impact orbit, which most starts settle on, is known in closed form.
      if (!orbit || orbit->impacts > limits.most_impacts || (orbit->period == 1 && orbit->impacts == 2)) continue;
      const auto same = [&](const StableOrbit& other) {
        return other.period == orbit->period && other.impacts == orbit->impacts &&
               std::abs(other.u1 - orbit->u1) < 1e-6;
      };
      if (std::none_of(found.begin(), found.end(), same)) found.push_back(*orbit);
    }
    if (found.empty()) continue;
    const auto begin = std::chrono::steady_clock::now();
    const backlash::OrbitDiagram diagram = backlash::orbit_diagram(system, 1, from, to);
    tally.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (const StableOrbit& orbit : found) {
      ++tally.scenes;
      ++tally.closed;
      if (!lists(diagram, omega, orbit, value_of(orbit, system, omega, motion.gamma()))) ++tally.missed;
    }
  }
  return tally;
}

/// What every steady state of every scene must keep, each counted where it does not.
struct Properties {
  int scenes = 0;
  int not_finite = 0;
  int not_passive = 0;  // Im N1 < 0 by more than its uncertainty; see below for restitution 1
  int energy_unbalanced = 0;
  int not_similar = 0;  // other force, clearance and mass of one gamma, another response
  int dishonest = 0;    // of the `compared` scenes: a stated interval misses a long run, or 0 at restitution 1
  int compared = 0;
  int flagged = 0;

  Properties& operator+=(const Properties& other) {
    scenes += other.scenes;
    not_finite += other.not_finite;
    not_passive += other.not_passive;
    energy_unbalanced += other.energy_unbalanced;
    not_similar += other.not_similar;
    dishonest += other.dishonest;
    compared += other.compared;
    flagged += other.flagged;
    return *this;
  }
};

/// @param compared_each  scenes from one comparison with a long run to the next, which costs most of the time
inline Properties properties(int scenes, std::uint64_t seed, int compared_each) {
  Random random(seed);
  Properties result;
  for (int i = 0; i < scenes; ++i) {
    const double restitution = i % 20 == 0 ? 0 : i % 23 == 0 ? 1 : random.unit();
    const double gamma = i % 3 == 0 ? random.log_uniform(0.02, 1e4) : random.log_uniform(0.05, 3);
    const backlash::detail::GapMotion motion(gamma, restitution);
    const backlash::detail::GapState start = motion.peak_state(0, {random.unit(), random.uniform(-1, 1)});
    const bool early = i % 2 == 0;
    const backlash::detail::MeanGoal goal{early ? 0.01 : 0.0, -gamma};
    const backlash::detail::SteadyState steady = find_steady_state(motion, start, 1e-10, goal);
    ++result.scenes;
    if (!std::isfinite(std::abs(steady.harmonics.u[0])) || !(steady.uncertainty >= 0)) ++result.not_finite;
    // The force works on the relative motion; impacts take energy and give none.  At restitution 1 they do not even
    // take any, Im U of a long mean vanishes, and its interval is held against that.
    if (restitution == 1 && steady.regime == backlash::Regime::averaged) {
      ++result.compared;
      if (std::abs(steady.harmonics.u[0].imag()) > steady.uncertainty) ++result.dishonest;
    } else if (steady.harmonics.u[0].imag() > steady.uncertainty) {
      ++result.not_passive;
    }
    // Roundings of sums of velocity jumps, which exceed their result at strong forces by gamma^(2/3) or so.
    if (steady.energy_defect > 1e-10) ++result.energy_unbalanced;
    if (steady.transient_possible) ++result.flagged;

    // Times powers of 2, which leave every rounding as it is.
    const double omega = 1 / std::sqrt(gamma);
    const auto scene = [&](double mass, double clearance, double rate) {
      backlash::SweepOptions options;
      options.protocol = backlash::Protocol::mid_gap_at_rest;
      options.mean_tolerance = 0.01;
      options.threads = 1;
      const double force = mass * clearance * rate * rate;
      const auto point =
          backlash::describing_function_sweep({mass, mass, clearance, restitution}, force, {omega * rate}, options)
              .points.front();
      return point.value * (mass * rate * rate);
    };
    if (i % 10 == 0 && scene(1, 1, 1) != scene(8, 0.25, 4)) ++result.not_similar;

    if (i % compared_each != 0 || steady.transient_possible || restitution == 1) continue;
    const LongRun truth = long_run(motion, start, 4096, 4096);
    // The ends of an orbit that does not close over the window move its mean by one over the window.
    const double ends = 1.0 / 4096;
    ++result.compared;
    if (std::abs(steady.harmonics.u[0] - truth.u1) > steady.uncertainty + truth.uncertainty + ends) ++result.dishonest;
  }
  return result;
}

}  // namespace support
