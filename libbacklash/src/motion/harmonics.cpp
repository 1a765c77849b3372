// SPDX-License-Identifier: BSD-3-Clause
#include "harmonics.hpp"

#include <cmath>
#include <numbers>

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

// With tau = K pi - pi/2 + s, e^{-j k tau} = (-1)^(K k) j^k e^{-j k s}; with the side of the wall, +1 or -1, the sign
// makes the parity of the state for odd k, and j^k is exact.

// e^{-jks} times that sign for the orders kept.
HarmonicSums signed_powers(const GapState& state) noexcept {
  const double sin_s = state.sin_s;
  const double cos_s = state.cos_s;
  const double parity = state.parity();
  const double side = state.wall == 0 ? 1 : -1;
  const Complex e1(cos_s, -sin_s);
  const Complex e2(cos_s * cos_s - sin_s * sin_s, -2 * sin_s * cos_s);
  const auto times_e2 = [&e2](Complex z) {
    return Complex(z.real() * e2.real() - z.imag() * e2.imag(), z.real() * e2.imag() + z.imag() * e2.real());
  };
  const Complex e3 = times_e2(e1);
  return {parity * e1, parity * e3, parity * times_e2(e3), side * e2};
}

// Integral of e^{-j n x} over [0, h].
Complex exponential_integral(int n, double h) noexcept {
  if (n == 0) return h;
  const double half = 0.5 * n * h;
  return 2 * std::sin(half) / n * Complex(std::cos(half), -std::sin(half));
}

// Integral over [0, h] of the distance times e^{-j k x}, h short: Taylor series of the distance with the moments
// m_n = int_0^1 y^n e^{-j z y} dy, z = k h, from the recurrence m_{n-1} = (e^{-jz} + j z m_n)/n, which is stable
// downwards; an error of the starting value is multiplied by z^26/26! < 1e-18.
Complex short_flight_integral(const GapState& start, const Flight& flight, int k) noexcept {
  constexpr int terms = 14;
  const double h = flight.duration;
  std::array<double, terms> coefficient{};
  coefficient[0] = start.distance * h;
  coefficient[1] = start.velocity * h * h;
  double even = flight.push * h * h * h / 2;
  double odd = flight.pull * h * h * h * h / 6;
  for (int n = 2; n + 1 < terms; n += 2) {
    coefficient[static_cast<std::size_t>(n)] = even;
    coefficient[static_cast<std::size_t>(n) + 1] = odd;
    even *= -h * h / ((n + 1) * (n + 2));
    odd *= -h * h / ((n + 2) * (n + 3));
  }
  const double z = k * h;
  const Complex end(std::cos(z), -std::sin(z));
  constexpr int start_order = 26;
  Complex moment = end / static_cast<double>(start_order + 1);
  Complex sum = 0;
  for (int n = start_order; n >= 0; --n) {
    if (n < terms) sum += coefficient[static_cast<std::size_t>(n)] * moment;
    if (n > 0)
      moment = Complex(end.real() - z * moment.imag(), end.imag() + z * moment.real()) / static_cast<double>(n);
  }
  return sum;
}

// The integral by two integrations by parts: exact, but its terms are larger than the sum by 1/h^2.
Complex long_flight_integral(const GapState& start, const Flight& flight, int k) noexcept {
  const double h = flight.duration;
  const double sin_h = std::sin(h);
  const double cos_h = std::cos(h);
  const double distance = start.distance + start.velocity * h + flight.push * (1 - cos_h) + flight.pull * (h - sin_h);
  const double velocity = start.velocity + flight.push * sin_h + flight.pull * (1 - cos_h);
  const Complex end = std::polar(1.0, -k * h);
  // acceleration = push cos x + pull sin x
  const Complex minus = exponential_integral(k - 1, h);
  const Complex plus = exponential_integral(k + 1, h);
  const Complex cos_integral = 0.5 * (minus + plus);
  const Complex sin_integral = Complex(0, -0.5) * (minus - plus);
  const Complex acceleration = flight.push * cos_integral + flight.pull * sin_integral;
  const double order = k;
  return Complex(0, 1 / order) * (distance * end - start.distance) +
         (velocity * end - start.velocity - acceleration) / (order * order);
}

}  // namespace

Complex quarter_turns(int k, Complex z) noexcept {
  switch (k & 3) {
    case 0:
      return z;
    case 1:
      return {-z.imag(), z.real()};
    case 2:
      return -z;
    default:
      return {z.imag(), -z.real()};
  }
}

Harmonics harmonics_of_jumps(const JumpSum& jumps, double gamma, double half_periods) {
  Harmonics result;
  for (std::size_t i = 0; i < harmonic_orders.size(); ++i) {
    const int k = harmonic_orders[i];
    result.u[i] = quarter_turns(k, jumps.sums()[i]) * (-2 / (pi * half_periods * k * k));
  }
  result.u1_plus_gamma = result.u[0];
  result.u[0] -= gamma;
  return result;
}

void FlightSum::add_flight(const GapState& start, const Flight& flight) noexcept {
  const HarmonicSums e = signed_powers(start);
  for (std::size_t i = 0; i < e.size(); ++i) {
    const int k = harmonic_orders[i];
    const Complex integral =
        flight.duration < 0.4 ? short_flight_integral(start, flight, k) : long_flight_integral(start, flight, k);
    flights_[i] += e[i] * integral;
  }
}

void FlightSum::add_crossing(const GapState& state) noexcept {
  const HarmonicSums e = signed_powers(state);
  for (std::size_t i = 0; i < e.size(); ++i) crossings_[i] += e[i];
}

void FlightSum::add_tail(const GapState& state, const ChatterTail& tail) noexcept {
  const HarmonicSums e = signed_powers(state);
  for (std::size_t i = 0; i < e.size(); ++i) flights_[i] += tail.area * e[i];
}

FlightSum& FlightSum::operator+=(const FlightSum& other) noexcept {
  for (std::size_t i = 0; i < flights_.size(); ++i) {
    flights_[i] += other.flights_[i];
    crossings_[i] += other.crossings_[i];
  }
  return *this;
}

Harmonics FlightSum::harmonics(double gamma, double half_periods) const {
  Harmonics result;
  for (std::size_t i = 0; i < harmonic_orders.size(); ++i) {
    const int k = harmonic_orders[i];
    const double scale = 2 / (pi * half_periods);
    result.u[i] = quarter_turns(k, flights_[i]) * scale - quarter_turns(k - 1, crossings_[i]) * (scale / k);
  }
  if (std::fmod(half_periods, 2) != 0) result.u[second_harmonic] = 0;
  result.u1_plus_gamma = result.u[0] + gamma;
  return result;
}

}  // namespace backlash::detail
