// SPDX-License-Identifier: BSD-3-Clause
// Fits over time.  Prints case,method,setting,error,seconds:
//   exact    error is the largest of the parameters of exact samples, seconds the fit, from an integer-order start
//   noise    rms error of a parameter in units of its Cramer-Rao bound, with the share of 95 % intervals that hold the
//            truth in the setting; seconds the mean of a fit
//   search   share of noisy records whose best cost exceeds that from the truth by more than a thousandth
//   samples  error as for exact, over records of many samples
// Arguments: [--smoke | noise trials] [kind].
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "frac/identification/time_fit.hpp"
#include "support/random.hpp"
#include "support/time_cramer_rao.hpp"

namespace {

struct Problem {
  const char* name;
  const char* formula;
  std::vector<double> parameters;
  double end;
};

const std::vector<Problem>& problems() {
  static const std::vector<Problem> all{
      {"furnace", "1/(a2 s^q2 + a1 s^q1 + 1)", {0.8, 2.2, 0.5, 0.9}, 15},
      {"lag-delay", "K exp(-L s)/(T s^a + 1)", {2, 0.73, 1.5, 0.6}, 20},
      {"oscillator", "K/(b2 s^2 + b1 s + 1)", {3, 0.6, 0.3}, 15},
      {"two-lags", "K/((T1 s^a + 1) (T2 s + 1))", {1.5, 2, 0.8, 0.2}, 20},
      {"zarc", "R0 + R1/(1 + R1 Q1 s^n1)", {0.4, 2, 0.5, 0.7}, 20},
      {"integrator", "K/(s (T s^a + 1))", {0.7, 1.2, 0.8}, 10},
      {"zero", "K (b s^q + 1)/(s^a + c)", {1, 0.5, 0.4, 1.3, 0.8}, 15},
  };
  return all;
}

enum class Input { step, switched, irregular };

struct Record {
  std::vector<double> time, input, output;
};

Record exact_record(const Problem& problem, Input kind, std::size_t count) {
  support::Random random(77);
  Record record;
  double level = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double even = problem.end * static_cast<double>(i) / static_cast<double>(count - 1);
    if (i > 0 && kind == Input::switched && random.unit() < 0.05) level = -level;
    record.time.push_back(kind == Input::irregular && i > 0
                              ? record.time.back() + 2 * random.unit() * problem.end / static_cast<double>(count - 1) +
                                    1e-4
                              : even);
    record.input.push_back(level);
  }
  const frac::Structure structure(problem.formula);
  record.output = support::exact_output(support::model_of(structure, problem.parameters), record.time, record.input,
                                        frac::Hold::zero_order);
  return record;
}

std::vector<frac::ParameterConstraint> started(const frac::Structure& structure, const std::vector<double>& values) {
  std::vector<frac::ParameterConstraint> constraints;
  for (std::size_t i = 0; i < values.size(); ++i) {
    constraints.push_back({structure.parameter_names()[i], {}, {}, {}, values[i]});
  }
  return constraints;
}

double largest_error(const frac::FitResult& result, const std::vector<double>& truth) {
  double error = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    error = std::max(error, std::abs(result.parameters[i].value - truth[i]));
  }
  return error;
}

double spread(const std::vector<double>& values) {
  double mean = 0, square = 0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) square += (value - mean) * (value - mean);
  return std::sqrt(square / static_cast<double>(values.size()));
}

void exact() {
  const Problem& furnace = problems().front();
  const Record record = exact_record(furnace, Input::step, 301);
  const frac::Structure structure(furnace.formula);
  for (const bool search : {false, true}) {
    frac::TimeFitOptions options;
    options.global_start = search;
    options.constraints = started(structure, {1, 2, 1, 1});
    std::vector<double> seconds;
    double error = 0;
    for (int repeat = 0; repeat < 5; ++repeat) {
      const auto result = frac::fit({record.time, record.input, record.output}, structure, options);
      seconds.push_back(result.seconds);
      error = largest_error(result, furnace.parameters);
    }
    std::sort(seconds.begin(), seconds.end());
    std::printf("furnace,exact,301 samples from s^2 + s + 1%s,%.3e,%.3e\n", search ? " with search" : "", error,
                seconds[2]);
  }
}

/// Diffusion through a layer, of which the step response is a known series, without start values.
void layer() {
  const std::vector<double> truth{0.3, 2, 4};
  Record record;
  for (int i = 0; i <= 300; ++i) {
    const double t = 15.0 * i / 300;
    double output = i == 0 ? truth[0] : truth[0] + truth[1];
    for (int k = 0; k < 400 && i > 0; ++k) {
      const double root = (k + 0.5) * std::numbers::pi;
      output -= truth[1] * 2 / (root * root) * std::exp(-root * root * t / truth[2]);
    }
    record.time.push_back(t);
    record.input.push_back(1);
    record.output.push_back(output);
  }
  const frac::Structure structure("R0 + R1 tanh(sqrt(T s))/sqrt(T s)");
  frac::TimeFitOptions options;
  options.offset = 0;
  std::vector<double> seconds;
  double error = 0;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const auto result = frac::fit({record.time, record.input, record.output}, structure, options);
    seconds.push_back(result.seconds);
    error = largest_error(result, truth);
  }
  std::sort(seconds.begin(), seconds.end());
  std::printf("layer,exact,301 samples without start values,%.3e,%.3e\n", error, seconds[2]);
}

