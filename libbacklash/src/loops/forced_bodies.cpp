// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/forced_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/check.hpp"
#include "cycle_stability.hpp"
#include "excursion.hpp"
#include "forced_motion.hpp"
#include "forced_orbits.hpp"
#include "frac/parallel_for.hpp"
#include "gap_response.hpp"
#include "steady_state/describing_function_point.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
class Point {
 public:
  Point(const LinearBodies& bodies, const detail::GapResponse& response, double force, double omega)
      : bodies_(bodies),
        orbits_(bodies, response, omega),
        train_(response, pi / omega),
        exchange_(response.jump / (1 + bodies.system().restitution())),
        orbit_(orbits_.at(force, true)),
        drive_(bodies.drive().response(omega)),
        omega_(omega) {}

  [[nodiscard]] bool exists(double force) const {
    if (force < orbits_.least_force() || !(orbit_.impulse > 0)) return false;
    const Complex forced = orbit_.force * drive_;
    const auto gap = [&](double t) {
      const Complex turned = forced * std::polar(1.0, omega_ * t);
      const detail::TrainWave wave = train_.wave(t);
      return detail::GapSample{turned.real() - orbit_.impulse * wave.value,
                               -omega_ * turned.imag() - orbit_.impulse * wave.slope};
    };
    const double clearance = bodies_.system().clearance();
    return !(gap(1e-6 * train_.half_period()).rate > 0) &&
           detail::largest_excursion(gap, train_.half_period()) < 0.5 * clearance;
  }
  [[nodiscard]] CycleStability stability() const {
    // Before the impact, over -I: of the train and of the force.
    const double acceleration =
        train_.sums({0, omega_})[2].real() + omega_ * omega_ * (orbit_.force * drive_).real() / orbit_.impulse;
    return detail::forced_stability(train_, exchange_, acceleration);
  }
  [[nodiscard]] DescribingFunctionPoint point(Output output, const CycleStability& stability) const {
    DescribingFunctionPoint point = detail::empty_point(omega_);
    const Complex read = output == Output::x1 ? orbit_.x1 : orbit_.x2;
    const frac::FractionalTransferFunction& body = output == Output::x1 ? bodies_.load() : bodies_.drive();
    const double kick = detail::ForcedOrbits::impulse_share(omega_) * orbit_.impulse;
    point.value = read / orbit_.force;
    point.regime = Regime::symmetric;
    point.period = 1;
    point.impacts_per_period = 2;
    // What the inverse transform leaves of the sums, where they cancel least favourably.
    point.uncertainty = 1e-11 * std::abs(point.value);
    point.third_harmonic_ratio = std::abs(body.response(3 * omega_)) * kick / std::abs(read);
    point.even_harmonic_ratio = 0;
    point.lyapunov_exponent = 2 * std::log(std::abs(stability.dominant));
    return point;
  }
  /// Roughly where the bodies are at a peak of the force.
  [[nodiscard]] LoopStart at_peak() const {
    const double turn = -std::arg(orbit_.force);
    LoopStart state;
    const auto add = [&](double order, Complex x1, Complex x2) {
      const Complex rate(0, order * omega_);
      state.x1 += x1.real();
      state.v1 += (rate * x1).real();
      state.x2 += x2.real();
      state.v2 += (rate * x2).real();
    };
    add(1, orbit_.x1 * std::polar(1.0, turn), orbit_.x2 * std::polar(1.0, turn));
    const double kick = detail::ForcedOrbits::impulse_share(omega_) * orbit_.impulse;
    for (int k = 3; k < 100; k += 2) {
      const Complex turned = kick * std::polar(1.0, k * turn);
      add(k, bodies_.load().response(k * omega_) * turned, -bodies_.drive().response(k * omega_) * turned);
    }
    const double half = 0.5 * bodies_.system().clearance();
    state.x2 = std::clamp(state.x2, state.x1 - half, state.x1 + half);
    return state;
  }

 private:
  const LinearBodies& bodies_;
  detail::ForcedOrbits orbits_;
  detail::ImpulseTrain train_;
  double exchange_;
  detail::ForcedOrbits::Orbit orbit_;
  Complex drive_;
  double omega_;
};

}  // namespace

DescribingFunctionSweep bodies_describing_function(const LinearBodies& bodies, double force_amplitude,
                                                   const std::vector<double>& omega, const SweepOptions& options) {
  if (bodies.are_free()) return describing_function_sweep(bodies.system(), force_amplitude, omega, options);
  detail::require_valid(options);
  detail::require_positive("clearance", "m", bodies.system().clearance());
  detail::require_positive("force amplitude", "N", force_amplitude);
  detail::require_frequency_grid(omega);
  const detail::GapResponse response = detail::gap_response(bodies);
  DescribingFunctionSweep sweep{bodies.system(), force_amplitude, options, {}};
  sweep.points.resize(omega.size());
  const auto begin = [&] {
    LoopStart start;
    if (options.protocol == Protocol::contact_at_rest) {
      start.x1 = 0.25 * bodies.system().clearance();
      start.x2 = -start.x1;
    }
    return start;
  };
  const bool is_carried =
      options.protocol != Protocol::contact_at_rest && options.protocol != Protocol::mid_gap_at_rest;
  LoopStart carried = begin();
  const auto follow = [&](std::size_t i) {
    const double at = omega[i];
    if (options.protocol == Protocol::two_impact) {
      const Point point(bodies, response, force_amplitude, at);
      if (point.exists(force_amplitude)) {
        const CycleStability stability = point.stability();
        if (stability.stable) {
          sweep.points[i] = point.point(options.output, stability);
          carried = point.at_peak();
          return;
        }
      }
    }
    const detail::ForcedMotion motion =
        detail::follow_forced(bodies, force_amplitude, at, is_carried ? carried : begin(), options);
    sweep.points[i] = motion.point;
    if (is_carried) carried = motion.end;
  };
  if (is_carried) {
    const bool is_down = options.protocol == Protocol::sweep_down;
    for (std::size_t i = 0; i < omega.size(); ++i) follow(is_down ? omega.size() - 1 - i : i);
  } else {
    frac::parallel_for(omega.size(), options.threads, follow);
  }
  return sweep;
}

}  // namespace backlash
