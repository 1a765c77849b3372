// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

namespace frac {

/// Angular frequencies (rad/s) between which an approximation is asked for, 0 < lower < upper.
struct FrequencyBand {
  double lower;
  double upper;
  bool operator==(const FrequencyBand&) const = default;
};

/// Rational transfer function with a whole power of s split off:
///   H(s) = gain s^integer_order prod (s - zeros_i) / prod (s - poles_i),   zeros and poles in rad/s.
/// Real zeros and poles are listed one by one; of a conjugate pair, which makes the factor (s - c)(s - conj c), only
/// the member with positive imaginary part.
struct ZeroPoleGain {
  std::vector<double> zeros;
  std::vector<double> poles;
  double gain = 1;
  int integer_order = 0;
  std::vector<std::complex<double>> zero_pairs = {};
  std::vector<std::complex<double>> pole_pairs = {};

  /// H(j omega), omega in rad/s, > 0.
  [[nodiscard]] std::complex<double> response(double omega) const;
};

}  // namespace frac
