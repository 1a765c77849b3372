// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/forced_bodies.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "base/check.hpp"
#include "cycle_stability.hpp"
#include "excursion.hpp"
#include "forced_orbits.hpp"
#include "gap_response.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

DescribingFunctionPoint empty_point(double omega) {
  DescribingFunctionPoint point{};
  point.omega = omega;
  point.value = {nothing, nothing};
  point.regime = Regime::averaged;
  point.impacts_per_period = point.uncertainty = point.third_harmonic_ratio = nothing;
  return point;
}

// Body 1 at rest where its own springs hold it; body 2 about the middle of the clearance.
DescribingFunctionPoint free_point(double omega, Complex drive, Output output) {
  DescribingFunctionPoint point = empty_point(omega);
  point.value = output == Output::x1 ? 0 : drive;
  point.regime = Regime::free;
  point.period = 1;
  point.impacts_per_period = 0;
  point.uncertainty = 1e-15 * std::abs(point.value);
  point.energy_defect = 0;
  return point;
}

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
      const detail::ImpulseTrain::Wave wave = train_.wave(t);
      return detail::GapMotion{turned.real() - orbit_.impulse * wave.value,
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
    DescribingFunctionPoint point = empty_point(omega_);
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
                                                   const std::vector<double>& omega, Output output) {
  SweepOptions options;
  options.protocol = Protocol::two_impact;
  options.output = output;
  if (bodies.are_free()) return describing_function_sweep(bodies.system(), force_amplitude, omega, options);
  detail::require_positive("clearance", "m", bodies.system().clearance());
  detail::require_positive("force amplitude", "N", force_amplitude);
  detail::require_frequency_grid(omega);
  const detail::GapResponse response = detail::gap_response(bodies);
  DescribingFunctionSweep sweep{bodies.system(), force_amplitude, options, {}};
  for (const double each : omega) {
    const Point point(bodies, response, force_amplitude, each);
    if (point.exists(force_amplitude)) {
      const CycleStability stability = point.stability();
      if (stability.stable) {
        sweep.points.push_back(point.point(output, stability));
        continue;
      }
    }
    const Complex drive = bodies.drive().response(each);
    const bool stays_free = force_amplitude * std::abs(drive) < 0.5 * bodies.system().clearance();
    sweep.points.push_back(stays_free ? free_point(each, drive, output) : empty_point(each));
  }
  return sweep;
}

}  // namespace backlash