void noise(int trials) {
  for (const std::size_t index : {0u, 1u}) {
    const Problem& problem = problems()[index];
    const frac::Structure structure(problem.formula);
    const Record record = exact_record(problem, index == 0 ? Input::step : Input::switched, 301);
    for (const double share : {0.01, 0.1}) {
      const double sigma = share;
      const Eigen::MatrixXd bound = support::time_cramer_rao(structure, problem.parameters, sigma, record.time,
                                                             record.input, frac::Hold::zero_order);
      const std::size_t count = problem.parameters.size() + 1;
      std::vector<double> squares(count, 0);
      std::vector<int> covered(count, 0);
      double seconds = 0;
      support::Random random(2026);
      for (int trial = 0; trial < trials; ++trial) {
        std::vector<double> output = record.output;
        for (double& value : output) value += sigma * random.normal();
        frac::TimeFitOptions options;
        // From the truth: whether a search gets there is the subject of `search`.
        options.global_start = false;
        options.constraints = started(structure, problem.parameters);
        const auto result = frac::fit({record.time, record.input, output}, structure, options);
        seconds += result.seconds;
        for (std::size_t i = 0; i < count; ++i) {
          const auto& found = result.parameters[i];
          const double error = found.value - (i + 1 < count ? problem.parameters[i] : 0);
          squares[i] += error * error;
          covered[i] += std::abs(error) <= found.ci95_upper - found.value ? 1 : 0;
        }
      }
      for (std::size_t i = 0; i < count; ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        std::printf("%s,noise,%s %g %% noise coverage %.3f,%.3f,%.3e\n", problem.name,
                    i + 1 < count ? structure.parameter_names()[i].c_str() : "offset", 100 * share,
                    covered[i] / static_cast<double>(trials), std::sqrt(squares[i] / trials / bound(k, k)),
                    seconds / trials);
      }
      std::fflush(stdout);
    }
  }
}

void search(int seeds) {
  for (const Problem& problem : problems()) {
    const frac::Structure structure(problem.formula);
    for (const Input kind : {Input::step, Input::switched, Input::irregular}) {
      const Record record = exact_record(problem, kind, 301);
      const double size = spread(record.output);
      for (const double share : {0.01, 0.1}) {
        int missed = 0;
        double seconds = 0, slowest = 0;
        std::size_t solves = 0;
        for (int seed = 1; seed <= seeds; ++seed) {
          support::Random random(static_cast<std::uint64_t>(seed));
          std::vector<double> output = record.output;
          for (double& value : output) value += share * size * random.normal();
          const frac::TimeResponseData data(record.time, record.input, output);
          frac::TimeFitOptions options;
          options.seed = static_cast<std::uint64_t>(seed);
          const auto found = frac::fit(data, structure, options);
          options.global_start = false;
          options.constraints = started(structure, problem.parameters);
          const auto from_truth = frac::fit(data, structure, options);
          missed += found.cost <= from_truth.cost * 1.001 ? 0 : 1;
          seconds += found.seconds;
          slowest = std::max(slowest, found.seconds);
          solves += found.starts;
        }
        const char* names[] = {"step", "switched input", "irregular times"};
        std::printf("%s,search,%s %g %% noise %zu solves slowest %.2f s,%.3f,%.3e\n", problem.name,
                    names[static_cast<int>(kind)], 100 * share, solves / static_cast<std::size_t>(seeds), slowest,
                    missed / static_cast<double>(seeds), seconds / seeds);
        std::fflush(stdout);
      }
    }
  }
}

// The exact output of so many samples comes from the filter bank of respond(), at 1e-13.
void samples(std::size_t most) {
  for (const std::size_t index : {0u, 1u}) {
    const Problem& problem = problems()[index];
    const frac::Structure structure(problem.formula);
    const auto model = support::model_of(structure, problem.parameters);
    for (std::size_t count = 1000; count <= most; count *= 10) {
      for (const bool switched : {false, true}) {
        const double step = problem.end / static_cast<double>(count);
        std::vector<double> time, input;
        for (std::size_t i = 0; i < count; ++i) {
          time.push_back(step * static_cast<double>(i));
          input.push_back(switched && std::fmod(time.back(), problem.end / 4) > problem.end / 8 ? -1 : 1);
        }
        const std::vector<double> output = frac::respond(model, input, step, 1e-13);
        const auto result = frac::fit({time, input, output}, structure, {});
        std::printf("%s,samples,%zu samples of a %s,%.3e,%.3e\n", problem.name, count,
                    switched ? "square wave" : "step", largest_error(result, problem.parameters), result.seconds);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  const int trials = smoke ? 3 : argc > 1 ? std::atoi(argv[1]) : 1000;
  const std::string kind = argc > 2 ? argv[2] : "";
  std::printf("# %s, GCC %s, %d trials\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE, __VERSION__, trials);
  if (kind.empty() || kind == "exact") {
    exact();
    layer();
  }
  if (kind.empty() || kind == "noise") noise(trials);
  if (!smoke && (kind.empty() || kind == "search")) search(std::min(trials, 20));
  if (kind.empty() || kind == "samples") samples(smoke ? 1000 : 100'000);
}
