// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "frac/model/frequency_response_data.hpp"
#include "frac/structure.hpp"
#include "support/random.hpp"

namespace support {

/// A measurement with noise, as an instrument would make it: sweep from high to low frequency.
struct Sweep {
  std::vector<double> omega;  // rising
  std::vector<std::complex<double>> exact, value;
  std::vector<double> deviation;  // of real and imaginary part each

  [[nodiscard]] frac::FrequencyResponseData data() const { return {omega, value}; }
};

/// A class of consistent responses: formula, its parameters at random, and the band.
struct ValidityModel {
  std::string name, formula;
  double lower, upper;                                     // Hz
  std::function<std::vector<double>(Random&)> parameters;  // in the order of the formula
};

inline const std::vector<ValidityModel>& impedance_models() {
  static const std::vector<ValidityModel> models{
      {"RC, RC", "R0 + R1/(1 + T1 s) + R2/(1 + T2 s)", 0.1, 1e5,
       [](Random& r) {
         return std::vector{r.log_uniform(1, 20), r.log_uniform(10, 100), r.log_uniform(1e-4, 1e-2),
                            r.log_uniform(10, 100), r.log_uniform(1e-2, 1)};
       }},
      {"arc", "R0 + R1/(1 + (T1 s)^a)", 0.1, 1e5,
       [](Random& r) {
         return std::vector{r.log_uniform(1, 20), 100., r.log_uniform(1e-4, 0.3), r.uniform(0.55, 0.95)};
       }},
      {"Havriliak-Negami", "R0 + R1/(1 + (T1 s)^a)^b", 0.01, 1e5,
       [](Random& r) {
         return std::vector{r.log_uniform(1, 20), 100., r.log_uniform(1e-4, 0.3), r.uniform(0.6, 0.95),
                            r.uniform(0.4, 0.9)};
       }},
      {"two arcs, inductance", "L s + R0 + R1/(1 + (T1 s)^a) + R2/(1 + (T2 s)^b)", 0.01, 1e5,
       [](Random& r) {
         return std::vector{r.log_uniform(1e-7, 1e-5), r.log_uniform(1, 20), r.log_uniform(10, 100),
                            r.log_uniform(1e-4, 1e-2), r.uniform(0.7, 0.98), r.log_uniform(10, 100),
                            r.log_uniform(3e-2, 3),    r.uniform(0.6, 0.9)};
       }},
      {"finite diffusion", "R0 + R1 tanh(sqrt(T1 s))/sqrt(T1 s) + R2/(1 + T2 s)", 0.01, 1e4,
       [](Random& r) {
         return std::vector{r.log_uniform(1, 20), r.log_uniform(10, 100), r.log_uniform(0.1, 10),
                            r.log_uniform(10, 100), r.log_uniform(1e-4, 1e-2)};
       }},
      {"blocking power", "R0 + 1/(Q s^n)", 0.1, 1e4,
       [](Random& r) {
         return std::vector{r.log_uniform(1, 30), r.log_uniform(1e-4, 1e-2), r.uniform(0.5, 0.95)};
       }},
      {"inductive loop", "R0 + R1/(1 + T1 s) - R2/(1 + T2 s)", 0.01, 1e4,
       [](Random& r) {
         return std::vector{r.log_uniform(5, 30), 100., r.log_uniform(1e-3, 1e-2), r.uniform(10, 40),
                            r.log_uniform(0.3, 3)};
       }},
      {"modulus (fractional Zener)", "G0 + G1 (T1 s)^a/(1 + (T1 s)^a)", 0.001, 1e2,
       [](Random& r) {
         return std::vector{r.log_uniform(1, 30), 100., r.log_uniform(0.01, 10), r.uniform(0.3, 0.9)};
       }},
  };
  return models;
}

inline const std::vector<ValidityModel>& resonant_models() {
  static const std::vector<ValidityModel> models{
      {"oscillator", "K/(s^2/W^2 + 2 d s/W + 1)", 0.1, 10,
       [](Random& r) {
         return std::vector{1., r.log_uniform(2, 20), r.log_uniform(0.03, 0.5)};
       }},
      {"fractional oscillator", "K/((s/W)^q + c (s/W)^p + 1)", 0.03, 10,
       [](Random& r) {
         return std::vector{1., r.log_uniform(2, 10), r.uniform(1.5, 1.95), r.uniform(0.05, 0.4), r.uniform(0.3, 0.9)};
       }},
      {"two modes", "A/(s^2 + 2 d W s + W^2) + B/(s^2 + 2 e V s + V^2)", 0.1, 10,
       [](Random& r) {
         return std::vector{1.,
                            r.log_uniform(0.03, 0.1),
                            r.uniform(2, 5),
                            r.uniform(0.5, 3),
                            r.log_uniform(0.03, 0.1),
                            r.uniform(12, 30)};
       }},
      {"lag with delay", "K exp(-L s)/(T s + 1)", 0.01, 2,
       [](Random& r) {
         return std::vector{2., r.uniform(0.1, 0.6), r.log_uniform(0.3, 3)};
       }},
  };
  return models;
}

/// Responses that no test of consistency was made from: they only tell how often it is wrong.
inline const std::vector<ValidityModel>& further_models() {
  static const std::vector<ValidityModel> models{
      {"Gerischer, arc", "R0 + R1/sqrt(1 + T1 s) + R2/(1 + (T2 s)^a)", 0.05, 5e4,
       [](Random& r) {
         return std::vector{r.log_uniform(1, 20),   r.log_uniform(10, 100),    r.log_uniform(0.01, 1),
                            r.log_uniform(10, 100), r.log_uniform(1e-4, 1e-2), r.uniform(0.7, 1)};
       }},
      {"porous electrode, inductance", "L s + R0 + R1/((T1 s)^a tanh((T1 s)^a))", 0.02, 2e4,
       [](Random& r) {
         return std::vector{r.log_uniform(1e-7, 1e-5), r.log_uniform(1, 20), r.log_uniform(5, 50),
                            r.log_uniform(0.01, 3), r.uniform(0.35, 0.5)};
       }},
      {"nested arcs", "R0 + 1/(Q1 s^a + 1/(R1 + 1/(Q2 s^b + 1/R2)))", 0.01, 1e5,
       [](Random& r) {
         return std::vector{r.log_uniform(1, 20),   r.log_uniform(1e-6, 1e-4), r.uniform(0.75, 1),
                            r.log_uniform(10, 100), r.log_uniform(1e-3, 1e-2), r.uniform(0.6, 0.95),
                            r.log_uniform(30, 300)};
       }},
      {"springpots in parallel", "K1 (T s)^a + K2 (T s)^b", 0.001, 100,
       [](Random& r) {
         return std::vector{1., r.log_uniform(0.1, 10), r.uniform(0.05, 0.3), r.log_uniform(0.1, 10),
                            r.uniform(0.5, 0.95)};
       }},
      {"strong and weak mode", "A/(s^2 + 2 d W s + W^2) + B/(s^2 + 2 e V s + V^2)", 0.1, 10,
       [](Random& r) {
         return std::vector{1.,
                            r.log_uniform(0.02, 0.1),
                            r.uniform(2, 5),
                            r.log_uniform(0.05, 0.3),
                            r.log_uniform(0.02, 0.1),
                            r.uniform(12, 40)};
       }},
      {"three modes", "A/(s^2 + 2 d W s + W^2) + B/(s^2 + 2 e V s + V^2) - C/(s^2 + 2 f U s + U^2)", 0.1, 10,
       [](Random& r) {
         return std::vector{1.,
                            r.log_uniform(0.03, 0.1),
                            r.uniform(2, 4),
                            r.uniform(0.3, 2),
                            r.log_uniform(0.03, 0.1),
                            r.uniform(8, 14),
                            r.uniform(1, 5),
                            r.log_uniform(0.03, 0.1),
                            r.uniform(25, 40)};
       }},
      {"two lags with delay", "K exp(-L s)/((T s + 1)(U s + 1))", 0.003, 1,
       [](Random& r) {
         return std::vector{2., r.uniform(0.2, 1), r.log_uniform(1, 10), r.log_uniform(0.1, 1)};
       }},
      {"fractional lag, dead time beyond the points", "K exp(-L s)/(1 + (T s)^a)", 0.02, 50,
       [](Random& r) {
         return std::vector{2., r.log_uniform(0.03, 0.2), r.log_uniform(0.3, 3), r.uniform(0.6, 1)};
       }},
      {"oscillator, dead time beyond the points", "K exp(-L s)/(s^2/W^2 + 2 d s/W + 1)", 0.02, 50,
       [](Random& r) {
         return std::vector{1.5, r.log_uniform(0.03, 0.2), r.log_uniform(1, 20), r.log_uniform(0.1, 0.7)};
       }},
      {"reflection with an echo", "(1 - T s)/(1 + T s) + B exp(-L s)", 0.75, 1.1,
       [](Random& r) {
         return std::vector{r.uniform(0.1, 0.5), r.log_uniform(0.01, 0.1), r.uniform(5, 30)};
       }},
  };
  return models;
}

enum class NoiseKind { relative, additive, mixed, towards_low };

/// @param per_decade  points
/// @param noise  relative to each value, or of additive noise to a tenth of the largest
inline Sweep sweep(const ValidityModel& model, int per_decade, NoiseKind kind, double noise, Random& random) {
  Sweep made;
  const double decades = std::log10(model.upper / model.lower);
  const int count = static_cast<int>(std::lround(decades * per_decade)) + 1;
  const frac::Structure structure(model.formula);
  const std::vector<double> parameters = model.parameters(random);
  double largest = 0;
  for (int i = 0; i < count; ++i) {
    made.omega.push_back(2 * 3.14159265358979 * model.lower * std::pow(10.0, static_cast<double>(i) / per_decade));
    made.exact.push_back(structure.response(parameters, made.omega.back()));
    largest = std::max(largest, std::abs(made.exact.back()));
  }
  for (int i = 0; i < count; ++i) {
    const double size = std::abs(made.exact[static_cast<std::size_t>(i)]), additive = 0.1 * largest;
    made.deviation.push_back(
        noise * (kind == NoiseKind::relative   ? size
                 : kind == NoiseKind::additive ? additive
                 : kind == NoiseKind::mixed
                     ? std::hypot(size, additive)
                     : size * std::pow(made.omega[static_cast<std::size_t>(i)] / made.omega.back(), -0.15)));
  }
  return made;
}

/// What is drawn for a measurement before its model.
struct Measurement {
  Random random;  // for what follows
  double noise;   // 0.1 to 2 %
  int per_decade;
};
inline Measurement seeded_measurement(int seed, NoiseKind kind) {
  Random random(static_cast<std::uint64_t>(seed) * 1000003 + static_cast<std::uint64_t>(kind));
  const double noise = random.log_uniform(0.001, 0.02);
  const int per_decade = 7 + static_cast<int>(random.below(9));
  return {random, noise, per_decade};
}

/// Puts the noise onto the exact values, which a violation may have changed before.
inline void add_noise(Sweep& sweep, Random& random) {
  sweep.value = sweep.exact;
  for (std::size_t i = 0; i < sweep.value.size(); ++i) {
    const double real = random.normal(), imaginary = random.normal();
    sweep.value[i] += sweep.deviation[i] * std::complex<double>(real, imaginary);
  }
}

/// The response grows by a share during the sweep, each point taking as long as the others or as many periods.
inline void drift(Sweep& sweep, double share, bool by_periods) {
  double all = 0, elapsed = 0;
  for (const double omega : sweep.omega) all += by_periods ? 1 / omega : 1;
  for (std::size_t i = sweep.omega.size(); i-- > 0;) {
    elapsed += by_periods ? 1 / sweep.omega[i] : 1;
    sweep.exact[i] *= 1 + share * elapsed / all;
  }
}

}  // namespace support
