// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include "frac/model/algebra.hpp"
#include "frac/model/time_response_data.hpp"
#include "frac/structure.hpp"
#include "frac/time_response/response_methods.hpp"
#include "support/random.hpp"

// Records of a system driven by lines of one period, with the exact output.

namespace support {

struct PeriodicExperiment {
  const char* formula = "K/(T s^a + 1)";
  std::vector<double> parameters{2, 1.5, 0.7};
  std::size_t lines = 20;         // 1 .. lines of the period
  double samples_per_period = 5;  // of the highest line
  double periods = 2;             // of the record; not necessarily whole
  double highest_omega = 20;      // rad/s, of the highest line
  double noise = 0.01;            // over the standard deviation of the output
  double correlation = 0;         // of neighbouring values of the noise
  bool from_rest = false;         // the input begins at the first sample; else it has run for ever
  double offset = 0.3;            // of the output
};

/// Noise of unit variance whose neighbours have this correlation.
inline std::vector<double> first_order_noise(std::size_t count, double correlation, Random& random) {
  std::vector<double> noise(count);
  double value = random.normal();
  for (double& each : noise) {
    each = value;
    value = correlation * value + std::sqrt(1 - correlation * correlation) * random.normal();
  }
  return noise;
}

/// Lines of equal amplitude and random phases; the output is a sum over them, of the response of the structure or, from
/// rest, of the reference for a sine and its derivative.
inline frac::TimeResponseData periodic_record(const PeriodicExperiment& wanted, frac::Hold hold, Random& random) {
  const auto period =
      static_cast<std::size_t>(std::lround(wanted.samples_per_period * static_cast<double>(wanted.lines)));
  const auto count = static_cast<std::size_t>(std::lround(wanted.periods * static_cast<double>(period)));
  const double spacing = wanted.highest_omega / static_cast<double>(wanted.lines);
  const double step = 2 * std::numbers::pi / (spacing * static_cast<double>(period));
  std::vector<double> time(count), input(count, 0.0), output(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) time[i] = step * static_cast<double>(i);
  const frac::Structure structure(wanted.formula);
  for (std::size_t k = 1; k <= wanted.lines; ++k) {
    const double omega = spacing * static_cast<double>(k), phase = random.uniform(0, 2 * std::numbers::pi);
    const std::complex<double> line = std::polar(1.0, phase);
    for (std::size_t i = 0; i < count; ++i) input[i] += (line * std::polar(1.0, omega * time[i])).real();
    if (!wanted.from_rest) {
      const std::complex<double> answer = line * structure.response(wanted.parameters, omega);
      for (std::size_t i = 0; i < count; ++i) output[i] += (answer * std::polar(1.0, omega * time[i])).real();
      continue;
    }
    // cos(omega t + phase) = cos(phase) d/dt sin(omega t)/omega - sin(phase) sin(omega t), all 0 before t = 0.
    using Kind = frac::ResponseInput::Kind;
    const frac::FractionalTransferFunction model = frac::to_transfer_function(structure, wanted.parameters);
    const frac::FractionalTransferFunction cosine =
        model * frac::FractionalTransferFunction({{1 / omega, 1}}, {{1, 0}});
    const auto of_sine = frac::respond(model, frac::ResponseInput{Kind::sine, omega}, time, 1e-10);
    const auto of_cosine = frac::respond(cosine, frac::ResponseInput{Kind::sine, omega}, time, 1e-10);
    for (std::size_t i = 0; i < count; ++i)
      output[i] += std::cos(phase) * of_cosine.output[i] - std::sin(phase) * of_sine.output[i];
  }
  double square = 0;
  for (const double each : output) square += each * each;
  const double deviation = wanted.noise * std::sqrt(square / static_cast<double>(count));
  const std::vector<double> noise = first_order_noise(count, wanted.correlation, random);
  for (std::size_t i = 0; i < count; ++i) output[i] += wanted.offset + deviation * noise[i];
  return {time, input, output, {}, hold};
}

/// The same record with the input running otherwise between its samples.
inline frac::TimeResponseData with_hold(const frac::TimeResponseData& data, frac::Hold hold) {
  return frac::TimeResponseData(data.time(), data.input(), data.output(), data.sigma(), hold, data.input_at_rest())
      .observed_at(data.observed());
}

}  // namespace support
