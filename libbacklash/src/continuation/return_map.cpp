// SPDX-License-Identifier: BSD-3-Clause
#include "return_map.hpp"

#include <cmath>

#include "flight_equations.hpp"

namespace backlash::detail {

bool ScaledReturnMap::stable() const noexcept {
  return scale > 0 && std::abs(matrix[0] + matrix[3]) <= scale * (1 + determinant);
}

ScaledReturnMap return_map(const OrbitSegment& orbit) {
  ScaledReturnMap map{{1, 0, 0, 1}, 1, std::pow(orbit.restitution, 2.0 * static_cast<double>(orbit.impacts.size()))};
  const double gamma = orbit.gamma();
  for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
    const SegmentImpact to = orbit.impact(i + 1);
    const FlightEquations e = flight_equations(gamma, orbit.restitution, orbit.impact(i), to);
    // place_phase1 dphase1 = -(place_phase0 dphase0 + place_speed0 dspeed0), and place_phase1 = -side1 speed1.
    const double side = e.velocity_speed1;
    const double phase_phase = side * e.place_phase0;
    const double phase_speed = side * e.place_speed0;
    const double speed_phase = -side * (to.speed * e.velocity_phase0 + e.velocity_phase1 * phase_phase);
    const double speed_speed = -side * (to.speed * e.velocity_speed0 + e.velocity_phase1 * phase_speed);
    const std::array<double, 4> m = map.matrix;
    map.matrix = {phase_phase * m[0] + phase_speed * m[2], phase_phase * m[1] + phase_speed * m[3],
                  speed_phase * m[0] + speed_speed * m[2], speed_phase * m[1] + speed_speed * m[3]};
    map.scale *= to.speed;
  }
  return map;
}

std::array<std::complex<double>, 2> multipliers(const OrbitSegment& orbit) {
  const ScaledReturnMap map = return_map(orbit);
  const double half_trace = 0.5 * map.trace();
  const double discriminant = half_trace * half_trace - map.determinant;
  std::array<std::complex<double>, 2> result;
  if (discriminant < 0) {
    const double imaginary = std::sqrt(-discriminant);
    result = {std::complex<double>(half_trace, imaginary), std::complex<double>(half_trace, -imaginary)};
  } else {
    // The smaller one from the determinant, free of cancellation.
    const double larger = half_trace + std::copysign(std::sqrt(discriminant), half_trace);
    result = {larger, larger == 0 ? 0.0 : map.determinant / larger};
  }
  if (orbit.symmetric()) {
    // Real ones apart: the complex square of an infinite one has no phase.
    for (std::complex<double>& value : result) {
      value = value.imag() == 0 ? std::complex<double>(value.real() * value.real()) : value * value;
    }
  }
  return result;
}

Direction flip_direction(const OrbitSegment& orbit) {
  const ScaledReturnMap map = return_map(orbit);
  // Null vector of matrix + scale: from the larger of its rows.
  const double a = map.matrix[0] + map.scale;
  const double b = map.matrix[1];
  const double c = map.matrix[2];
  const double d = map.matrix[3] + map.scale;
  double phase = std::hypot(a, b) >= std::hypot(c, d) ? -b : -d;
  double speed = std::hypot(a, b) >= std::hypot(c, d) ? a : c;
  Direction half;
  const double gamma = orbit.gamma();
  for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
    half.push_back(phase);
    half.push_back(speed);
    const SegmentImpact to = orbit.impact(i + 1);
    const FlightEquations e = flight_equations(gamma, orbit.restitution, orbit.impact(i), to);
    const double next = -(e.place_phase0 * phase + e.place_speed0 * speed) / e.place_phase1;
    speed = -e.velocity_speed1 * (e.velocity_phase0 * phase + e.velocity_speed0 * speed + e.velocity_phase1 * next);
    phase = next;
  }
  Direction result = half;
  for (const double value : half) result.push_back(-value);
  result.push_back(0);
  const double norm = std::sqrt(dot(result, result));
  for (double& value : result) value /= norm;
  return result;
}

}  // namespace backlash::detail
