// SPDX-License-Identifier: BSD-3-Clause
// Cost of identification: one local solve, the same problem built with Ceres' automatic derivatives, and the global
// search.  Prints case,method,setting,error,seconds; error is the largest relative error of a parameter, which without
// noise is that of the solver alone.
#include <ceres/autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"

namespace {

struct Problem {
  const char* name;
  const char* formula;
  std::vector<double> parameters;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

frac::FrequencyResponseData sample(const Problem& problem, std::size_t points, double noise) {
  const frac::Structure structure(problem.formula);
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal(0, 1);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (std::size_t i = 0; i < points; ++i) {
    omega.push_back(1e-2 * std::pow(1e4, static_cast<double>(i) / static_cast<double>(points - 1)));
    const std::complex<double> exact = structure.response(problem.parameters, omega.back());
    const double real = normal(generator), imaginary = normal(generator);
    value.push_back(exact + std::abs(exact) * noise * std::complex<double>(real, imaginary));
  }
  return {std::move(omega), std::move(value)};
}

double largest_error(const std::vector<double>& found, const std::vector<double>& truth) {
  double error = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) error = std::max(error, std::abs(found[i] / truth[i] - 1));
  return error;
}

/// A warm start is 5 % off in each parameter, as after a small change of scene.
constexpr double off = 1.05;

double run(const Problem& problem, std::size_t points, double noise, frac::Component component, bool global) {
  const frac::Structure structure(problem.formula);
  const frac::FrequencyResponseData data = sample(problem, points, noise);
  frac::FitOptions options;
  options.component = component;
  options.weight = frac::Weight::relative;
  options.global_start = global;
  for (std::size_t i = 0; i < problem.parameters.size() && !global; ++i) {
    options.constraints.push_back({structure.parameter_names()[i], {}, {}, {}, problem.parameters[i] * off});
  }
  std::vector<double> seconds;
  double error = 0;
  const std::uint64_t repeats = global || points > 1000 ? 11 : 101;
  for (std::uint64_t seed = 1; seed <= repeats; ++seed) {
    options.seed = seed;
    const frac::FitResult result = frac::fit(data, structure, options);
    seconds.push_back(result.seconds);
    std::vector<double> found;
    for (const frac::ParameterEstimate& estimate : result.parameters) found.push_back(estimate.value);
    error = std::max(error, largest_error(found, problem.parameters));
  }
  std::printf("%s,%s,%zu points %s %g %% noise,%.2e,%.3e\n", problem.name, global ? "global start" : "warm start",
              points, std::string(frac::to_string(component)).c_str(), 100 * noise, error, median(seconds));
  return median(seconds);
}

/// (model - datum)/|datum| of 1/(b2 s^a2 + b1 s^a1 + b0) for Ceres' dual numbers.
struct FurnaceResidual {
  double omega;
  std::complex<double> datum;

  template <typename T>
  bool operator()(const T* p, T* residual) const {
    using std::cos, std::exp, std::sin;
    const double log_omega = std::log(omega);
    T real = p[4], imaginary = T(0);
    for (const int k : {0, 2}) {
      const T size = p[k] * exp(p[k + 1] * log_omega);
      const T angle = p[k + 1] * (std::numbers::pi / 2);
      real += size * cos(angle);
      imaginary += size * sin(angle);
    }
    const T square = real * real + imaginary * imaginary;
    residual[0] = (real / square - datum.real()) / std::abs(datum);
    residual[1] = (-imaginary / square - datum.imag()) / std::abs(datum);
    return true;
  }
};

double run_automatic(const Problem& furnace, std::size_t points, double noise) {
  const frac::FrequencyResponseData data = sample(furnace, points, noise);
  std::vector<double> seconds;
  double error = 0;
  for (int repeat = 0; repeat < (points > 1000 ? 11 : 101); ++repeat) {
    const auto begin = std::chrono::steady_clock::now();
    std::vector<double> found = furnace.parameters;
    for (double& each : found) each *= off;
    ceres::Problem problem;
    for (std::size_t i = 0; i < points; ++i) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<FurnaceResidual, 2, 5>(new FurnaceResidual{data.omega()[i], data.value()[i]}),
          nullptr, found.data());
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.function_tolerance = 1e-14;
    options.gradient_tolerance = 1e-300;
    options.parameter_tolerance = 1e-14;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    error = std::max(error, largest_error(found, furnace.parameters));
  }
  std::printf("%s,Ceres automatic derivatives,%zu points both %g %% noise,%.2e,%.3e\n", furnace.name, points,
              100 * noise, error, median(seconds));
  return median(seconds);
}

}  // namespace

int main() {
  const Problem furnace{"furnace", "1/(b2 s^a2 + b1 s^a1 + b0)", {0.8, 2.2, 0.5, 0.9, 1}};
  const std::vector<Problem> problems = {{"fractional-lag", "K/(T s^a + 1)", {0.8, 0.4, 0.7}},
                                         furnace,
                                         {"havriliak-negami", "K/(1 + (T s)^a)^b", {3, 0.5, 0.8, 0.45}}};
  std::printf("# %s, GCC %s, medians\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE, __VERSION__);
  for (const double noise : {0.0, 0.01}) {
    for (const std::size_t points : {std::size_t{200}, std::size_t{10000}}) {
      const double ours = run(furnace, points, noise, frac::Component::both, false);
      const double automatic = run_automatic(furnace, points, noise);
      std::printf("# automatic derivatives take %.1f times as long (fit() includes intervals and ranking figures)\n",
                  automatic / ours);
    }
  }
  for (const Problem& problem : problems) {
    for (const auto component : {frac::Component::both, frac::Component::imaginary}) {
      run(problem, 200, 0.01, component, false);
      run(problem, 200, 0.01, component, true);
    }
    run(problem, 10000, 0.01, frac::Component::both, false);
  }
}
