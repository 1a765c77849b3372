// SPDX-License-Identifier: BSD-3-Clause
// How often fit() finds the global optimum without start values: each seed draws its own noise and its own starts, and
// the cost must come within 1.001 of the best known, the better of this fit and a local one from the true parameters.
// Prints case,method,setting,error,seconds; error is the share of seeds that missed, seconds the median of a fit.
// Arguments: [seeds] [case].
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"

namespace {

struct Problem {
  const char* name;
  const char* formula;
  std::vector<double> parameters;
  double from, to;  // rad/s
};

const std::vector<Problem>& problems() {
  static const std::vector<Problem> all = {
      {"furnace-1", "1/(b2 s^a2 + b1 s^a1 + b0)", {0.8, 2.2, 0.5, 0.9, 1}, 1e-2, 1e2},
      {"furnace-2", "1/(b2 s^a2 + b1 s^a1 + b0)", {14994, 1.31, 6009.5, 0.97, 1.69}, 1e-5, 1e-1},
      {"furnace-3", "1/(b2 s^a2 + b1 s^a1 + b0)", {0.7943, 2.5708, 5.2385, 0.8372, 1.5560}, 1e-2, 1e2},
      {"fractional-lag", "K/(T s^a + 1)", {0.8, 0.4, 0.7}, 1e-2, 1e3},
      {"havriliak-negami", "K/(1 + (T s)^a)^b", {3, 0.5, 0.8, 0.45}, 1e-2, 1e2},
      {"lag-delay", "K exp(-L s)/(T s^a + 1)", {2, 0.5, 3, 0.8}, 1e-2, 1e1},
      {"oscillator-delay", "K exp(-L s)/(b2 s^a2 + b1 s^a1 + 1)", {1, 0.3, 0.8, 2.2, 0.5, 0.9}, 1e-2, 1e1},
      {"two-zarc", "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)", {0.01, 0.02, 3, 0.8, 0.03, 900, 0.9}, 1e-3, 1e5},
      {"resonance", "K/(s^a2 + b1 s^a1 + 1)", {1, 2, 0.1, 1}, 1e-2, 1e2},
  };
  return all;
}

frac::FrequencyResponseData noisy(const Problem& problem, double noise, std::uint64_t seed) {
  constexpr int points = 100;
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0, noise);
  const frac::Structure structure(problem.formula);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (int i = 0; i < points; ++i) {
    omega.push_back(problem.from * std::pow(problem.to / problem.from, i / (points - 1.0)));
    const std::complex<double> exact = structure.response(problem.parameters, omega.back());
    const double real = normal(generator), imaginary = normal(generator);
    value.push_back(exact + std::abs(exact) * std::complex<double>(real, imaginary));
  }
  return {std::move(omega), std::move(value)};
}

/// No limits; started at the truth if wanted.
frac::FitOptions options_for(const Problem& problem, frac::Component component, bool from_truth) {
  frac::FitOptions options;
  options.component = component;
  options.weight = frac::Weight::relative;
  options.global_start = !from_truth;
  const frac::Structure structure(problem.formula);
  for (std::size_t i = 0; i < problem.parameters.size() && from_truth; ++i) {
    options.constraints.push_back({structure.parameter_names()[i], {}, {}, {}, problem.parameters[i]});
  }
  return options;
}

void run(const Problem& problem, frac::Component component, double noise, std::uint64_t seeds) {
  const frac::Structure structure(problem.formula);
  std::uint64_t missed = 0;
  std::vector<double> seconds;
  double starts = 0, confidence = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const frac::FrequencyResponseData data = noisy(problem, noise, seed);
    frac::FitOptions options = options_for(problem, component, false);
    options.seed = seed;
    const frac::FitResult found = frac::fit(data, structure, options);
    const double reference = frac::fit(data, structure, options_for(problem, component, true)).cost;
    // Without noise both costs are rounding.
    missed += found.cost > 1.001 * reference + 1e-20;
    confidence += found.confidence_of_optimum / static_cast<double>(seeds);
    seconds.push_back(found.seconds);
    starts += static_cast<double>(found.starts) / static_cast<double>(seeds);
  }
  const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  std::printf("%s,global start,%s %g %% noise %.0f starts confidence %.2f,%.4f,%.3e\n", problem.name,
              std::string(frac::to_string(component)).c_str(), 100 * noise, starts, confidence,
              static_cast<double>(missed) / static_cast<double>(seeds), *middle);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t seeds = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100;
  std::printf("# %s, GCC %s, %llu seeds\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE, __VERSION__,
              static_cast<unsigned long long>(seeds));
  for (const Problem& problem : problems()) {
    if (argc > 2 && problem.name != std::string(argv[2])) continue;
    for (const auto component : {frac::Component::both, frac::Component::imaginary}) {
      for (const double noise : {0.0, 0.01, 0.1}) run(problem, component, noise, seeds);
    }
  }
}
