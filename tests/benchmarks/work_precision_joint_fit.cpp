// SPDX-License-Identifier: BSD-3-Clause
// Joint fits of many curves of 100 points with three shared and two own parameters.  Prints
// case,method,setting,error,seconds:
//   curves    error is the rms error of the shared parameters in units of their standard errors, seconds of the
//   processor
//   one own and the others  error is the share of 95 % intervals that miss the truth, over fits of five curves of 25
//   points whose noise differs by up to four, or of five temperatures; seconds the mean of a fit
// Arguments: [--smoke | trials].
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "frac/identification/joint_fit.hpp"
#include "support/noisy_response.hpp"

namespace {

using namespace frac;

constexpr const char* lag = "K/(1 + (T s)^a)";
constexpr const char* solid = "E0 + E1 (T s)^a/(1 + (T s)^a)";

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

bool misses(const ParameterEstimate& estimate, double truth) {
  return !(estimate.ci95_lower <= truth && truth <= estimate.ci95_upper);
}

void print(const char* name, const char* setting, double error, double seconds) {
  std::printf("%s,joint-fit,%s,%.4g,%.4g\n", name, setting, error, seconds);
}

void many_curves(int count, Weight weight) {
  const char* formula = "R0 + R1/(1 + (T s)^n) + 0.05/s^m";
  std::mt19937_64 generator(static_cast<unsigned>(count));
  std::vector<JointCurve> curves;
  for (int c = 0; c < count; ++c) {
    const std::vector<double> parameters{1 + 0.5 * std::sin(c), 3 + std::cos(2.0 * c), 2, 0.8, 0.5};
    curves.push_back({std::to_string(c), support::noisy_response(formula, parameters, 0.01, generator, 100)});
  }
  JointFitOptions options;
  options.fit.component = Component::both;
  options.fit.weight = weight;
  options.threads = 1;
  options.shared = {"T", "n", "m"};
  const double begin = processor_seconds();
  const JointFitResult result = joint_fit(curves, Structure(formula), options);
  const double seconds = processor_seconds() - begin, truth[] = {2, 0.8, 0.5};
  double square = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double error = (result.shared[k].value - truth[k]) / result.shared[k].standard_error;
    square += error * error / 3;
  }
  print("curves", (std::to_string(count) + " " + std::string(to_string(weight))).c_str(), std::sqrt(square), seconds);
}

/// Curves with the truth behind each of their parameters.
struct Scene {
  std::vector<JointCurve> curves;
  std::vector<std::vector<std::pair<std::string, double>>> truth;  // of each curve
};

double truth_of(const std::vector<std::pair<std::string, double>>& truth, const std::string& name) {
  for (const auto& [known, value] : truth)
    if (known == name) return value;
  return std::nan("");
}

/// Shares of intervals that miss: of shared parameters and those of laws, and of parameters of single curves by name.
template <class Make>
void coverage(const char* what, int trials, const char* formula, const JointFitOptions& options, const Make& make) {
  std::mt19937_64 generator(550123);
  std::map<std::string, std::pair<int, int>> missed;  // of how many
  int doubted = 0, judged = 0, failed = 0;
  const double begin = processor_seconds();
  for (int trial = 0; trial < trials; ++trial) {
    const Scene scene = make(generator);
    const JointFitResult result = joint_fit(scene.curves, Structure(formula), options);
    failed += result.usable() ? 0 : 1;
    const auto count = [&](const std::string& name, const ParameterEstimate& estimate, double truth) {
      if (estimate.fixed || std::isnan(truth)) return;
      auto& [misses_so_far, all] = missed[name];
      misses_so_far += misses(estimate, truth) ? 1 : 0;
      ++all;
    };
    for (const ParameterEstimate& each : result.shared)
      count("shared " + each.name, each, truth_of(scene.truth.front(), each.name));
    for (std::size_t c = 0; c < result.curves.size(); ++c) {
      for (const ParameterEstimate& each : result.curves[c].parameters) {
        const bool is_shared = std::any_of(result.shared.begin(), result.shared.end(),
                                           [&](const ParameterEstimate& other) { return other.name == each.name; });
        if (!is_shared) count("own " + each.name, each, truth_of(scene.truth[c], each.name));
      }
    }
    if (std::isnan(result.sharing_p_value)) continue;
    ++judged;
    doubted += result.sharing_p_value < 0.05 ? 1 : 0;
  }
  const double seconds = (processor_seconds() - begin) / trials;
  for (const auto& [name, counts] : missed)
    print(what, name.c_str(), static_cast<double>(counts.first) / counts.second, seconds);
  if (judged > 0) print(what, "sharing doubted at 5 %", static_cast<double>(doubted) / judged, seconds);
  if (failed > 0) print(what, "not converged", static_cast<double>(failed) / trials, seconds);
}

