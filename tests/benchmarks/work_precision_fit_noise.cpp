// SPDX-License-Identifier: BSD-3-Clause
// Noise trials: the spread of the estimates against the Cramer-Rao bound, the coverage of the 95 % intervals, and the
// same with gross outliers under a robust loss.  Prints case,method,setting,error,seconds: error is the rms error of a
// parameter divided by its bound, seconds the mean of a fit; the setting ends with the share of intervals that hold the
// truth.  Arguments: [trials] [case].
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "support/cramer_rao.hpp"
#include "support/noisy_response.hpp"

namespace {

struct Problem {
  const char* name;
  const char* formula;
  std::vector<double> parameters;
};

/// How the data of one series of trials arise and are weighted; Weight::given is the noise that was put in.
struct Setting {
  frac::Component component;
  frac::Weight weight;
  double noise;         // standard deviation of either part over |G|
  double outliers = 0;  // share of points with a gross error of 50 %
  int points = 200;
};

void run(const Problem& problem, const Setting& setting, int trials) {
  const std::size_t count = problem.parameters.size();
  const std::vector<double> omega = support::four_decades(setting.points);
  const Eigen::MatrixXd bound =
      support::cramer_rao(problem.formula, problem.parameters, setting.component, setting.noise, omega);
  const frac::Structure structure(problem.formula);
  std::vector<double> sigma;
  for (const double each : omega)
    sigma.push_back(setting.noise * std::abs(structure.response(problem.parameters, each)));
  std::vector<double> squares(count, 0);
  std::vector<int> covered(count, 0);
  double seconds = 0;
  std::mt19937_64 generator(2026);
  for (int trial = 0; trial < trials; ++trial) {
    const auto clean =
        support::noisy_response(problem.formula, problem.parameters, setting.noise, generator, setting.points);
    std::vector<std::complex<double>> value = clean.value();
    std::uniform_real_distribution<double> uniform(0, 1);
    for (std::complex<double>& each : value) {
      if (uniform(generator) < setting.outliers) {
        each *= 1.0 + 0.5 * std::polar(1.0, 6.283185307179586 * uniform(generator));
      }
    }
    frac::FitOptions options;
    options.component = setting.component;
    options.weight = setting.weight;
    if (setting.outliers > 0) options.loss = frac::Loss::cauchy;
    // From the truth: whether a search gets there is the subject of work_precision_fit_global.
    options.global_start = false;
    for (std::size_t i = 0; i < count; ++i) {
      options.constraints.push_back({structure.parameter_names()[i], {}, {}, {}, problem.parameters[i]});
    }
    const frac::FitResult result = frac::fit({omega, value, sigma}, structure, options);
    seconds += result.seconds;
    for (std::size_t i = 0; i < count; ++i) {
      const frac::ParameterEstimate& estimate = result.parameters[i];
      const double truth = problem.parameters[i];
      squares[i] += (estimate.value - truth) * (estimate.value - truth);
      covered[i] += estimate.ci95_lower <= truth && truth <= estimate.ci95_upper;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    std::printf("%s,%s%s,%s %s %g %% noise%s %d points coverage %.3f,%.3f,%.3e\n", problem.name,
                std::string(frac::to_string(setting.weight)).c_str(), setting.outliers > 0 ? " and cauchy loss" : "",
                structure.parameter_names()[i].c_str(), std::string(frac::to_string(setting.component)).c_str(),
                100 * setting.noise, setting.outliers > 0 ? " 5 % outliers" : "", setting.points,
                covered[i] / static_cast<double>(trials), std::sqrt(squares[i] / trials / bound(k, k)),
                seconds / trials);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int trials = argc > 1 ? std::atoi(argv[1]) : 2000;
  const std::vector<Problem> problems = {
      {"fractional-lag", "K/(T s^a + 1)", {0.8, 0.4, 0.7}},
      {"furnace-1", "1/(b2 s^a2 + b1 s^a1 + b0)", {0.8, 2.2, 0.5, 0.9, 1}},
      {"furnace-3", "1/(b2 s^a2 + b1 s^a1 + b0)", {0.7943, 2.5708, 5.2385, 0.8372, 1.5560}},
      {"havriliak-negami", "K/(1 + (T s)^a)^b", {3, 0.5, 0.8, 0.45}},
  };
  std::printf("# %s, GCC %s, %d trials\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE, __VERSION__, trials);
  for (const Problem& problem : problems) {
    if (argc > 2 && problem.name != std::string(argv[2])) continue;
    using enum frac::Component;
    using enum frac::Weight;
    for (const double noise : {0.01, 0.1}) {
      run(problem, {both, smoothed_relative, noise}, trials);
      run(problem, {imaginary, smoothed_relative, noise}, trials);
      run(problem, {both, log_complex, noise}, trials);
    }
    // The default weight: at 10 % noise |data| is a noisy divisor, which biases gains by twice the square of that.
    run(problem, {both, relative, 0.01}, trials);
    run(problem, {both, smoothed_relative, 0.01, 0.05}, trials);
  }
  // What weights have to do with it: the true ones against those told from the data, and five times the points, which
  // leave a fifth of what the curvature of the model adds to the bound.
  for (const Problem& problem : problems) {
    if (problem.name != std::string("havriliak-negami") || (argc > 2 && problem.name != std::string(argv[2]))) continue;
    using enum frac::Component;
    using enum frac::Weight;
    run(problem, {imaginary, given, 0.1}, trials);
    run(problem, {imaginary, given, 0.1, 0, 1000}, trials);
    run(problem, {imaginary, smoothed_relative, 0.1, 0, 1000}, trials);
  }
}
