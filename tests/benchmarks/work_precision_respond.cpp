// SPDX-License-Identifier: BSD-3-Clause
// Time responses: error against seconds for every method, with the reference itself as judge.  Prints
// case,method,setting,error,seconds; error is the largest over the largest value, at 300 samples spread in logarithm,
// seconds are of processor time, for the whole response (set-up apart), the median of 7 repeats.  The case "fft" is the
// unit F(2^20): one real FFT of that length by Eigen's kissfft, divided by 4, about what FFTW takes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <string>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "frac/time_response/reference_response.hpp"
#include "frac/time_response/respond.hpp"
#include "frac/time_response/response_methods.hpp"
#include "support/random.hpp"
#include "support/step_systems.hpp"

namespace {

using frac::FractionalTransferFunction;
constexpr double sample_time = 1e-4;

template <typename Work>
double median_seconds(int repeats, const Work& work) {
  std::vector<double> seconds;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const std::clock_t start = std::clock();
    work();
    seconds.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::nth_element(seconds.begin(), seconds.begin() + repeats / 2, seconds.end());
  return seconds[static_cast<std::size_t>(repeats / 2)];
}

double step_error(const FractionalTransferFunction& model, const std::vector<double>& output, double time_step) {
  const frac::ReferenceResponse reference(model);
  double error = 0;
  double largest = 0;
  const double ratio = std::log(static_cast<double>(output.size() - 1)) / 299;
  for (int i = 0; i < 300; ++i) {
    const auto n = static_cast<std::size_t>(std::lround(std::exp(ratio * i)));
    const double exact = reference(static_cast<double>(n) * time_step).value;
    error = std::max(error, std::abs(output[n] - exact));
    largest = std::max(largest, std::abs(exact));
  }
  return error / largest;
}

void print(const std::string& name, const char* method, const std::string& setting, double error, double seconds) {
  std::printf("%s,%s,%s,%.3e,%.3e\n", name.c_str(), method, setting.c_str(), error, seconds);
  std::fflush(stdout);
}

void run(const std::string& name, const FractionalTransferFunction& model, std::size_t count, double tolerance) {
  char setting[64];
  std::snprintf(setting, sizeof setting, "%zu samples tolerance %.0e", count, tolerance);
  const auto horizon = static_cast<double>(count);
  const auto make = [&] {
    return frac::ResponseFilter(model, sample_time, tolerance, frac::Hold::zero_order, horizon);
  };
  frac::ResponseFilter filter = make();
  const std::string with_states = setting + (" states " + std::to_string(filter.states()));
  print(name, "set-up", with_states, std::numeric_limits<double>::quiet_NaN(),
        median_seconds(7, [&] { (void)make(); }));
  std::vector<double> samples(count, 1.0);
  std::vector<double> output(count);
  const double seconds = median_seconds(7, [&] {
    filter.reset();
    filter.run(samples, output);
  });
  print(name, "exponential sum: step", with_states, step_error(model, output, sample_time), seconds);
  const auto timed = [&](const char* input) {
    print(name, input, with_states, std::numeric_limits<double>::quiet_NaN(), median_seconds(7, [&] {
            filter.reset();
            filter.run(samples, output);
          }));
  };
  support::Random random(1);
  for (double& sample : samples) sample = random.normal();
  timed("exponential sum: noise");
  for (std::size_t n = 0; n < count; ++n) {
    const double t = static_cast<double>(n) * sample_time;
    samples[n] = std::sin(t * t);
  }
  timed("exponential sum: sin t^2");
}

constexpr int unit_length = 1 << 20;

void print_unit() {
  Eigen::FFT<double> fft;
  std::vector<double> time(unit_length, 1.0);
  std::vector<std::complex<double>> spectrum;
  print("fft", "F(2^20)", "kissfft/4", std::numeric_limits<double>::quiet_NaN(),
        median_seconds(7, [&] { fft.fwd(spectrum, time); }) / 4);
}

}  // namespace

int main(int argc, char** argv) {
  // --smoke leaves out the million samples and the minutes of Gruenwald-Letnikov.
  const bool quick = argc > 1 && std::string(argv[1]) == "--smoke";
  std::printf("# %s, GCC %s, median of 7 repeats\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE,
              __VERSION__);
  print_unit();
  std::vector<std::pair<std::string, FractionalTransferFunction>> systems;
  for (const auto& [name, system] : support::step_systems()) systems.emplace_back(name, system.model);
  systems.emplace_back("furnace", FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)"));
  systems.emplace_back("pole near the cut", FractionalTransferFunction::parse("1/(s^0.99 + 1)"));
  for (const auto& [name, model] : systems) {
    for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) run(name, model, quick ? 10'000 : 1'000'000, tolerance);
  }
  const FractionalTransferFunction furnace = systems[systems.size() - 2].second;
  for (const std::size_t count :
       quick ? std::vector<std::size_t>{1000} : std::vector<std::size_t>{1000, 10'000, 100'000}) {
    const double time_step = 30 / static_cast<double>(count);
    const std::vector<double> samples(count + 1, 1.0);
    std::vector<double> output;
    const std::string setting = std::to_string(count) + " samples over 30 s";
    const double slow =
        median_seconds(1, [&] { output = frac::respond_grunwald_letnikov(furnace, samples, time_step); });
    print("furnace", "grunwald-letnikov", setting, step_error(furnace, output, time_step), slow);
    if (count <= 10'000) {
      const double second_order = median_seconds(1, [&] { output = frac::respond_bdf2(furnace, samples, time_step); });
      print("furnace", "bdf2", setting, step_error(furnace, output, time_step), second_order);
      for (const double tolerance : {1e-3, 1e-6}) {
        const double by_ladder =
            median_seconds(3, [&] { output = frac::respond_ladder(furnace, samples, time_step, tolerance); });
        print("furnace", "ladder", setting + (tolerance > 1e-4 ? " tolerance 1e-3" : " tolerance 1e-6"),
              step_error(furnace, output, time_step), by_ladder);
      }
    }
    const double fast = median_seconds(7, [&] { output = frac::respond(furnace, samples, time_step, 1e-12); });
    print("furnace", "exponential sum with set-up", setting + " tolerance 1e-12",
          step_error(furnace, output, time_step), fast);
  }
}