/// Lags with noise that differs by up to four from curve to curve.
/// @param parameters  of each curve: K, T, a
/// @param outliers    share of points that are off by thirty deviations
Scene lags(const std::vector<std::vector<double>>& parameters, std::mt19937_64& generator, double outliers = 0) {
  Scene scene;
  for (std::size_t c = 0; c < parameters.size(); ++c) {
    const double level = 0.01 * std::pow(2.0, static_cast<double>(c % 3));
    FrequencyResponseData data = support::noisy_response(lag, parameters[c], level, generator, 25);
    if (outliers > 0) {
      std::vector<std::complex<double>> value = data.value();
      std::uniform_real_distribution<double> chance(0, 1), angle(0, 6.2831853);
      for (auto& each : value)
        if (chance(generator) < outliers) each *= 1.0 + 30 * level * std::polar(1.0, angle(generator));
      data = {data.omega(), value};
    }
    scene.curves.push_back({std::to_string(c), std::move(data), {{"load", std::pow(2.0, static_cast<double>(c))}}});
    scene.truth.push_back({{"K", parameters[c][0]}, {"T", parameters[c][1]}, {"a", parameters[c][2]}});
  }
  return scene;
}

/// A modulus over two decades at five temperatures.
Scene temperatures(std::mt19937_64& generator) {
  Scene scene;
  std::normal_distribution<double> normal(0, 0.02);
  for (int c = 0; c < 5; ++c) {
    const double kelvin = 10.0 * (c - 2), along = std::exp(-8 * kelvin / (70 + kelvin));
    std::vector<double> omega;
    std::vector<std::complex<double>> value;
    for (int i = 0; i < 25; ++i) {
      omega.push_back(std::pow(100.0, i / 24.0));
      const double real = normal(generator), imaginary = normal(generator);
      value.push_back(Structure(solid).response(std::vector<double>{1, 99, 0.01, 0.6}, along * omega.back()) *
                      std::complex<double>(1 + real, imaginary));
    }
    scene.curves.push_back({std::to_string(c), FrequencyResponseData(omega, value), {{"kelvin", kelvin}}});
    scene.truth.push_back({{"E0", 1}, {"E1", 99}, {"T", 0.01}, {"a", 0.6}, {"aT", along}, {"C", 8}, {"D", 70}});
  }
  return scene;
}

void coverages(int trials) {
  JointFitOptions options;
  options.fit.component = Component::both;
  options.fit.weight = Weight::relative;
  options.threads = 1;
  std::vector<std::vector<double>> one_own, three_own;
  for (int c = 0; c < 5; ++c) {
    one_own.push_back({c + 1.0, 0.7, 0.8});
    three_own.push_back({c + 1.0, 0.5 + 0.2 * c, 0.8});
  }
  options.shared = {"T", "a"};
  coverage("one own", trials, lag, options, [&](auto& generator) { return lags(one_own, generator); });
  options.shared = {"a"};
  coverage("two own", trials, lag, options, [&](auto& generator) { return lags(three_own, generator); });

  options.laws = {"K = K0 load^p"};
  options.shared = {"a"};
  coverage("law and one own", trials, lag, options, [](auto& generator) {
    std::vector<std::vector<double>> parameters;
    for (int c = 0; c < 5; ++c) parameters.push_back({3 * std::pow(2.0, 0.4 * c), 0.5 + 0.2 * c, 0.8});
    Scene scene = lags(parameters, generator);
    scene.truth.front().insert(scene.truth.front().end(), {{"K0", 3}, {"p", 0.4}});
    return scene;
  });
  options.laws.clear();

  options.shared = {"T", "a"};
  for (const Loss loss : {Loss::huber, Loss::cauchy}) {
    options.fit.loss = loss;
    coverage((std::string(to_string(loss)) + ", 5 % outliers").c_str(), trials, lag, options,
             [&](auto& generator) { return lags(one_own, generator, 0.05); });
    coverage((std::string(to_string(loss)) + ", none").c_str(), trials, lag, options,
             [&](auto& generator) { return lags(one_own, generator); });
  }
  options.fit.loss = Loss::none;

  // Truths drawn from the priors, which are as sharp as what a curve tells.
  ParameterConstraint of_k{"K", {}, {}, {}, {}}, of_a{"a", {}, {}, {}, {}};
  of_k.prior = ParameterPrior{2, 0.01, true};
  of_a.prior = ParameterPrior{0.8, 0.005, false};
  options.fit.constraints = {of_k, of_a};
  coverage("priors", trials, lag, options, [](auto& generator) {
    std::normal_distribution<double> normal;
    const double a = 0.8 + 0.005 * normal(generator);
    std::vector<std::vector<double>> parameters;
    for (int c = 0; c < 5; ++c) parameters.push_back({2 * std::exp(0.01 * normal(generator)), 0.7, a});
    return lags(parameters, generator);
  });
  options.fit.constraints.clear();

  options.shared = {"E0", "E1", "T", "a"};
  options.shift = CurveShift{2, false};
  coverage("shift", trials, solid, options, temperatures);
  options.laws = {"aT = exp(-C kelvin/(D + kelvin))"};
  options.fit.constraints = {{"D", {}, 30, 500, 60}};
  coverage("shift by a law", trials, solid, options, temperatures);
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  std::printf("case,method,setting,error,seconds\n");
  for (const int count : smoke ? std::vector<int>{5} : std::vector<int>{50, 100, 200, 400})
    for (const Weight weight : {Weight::relative, Weight::smoothed_relative}) many_curves(count, weight);
  coverages(smoke ? 2 : argc > 1 ? std::atoi(argv[1]) : 1000);
  return 0;
}
