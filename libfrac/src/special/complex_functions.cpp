// SPDX-License-Identifier: BSD-3-Clause
#include "complex_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

// With t = e^{-2z}, Re z >= 0, so |t| <= 1: tanh z = (1 - t)/(1 + t), and 1 - t is computed without cancellation.
struct Halves {
  Complex decay;      // t
  Complex one_minus;  // 1 - t
  Complex one_plus;   // 1 + t
};

Halves halves(Complex z) {
  const Complex decay = exponential(-2.0 * z);
  if (decay == 0.0) return {0, 1, 1};
  const double half_angle = std::sin(z.imag());
  // e^{u+jv} - 1 = (e^u - 1) cos v - 2 sin^2(v/2) + j e^u sin v
  const double minus_one = std::expm1(-2 * z.real()) * std::cos(2 * z.imag()) - 2 * half_angle * half_angle;
  return {decay, {-minus_one, -decay.imag()}, 1.0 + decay};
}

}  // namespace

// On the imaginary axis 1 + t cancels near a pole; there it is j tan.
ValueAndDerivative hyperbolic_tangent(Complex z) {
  if (z.real() == 0) {
    const double tangent = std::tan(z.imag());
    return {{0, tangent}, 1 + tangent * tangent};
  }
  if (std::signbit(z.real())) {
    const ValueAndDerivative mirrored = hyperbolic_tangent(-z);
    return {-mirrored.value, mirrored.derivative};
  }
  const Halves h = halves(z);
  const Complex inverse = reciprocal(h.one_plus);
  return {product(h.one_minus, inverse), 4.0 * product(h.decay, product(inverse, inverse))};
}

ValueAndDerivative hyperbolic_cotangent(Complex z) {
  if (z.real() == 0) {
    const double cotangent = 1 / std::tan(z.imag());
    return {{0, -cotangent}, 1 + cotangent * cotangent};
  }
  if (std::signbit(z.real())) {
    const ValueAndDerivative mirrored = hyperbolic_cotangent(-z);
    return {-mirrored.value, mirrored.derivative};
  }
  const Halves h = halves(z);
  const Complex inverse = reciprocal(h.one_minus);
  return {product(h.one_plus, inverse), -4.0 * product(h.decay, product(inverse, inverse))};
}

// Each part is a product of real functions, so that small z lose no digits.
ValueAndDerivative hyperbolic_sine(Complex z) {
  const double sinh = std::sinh(z.real()), cosh = std::cosh(z.real());
  const double sine = std::sin(z.imag()), cosine = std::cos(z.imag());
  return {{sinh * cosine, cosh * sine}, {cosh * cosine, sinh * sine}};
}

ValueAndDerivative hyperbolic_cosine(Complex z) {
  const ValueAndDerivative sine = hyperbolic_sine(z);
  return {sine.derivative, sine.value};
}

// sech z = 2 e^{-z}/(1 + e^{-2z}) for Re z >= 0, and it is even.
ValueAndDerivative hyperbolic_secant(Complex z) {
  if (std::signbit(z.real())) {
    const ValueAndDerivative mirrored = hyperbolic_secant(-z);
    return {mirrored.value, -mirrored.derivative};
  }
  const Complex value = 2.0 * product(exponential(-z), reciprocal(halves(z).one_plus));
  return {value, -product(value, hyperbolic_tangent(z).value)};
}

ValueAndDerivative logarithm(Complex z) {
  return {principal_log(z), reciprocal(z)};
}

}  // namespace frac::detail
