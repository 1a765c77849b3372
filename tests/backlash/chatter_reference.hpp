// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <complex>

namespace reference {

/// U_1 of the symmetric orbit that sticks once per half period: released at u = 0, across in one flight, hops at u = 1
/// until at rest there.  Fifty decimal digits, phases counted from the peak of the force, chatter cut off at a speed of
/// 1e-10; shares no formula with the library beyond the equation of motion.
inline std::complex<double> sticking_orbit_harmonic(double gamma_value, double restitution_value) {
  using Real = boost::multiprecision::cpp_bin_float_50;
  const Real gamma = gamma_value;
  const Real restitution = restitution_value;
  const Real pi = boost::math::constants::pi<Real>();
  Real tau = -pi / 2;  // release
  Real u = 0;
  Real rate = 0;
  // Integral of u e^{-j tau} over a flight, by the antiderivative of u = a + b tau - gamma cos tau times e^{-j tau}.
  Real sum_real = 0;
  Real sum_imaginary = 0;
  const auto add = [&](const Real& a, const Real& b, const Real& from, const Real& to) {
    const auto real = [&](const Real& t) {
      return a * sin(t) + b * (cos(t) + t * sin(t)) - gamma * (t / 2 + sin(2 * t) / 4);
    };
    const auto imaginary = [&](const Real& t) {
      return a * cos(t) + b * (t * cos(t) - sin(t)) - gamma * cos(2 * t) / 4;
    };
    sum_real += real(to) - real(from);
    sum_imaginary += imaginary(to) - imaginary(from);
  };
  const auto contact = [&](Real h, const Real& target) {
    for (int i = 0; i < 60; ++i) {
      const Real distance = u + (rate - gamma * sin(tau)) * h - gamma * (cos(tau + h) - cos(tau)) - target;
      const Real speed = rate + gamma * (sin(tau + h) - sin(tau));
      const Real step = distance / speed;
      h -= step;
      if (abs(step) < Real("1e-20") * h) break;
    }
    return h;
  };
  // gamma (h - sin h) = 1: Newton from h = (6/gamma)^(1/3), from below the root of a convex function.
  Real h = contact(cbrt(Real(6) / gamma), 1);
  for (;;) {
    const Real b = rate - gamma * sin(tau);
    add(u - b * tau + gamma * cos(tau), b, tau, tau + h);
    rate = -restitution * (rate + gamma * (sin(tau + h) - sin(tau)));
    tau += h;
    u = 1;
    if (abs(rate) < Real("1e-10")) break;
    h = contact(-2 * rate / (gamma * cos(tau)), 1);
  }
  add(1, 0, tau, pi / 2);
  // The force does not enter at rest: take its share of `add` back.
  sum_real += gamma * ((pi / 2 - tau) / 2 + (sin(pi) - sin(2 * tau)) / 4);
  sum_imaginary += gamma * (cos(pi) - cos(2 * tau)) / 4;
  // The other half is the mirror image, so it adds the same to the fundamental but for its mean 1, which it has not: u
  // -> 1 - u at tau + pi gives -int (1 - u) e^{-j tau} = int u e^{-j tau} - int e^{-j tau}.
  const Real full_real = 2 * sum_real - 2;  // int of cos over (-pi/2, pi/2) is 2, of sin 0
  const Real full_imaginary = 2 * sum_imaginary;
  return {static_cast<double>(full_real / pi), static_cast<double>(full_imaginary / pi)};
}

}  // namespace reference
