// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "support/noisy_response.hpp"
#include "support/random.hpp"

namespace support {

struct CoverageModel {
  const char* name;
  const char* formula;
  std::vector<double> parameters;
};

inline std::vector<CoverageModel> coverage_models() {
  return {{"lag", "K/(T s^a + 1)", {2, 0.5, 0.6}},
          {"arc", "R0 + R1/(1 + R1 Q1 s^n1)", {1, 3, 0.2, 0.8}},
          {"power", "K s^a", {2, -0.4}},
          {"furnace", "1/(b2 s^a2 + b1 s^a1 + b0)", {0.8, 2.2, 0.5, 0.9, 1}},
          {"two-lag", "K/((T1 s + 1) (T2 s + 1))", {5, 3, 0.1}},
          {"three-arcs-end", "R0 + R1/(1 + (T1 s)^n1) + 1/(C s)", {1, 3, 0.6, 0.8, 20}}};
}

/// A smooth error of the whole response, as a factor 1 + deviation * (complex function of ln omega): a random process
/// with a Gaussian covariance of that length; a wave of random phase whose quarter is that length; a gain and a slope.
struct SmoothDeviation {
  enum class Kind { process, wave, slope } kind = Kind::process;
  double deviation = 0;  // root mean square of either part
  double length = 1;     // in ln omega
};

/// Noise of either part: standard deviation sqrt((relative |G|)^2 + additive^2), of first order along the points.
struct CoverageCase {
  CoverageModel model;
  int points = 60;
  double relative = 0.01;
  double additive = 0;
  double correlation = 0;
  frac::Component component = frac::Component::both;
  frac::Weight weight = frac::Weight::relative;
  SmoothDeviation smooth = {};
};

inline double largest_value(const CoverageModel& model) {
  double largest = 0;
  for (const double omega : four_decades(50)) {
    largest = std::max(largest, std::abs(frac::Structure(model.formula).response(model.parameters, omega)));
  }
  return largest;
}

/// Share of the trials in which the interval of each parameter holds the truth.
struct Coverage {
  std::vector<std::string> name;
  std::vector<double> share;
  std::vector<double> half_width;  // median, relative to the truth
  double seconds;                  // mean of a fit
};

/// One part of it at frequencies, of unit root mean square over many draws.
inline std::vector<double> drawn(const SmoothDeviation& of, const std::vector<double>& omega, Random& random) {
  std::vector<double> result(omega.size(), 0.0);
  const double middle = std::log(omega.front() * omega.back()) / 2, span = std::log(omega.back() / omega.front());
  const double first = random.normal(), second = random.normal();
  // A process of Gaussian covariance is a sum of many waves whose wave number is normal (Rahimi, Recht 2007).
  constexpr int waves = 200;
  const int count = of.kind == SmoothDeviation::Kind::process ? waves : 1;
  for (int k = 0; k < count; ++k) {
    const double number = count == 1 ? std::acos(-1.0) / (2 * of.length) : random.normal() / of.length;
    const double cosine = count == 1 ? first : random.normal(), sine = count == 1 ? second : random.normal();
    for (std::size_t i = 0; i < omega.size(); ++i) {
      const double x = std::log(omega[i]) - middle;
      result[i] += of.kind == SmoothDeviation::Kind::slope
                       ? std::sqrt(0.5) * (first + second * std::sqrt(12.0) * x / span)
                       : (cosine * std::cos(number * x) + sine * std::sin(number * x)) / std::sqrt(count);
    }
  }
  return result;
}

inline frac::FrequencyResponseData covered_data(const CoverageCase& scene, Random& random) {
  const frac::Structure structure(scene.model.formula);
  const std::vector<double> omega = four_decades(scene.points);
  const double r = scene.correlation, fresh = std::sqrt(1 - r * r);
  double real = random.normal(), imaginary = random.normal();
  std::vector<double> smooth_real(omega.size(), 0.0), smooth_imaginary = smooth_real;
  if (scene.smooth.deviation > 0) {
    smooth_real = drawn(scene.smooth, omega, random);
    smooth_imaginary = drawn(scene.smooth, omega, random);
  }
  std::vector<std::complex<double>> value;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const std::complex<double> exact = structure.response(scene.model.parameters, omega[i]);
    value.push_back(exact * (1.0 + scene.smooth.deviation * std::complex<double>(smooth_real[i], smooth_imaginary[i])) +
                    std::hypot(scene.relative * std::abs(exact), scene.additive) *
                        std::complex<double>(real, imaginary));
    real = r * real + fresh * random.normal();
    imaginary = r * imaginary + fresh * random.normal();
  }
  return {omega, value};
}

inline Coverage measure_coverage(const CoverageCase& scene, int trials, std::uint64_t seed) {
  const frac::Structure structure(scene.model.formula);
  const std::size_t count = scene.model.parameters.size();
  Coverage coverage{structure.parameter_names(), std::vector<double>(count, 0), std::vector<double>(count, 0), 0};
  std::vector<std::vector<double>> width(count);
  Random random(seed);
  for (int trial = 0; trial < trials; ++trial) {
    frac::FitOptions options;
    options.component = scene.component;
    options.weight = scene.weight;
    // From the truth: whether a search gets there is another question.
    options.global_start = false;
    for (std::size_t i = 0; i < count; ++i) {
      options.constraints.push_back({structure.parameter_names()[i], {}, {}, {}, scene.model.parameters[i]});
    }
    const frac::FitResult result = frac::fit(covered_data(scene, random), structure, options);
    coverage.seconds += result.seconds / trials;
    for (std::size_t i = 0; i < count; ++i) {
      const frac::ParameterEstimate& estimate = result.parameters[i];
      const double truth = scene.model.parameters[i];
      coverage.share[i] += estimate.ci95_lower <= truth && truth <= estimate.ci95_upper;
      width[i].push_back((estimate.ci95_upper - estimate.ci95_lower) / 2 / std::abs(truth));
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    coverage.share[i] /= trials;
    std::sort(width[i].begin(), width[i].end());
    coverage.half_width[i] = width[i][width[i].size() / 2];
  }
  return coverage;
}

}  // namespace support
