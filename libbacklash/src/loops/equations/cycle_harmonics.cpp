// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_harmonics.hpp"

#include <functional>

namespace backlash::detail {

using Complex = std::complex<double>;

CycleHarmonic cycle_harmonic(const ControlLoop& loop, double omega, int order, Complex strength) {
  const double w = order * omega;
  const Complex load = loop.bodies().load().response(w);
  const Complex drive = loop.bodies().drive().response(w);
  const Complex controller = loop.controller().response(w);
  CycleHarmonic harmonic{order, strength * load, 0, 0};
  if (loop.measured() == Output::x1) {
    harmonic.force = -controller * harmonic.x1;
    harmonic.x2 = drive * (harmonic.force - strength);
  } else {
    harmonic.x2 = -strength * drive / (1.0 + controller * drive);
    harmonic.force = -controller * harmonic.x2;
  }
  return harmonic;
}

Complex image_of_gap(const ControlLoop& loop, double omega) {
  const Complex load = loop.bodies().load().response(omega);
  const Complex drive = loop.bodies().drive().response(omega);
  const Complex controller = loop.controller().response(omega);
  return loop.measured() == Output::x1 ? load + drive + controller * load * drive
                                       : load + drive / (1.0 + controller * drive);
}

namespace {

// Limit at frequency 0 of a response, if it has one.
std::optional<double> limit_of(const std::function<Complex(double)>& response, double omega) {
  const Complex low = response(1e-6 * omega);
  if (std::abs(response(1e-12 * omega)) > 2 * std::abs(low)) return std::nullopt;
  return low.real();
}

}  // namespace

std::optional<double> static_gap(const ControlLoop& loop, double omega) {
  return limit_of([&](double at) { return image_of_gap(loop, at); }, omega);
}

std::optional<double> static_gap(const LinearBodies& bodies, double omega) {
  return limit_of([&](double at) { return bodies.load().response(at) + bodies.drive().response(at); }, omega);
}

}  // namespace backlash::detail
