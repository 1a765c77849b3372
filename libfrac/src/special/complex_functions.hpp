// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>

namespace frac::detail {

/// a b without the recovery of infinities that operator* of std::complex spends time on.
[[nodiscard]] inline std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// 1/z, scaled where |z|^2 would leave the range of double.
[[nodiscard]] inline std::complex<double> reciprocal(std::complex<double> z) {
  const double square = z.real() * z.real() + z.imag() * z.imag();
  if (square > 1e-280 && square < 1e280) return {z.real() / square, -z.imag() / square};
  const double size = std::max(std::abs(z.real()), std::abs(z.imag()));
  const double re = z.real() / size;
  const double im = z.imag() / size;
  const double scaled = re * re + im * im;
  return {re / scaled / size, -im / scaled / size};
}

/// z^exponent by repeated squaring.
[[nodiscard]] inline std::complex<double> whole_power(std::complex<double> z, int exponent) {
  if (exponent < 0) return reciprocal(whole_power(z, -exponent));
  std::complex<double> result = 1;
  for (std::complex<double> square = z; exponent > 0; exponent >>= 1) {
    if (exponent % 2 == 1) result = product(result, square);
    if (exponent > 1) square = product(square, square);
  }
  return result;
}

/// ln|z| + j arg z.
[[nodiscard]] inline std::complex<double> principal_log(std::complex<double> z) {
  const double square = z.real() * z.real() + z.imag() * z.imag();
  const double log_size =
      square > 1e-280 && square < 1e280 ? 0.5 * std::log(square) : std::log(std::hypot(z.real(), z.imag()));
  return {log_size, std::atan2(z.imag(), z.real())};
}

[[nodiscard]] inline std::complex<double> exponential(std::complex<double> z) {
  const double size = std::exp(z.real());
  if (size == 0) return 0;  // also where the angle is infinite
  return {size * std::cos(z.imag()), size * std::sin(z.imag())};
}

struct ValueAndDerivative {
  std::complex<double> value;
  std::complex<double> derivative;
};

/// tanh z and its derivative; no overflow however large z is.
[[nodiscard]] ValueAndDerivative hyperbolic_tangent(std::complex<double> z);
/// coth z and its derivative.
[[nodiscard]] ValueAndDerivative hyperbolic_cotangent(std::complex<double> z);
/// sinh z, cosh z and their derivatives; they overflow where |Re z| > 710.
[[nodiscard]] ValueAndDerivative hyperbolic_sine(std::complex<double> z);
[[nodiscard]] ValueAndDerivative hyperbolic_cosine(std::complex<double> z);
/// 1/cosh z and its derivative; no overflow however large z is.
[[nodiscard]] ValueAndDerivative hyperbolic_secant(std::complex<double> z);
/// Principal logarithm and 1/z.
[[nodiscard]] ValueAndDerivative logarithm(std::complex<double> z);

}  // namespace frac::detail
