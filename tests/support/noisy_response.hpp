// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "frac/model/frequency_response_data.hpp"
#include "frac/structure.hpp"

namespace support {

/// `count` frequencies from 1e-2 to 1e2 rad/s, evenly in the logarithm.
inline std::vector<double> four_decades(int count) {
  std::vector<double> omega;
  for (int i = 0; i < count; ++i) omega.push_back(1e-2 * std::pow(1e4, i / (count - 1.0)));
  return omega;
}

/// Response of a structure with normal relative noise of standard deviation `noise` on real and imaginary part each.
inline frac::FrequencyResponseData noisy_response(const char* formula, const std::vector<double>& parameters,
                                                  double noise, std::mt19937_64& generator, int count) {
  const frac::Structure structure(formula);
  std::normal_distribution<double> normal(0, noise);
  const std::vector<double> omega = four_decades(count);
  std::vector<std::complex<double>> value;
  for (const double each : omega) {
    const std::complex<double> exact = structure.response(parameters, each);
    const double real = normal(generator), imaginary = normal(generator);
    value.push_back(exact + std::abs(exact) * std::complex<double>(real, imaginary));
  }
  return {omega, value};
}

inline frac::FrequencyResponseData noisy_response(const char* formula, const std::vector<double>& parameters,
                                                  double noise, unsigned seed, int count = 60) {
  std::mt19937_64 generator(seed);
  return noisy_response(formula, parameters, noise, generator, count);
}

}  // namespace support
