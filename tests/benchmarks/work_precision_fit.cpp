// Cost of identification: one local solve, the global search, and the measured cell if its file is given as argument.
// Prints case,method,setting,error,seconds; error is the largest relative error of a parameter (exact data).
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>
#include <vector>

#include "frac/identification/fit.hpp"

namespace {

struct Problem {
  const char* name;
  const char* formula;
  std::vector<double> parameters;
  std::vector<frac::ParameterConstraint> constraints;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

void run(const Problem& problem, std::size_t points, frac::Component component, bool global) {
  const frac::Structure structure(problem.formula);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (std::size_t i = 0; i < points; ++i) {
    omega.push_back(1e-2 * std::pow(1e4, static_cast<double>(i) / static_cast<double>(points - 1)));
    value.push_back(structure.response(problem.parameters, omega.back()));
  }
  const frac::FrequencyResponseData data(omega, value);
  frac::FitOptions options;
  options.component = component;
  options.constraints = problem.constraints;
  options.global_start = global;
  if (!global) {
    // Warm start: each parameter 5 % off, as after a small change of scene.
    for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
      const std::string& name = structure.parameter_names()[i];
      const auto known = std::find_if(options.constraints.begin(), options.constraints.end(),
                                      [&](const auto& constraint) { return constraint.name == name; });
      if (known != options.constraints.end()) {
        known->start = problem.parameters[i] * 1.05;
      } else {
        options.constraints.push_back({name, {}, {}, {}, problem.parameters[i] * 1.05});
      }
    }
  }
  std::vector<double> seconds;
  double error = 0;
  for (std::uint64_t seed = 1; seed <= 11; ++seed) {
    options.seed = seed;
    const frac::FitResult result = frac::fit(data, structure, options);
    seconds.push_back(result.seconds);
    for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
      error = std::max(error, std::abs(result.parameters[i].value / problem.parameters[i] - 1));
    }
  }
  std::printf("%s,%s,%zu points %s,%.2e,%.3e\n", problem.name, global ? "global start" : "warm start", points,
              std::string(frac::to_string(component)).c_str(), error, median(seconds));
}

}  // namespace

int main() {
  const std::vector<Problem> problems = {
      {"fractional-lag", "K/(T s^a + 1)", {0.8, 0.4, 0.7}, {}},
      {"furnace",
       "1/(b2 s^a2 + b1 s^a1 + b0)",
       {0.8, 2.2, 0.5, 0.9, 1},
       {{"a1", {}, 0, 1.5, {}}, {"a2", {}, 1.5, 4, {}}}},
      {"havriliak-negami", "K/(1 + (T s)^a)^b", {3, 0.5, 0.8, 0.45}, {{"a", {}, 0, 1, {}}, {"b", {}, 0, 1, {}}}},
  };
  std::printf("# %s, GCC %s, median of 11 seeds\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE, __VERSION__);
  for (const Problem& problem : problems) {
    for (const auto component : {frac::Component::both, frac::Component::imaginary}) {
      run(problem, 200, component, false);
      run(problem, 200, component, true);
    }
    run(problem, 10000, frac::Component::both, false);
  }
}
