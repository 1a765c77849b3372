// SPDX-License-Identifier: BSD-3-Clause
// Joint fits of many curves of 100 points with three shared and two own parameters.  Prints
// case,method,setting,error,seconds:
//   curves    error is the rms error of the shared parameters in units of their standard errors, seconds of the
//   processor coverage  error is the share of 95 % intervals that miss the truth, over fits of five curves of 25 points
//   whose noise
//             differs by up to four; seconds the mean of a fit
// Arguments: [--smoke | trials].
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <random>
#include <string>
#include <vector>

#include "frac/identification/joint_fit.hpp"
#include "support/noisy_response.hpp"

namespace {

using namespace frac;

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

void coverage(int trials) {
  const char* formula = "K/(1 + (T s)^a)";
  std::mt19937_64 generator(550123);
  JointFitOptions options;
  options.fit.component = Component::both;
  options.threads = 1;
  options.shared = {"T", "a"};
  double missed[3] = {0, 0, 0}, doubted = 0;
  const double begin = processor_seconds();
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<JointCurve> curves;
    for (int c = 0; c < 5; ++c)
      curves.push_back({std::to_string(c), support::noisy_response(formula, {c + 1.0, 0.7, 0.8},
                                                                   0.01 * std::pow(2.0, c % 3), generator, 25)});
    const JointFitResult result = joint_fit(curves, Structure(formula), options);
    missed[0] += misses(result.shared[0], 0.7);
    missed[1] += misses(result.shared[1], 0.8);
    for (std::size_t c = 0; c < 5; ++c)
      missed[2] += misses(result.curves[c].parameters[0], static_cast<double>(c) + 1) / 5.0;
    doubted += result.sharing_p_value < 0.05;
  }
  const double seconds = (processor_seconds() - begin) / trials;
  print("coverage", "shared T", missed[0] / trials, seconds);
  print("coverage", "shared a", missed[1] / trials, seconds);
  print("coverage", "own K", missed[2] / trials, seconds);
  print("coverage", "sharing doubted at 5 %", doubted / trials, seconds);
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  std::printf("case,method,setting,error,seconds\n");
  for (const int count : smoke ? std::vector<int>{5} : std::vector<int>{50, 100, 200, 400})
    for (const Weight weight : {Weight::relative, Weight::smoothed_relative}) many_curves(count, weight);
  coverage(smoke ? 2 : argc > 1 ? std::atoi(argv[1]) : 1000);
  return 0;
}
