// SPDX-License-Identifier: BSD-3-Clause
#include "symmetric_forced_orbit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/impact_law.hpp"
#include "forced_motion.hpp"
#include "loops/equations/cycle_stability.hpp"
#include "loops/equations/excursion.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

}  // namespace

SymmetricForcedOrbit::SymmetricForcedOrbit(const LinearBodies& bodies, const ImpulseAnswer& response, double force,
                                           double omega)
    : bodies_(bodies),
      asked_force_(force),
      orbits_(bodies, response, omega),
      train_(response, pi / omega),
      exchange_(speed_per_impulse(response.jump, bodies.system())),
      orbit_(orbits_.at(force, true)),
      drive_(bodies.drive().response(omega)),
      omega_(omega) {}

bool SymmetricForcedOrbit::exists() const {
  if (asked_force_ < orbits_.least_force() || !(orbit_.impulse > 0)) return false;
  const Complex forced = orbit_.force * drive_;
  const auto gap = [&](double t) {
    const Complex turned = forced * std::polar(1.0, omega_ * t);
    const TrainWave wave = train_.wave(t);
    return GapSample{turned.real() - orbit_.impulse * wave.value,
                     -omega_ * turned.imag() - orbit_.impulse * wave.slope};
  };
  const double clearance = bodies_.system().clearance();
  return !(gap(1e-6 * train_.half_period()).rate > 0) && largest_excursion(gap, train_.half_period()) < 0.5 * clearance;
}

double SymmetricForcedOrbit::bend() const {
  return train_.sums({0, omega_})[2].real() + omega_ * omega_ * (orbit_.force * drive_).real() / orbit_.impulse;
}

CycleStability SymmetricForcedOrbit::stability() const {
  return forced_stability(train_, exchange_, bend());
}

bool SymmetricForcedOrbit::is_stable() const {
  return is_forced_stable(train_, exchange_, bend());
}

DescribingFunctionPoint SymmetricForcedOrbit::point(Output output, const CycleStability& stability) const {
  DescribingFunctionPoint point = empty_point(omega_);
  const Complex read = output == Output::x1 ? orbit_.x1 : orbit_.x2;
  const frac::FractionalTransferFunction& body = output == Output::x1 ? bodies_.load() : bodies_.drive();
  const double kick = ForcedOrbits::impulse_share(omega_) * orbit_.impulse;
  point.value = read / orbit_.force;
  point.regime = Regime::symmetric;
  point.period = 1;
  point.impacts_per_period = 2;
  // The error that the inverse transform leaves of the sums, where they cancel least favourably.
  point.uncertainty = 1e-11 * std::abs(point.value);
  point.third_harmonic_ratio = std::abs(body.response(3 * omega_)) * kick / std::abs(read);
  point.even_harmonic_ratio = 0;
  point.lyapunov_exponent = 2 * std::log(std::abs(stability.dominant));
  return point;
}

LoopStart SymmetricForcedOrbit::at_peak() const {
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
  const double kick = ForcedOrbits::impulse_share(omega_) * orbit_.impulse;
  for (int k = 3; k < 100; k += 2) {
    const Complex turned = kick * std::polar(1.0, k * turn);
    add(k, bodies_.load().response(k * omega_) * turned, -bodies_.drive().response(k * omega_) * turned);
  }
  const double half = 0.5 * bodies_.system().clearance();
  state.x2 = std::clamp(state.x2, state.x1 - half, state.x1 + half);
  return state;
}

}  // namespace backlash::detail
