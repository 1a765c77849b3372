// SPDX-License-Identifier: BSD-3-Clause
#include "phi_functions.hpp"

#include <cmath>

namespace frac::detail {

using Complex = std::complex<double>;

Complex expm1(Complex z) {
  const double half_sine = std::sin(z.imag() / 2);
  return {std::expm1(z.real()) * std::cos(z.imag()) - 2 * half_sine * half_sine,
          std::exp(z.real()) * std::sin(z.imag())};
}

void phi(Complex z, std::span<Complex> value) {
  const std::size_t count = value.size();
  if (std::abs(z) < 2) {
    // The highest by its series, which 2^30/30! cuts off, the others by phi_n = 1/n! + z phi_(n+1).
    double inverse_factorial = 1;
    for (std::size_t n = 1; n <= count; ++n) inverse_factorial /= static_cast<double>(n);
    Complex term = inverse_factorial;
    Complex sum = 0;
    for (std::size_t k = 1; k < 30 && std::abs(term) > 1e-18 * inverse_factorial; ++k) {
      sum += term;
      term *= z / static_cast<double>(k + count);
    }
    value[count - 1] = sum;
    for (std::size_t n = count; n-- > 1;) {
      inverse_factorial *= static_cast<double>(n + 1);
      value[n - 1] = inverse_factorial + z * value[n];
    }
    return;
  }
  Complex previous = std::exp(z);
  double inverse_factorial = 1;
  for (std::size_t n = 1; n <= count; ++n) {
    value[n - 1] = previous = (previous - inverse_factorial) / z;
    inverse_factorial /= static_cast<double>(n);
  }
}

}  // namespace frac::detail
