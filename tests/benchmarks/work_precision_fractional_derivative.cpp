// SPDX-License-Identifier: BSD-3-Clause
// Gruenwald-Letnikov derivative of many samples: error against seconds for the sum of exponentials, FFT convolution,
// short memory and the direct sum.  Prints case,method,setting,error,seconds; error is the largest relative to the
// exact sum in extended precision at 200 samples spread in logarithm, NaN where only time is of interest; seconds are
// processor time for all samples, the median of 7 repeats; "in F" is the same in units F(n), one real FFT of length n:
// by Eigen's kissfft divided by 4, about what FFTW takes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <span>
#include <string>
#include <unsupported/Eigen/FFT>
#include <utility>
#include <vector>

#include "frac/fractional_derivative.hpp"
#include "frac/grunwald_letnikov.hpp"
#include "support/random.hpp"

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

template <typename Work>
double median_seconds(int repeats, const Work& work) {
  std::vector<double> seconds;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const double start = processor_seconds();
    work();
    seconds.push_back(processor_seconds() - start);
  }
  return median(std::move(seconds));
}

// Exact sums at some samples: order q - 1 of the first differences, which are exact here, 0 < q < 1.
struct Judge {
  std::vector<std::size_t> at;
  std::vector<long double> value;

  Judge(const std::vector<double>& samples, double order, double sample_time) {
    const std::vector<double> weights = frac::grunwald_letnikov_weights(order - 1, samples.size() - 1);
    const double ratio = std::log(static_cast<double>(samples.size() - 1)) / 199;
    for (int i = 0; i < 200; ++i) {
      const auto n = static_cast<std::size_t>(std::lround(std::exp(ratio * i)));
      long double sum = static_cast<long double>(weights[n]) * static_cast<long double>(samples[0]);
      for (std::size_t k = 0; k < n; ++k) {
        sum += static_cast<long double>(weights[k]) *
               (static_cast<long double>(samples[n - k]) - static_cast<long double>(samples[n - k - 1]));
      }
      at.push_back(n);
      value.push_back(sum * std::pow(static_cast<long double>(sample_time), -static_cast<long double>(order)));
    }
  }
  template <typename Real>
  [[nodiscard]] double error(const std::vector<Real>& output) const {
    long double worst = 0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      worst = std::max(worst, std::abs(static_cast<long double>(output[at[i]]) / value[i] - 1));
    }
    return static_cast<double>(worst);
  }
};

void print(const std::string& name, const std::string& method, const std::string& setting, double error,
           double seconds) {
  std::printf("%s,%s,%s,%.3e,%.3e\n", name.c_str(), method.c_str(), setting.c_str(), error, seconds);
  std::fflush(stdout);
}

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

template <typename Real>
std::vector<Real> monotone(std::size_t count) {
  std::vector<Real> samples(count);
  for (std::size_t n = 0; n < count; ++n) {
    const double t = static_cast<double>(n) / static_cast<double>(count);
    samples[n] = static_cast<Real>(1 + t * std::sqrt(t));
  }
  return samples;
}

template <typename Real>
void run(const std::string& name, std::size_t count, double order, double tolerance, double unit) {
  const double sample_time = 1 / static_cast<double>(count);
  const std::vector<Real> samples = monotone<Real>(count);
  const Judge judge({samples.begin(), samples.end()}, order, sample_time);
  const auto make = [&] {
    return frac::FractionalDerivative<Real>(order, sample_time, tolerance, static_cast<double>(count));
  };
  frac::FractionalDerivative<Real> derivative = make();
  const std::string setting =
      text("order %g", order) + text(" tolerance %.0e", tolerance) + " K " + std::to_string(derivative.exponentials());
  print(name, "set-up", setting, derivative.error_bound(), median_seconds(51, [&] { (void)make(); }));
  std::vector<Real> output(count);
  const double seconds = median_seconds(7, [&] {
    derivative.reset();
    derivative.run(samples, output);
  });
  print(name, "sum of exponentials", setting + text(" in F %.2f", seconds / unit), judge.error(output), seconds);
  const double single = median_seconds(3, [&] {
    derivative.reset();
    for (std::size_t n = 0; n < count; ++n) output[n] = derivative.step(samples[n]);
  });
  print(name, "one sample at a time", setting + text(" ns per sample %.1f", 1e9 * single / static_cast<double>(count)),
        judge.error(output), single);

  std::vector<Real> noise(count);
  support::Random random(1);
  for (Real& each : noise) each = static_cast<Real>(random.normal());
  std::vector<Real> pulse(count, 0);
  pulse[0] = 1;
  // In turn and from the same memory, so that what else the machine does falls on both alike.
  std::vector<Real> input(count);
  std::vector<double> noisy_seconds, silent_seconds;
  for (int repeat = 0; repeat < 11; ++repeat) {
    const auto timed = [&](const std::vector<Real>& samples_of) {
      input = samples_of;
      derivative.reset();
      const double start = processor_seconds();
      derivative.run(input, output);
      return processor_seconds() - start;
    };
    noisy_seconds.push_back(timed(noise));
    silent_seconds.push_back(timed(pulse));
  }
  const double noisy = median(noisy_seconds);
  const double silent = median(silent_seconds);
  print(name, "sum of exponentials: noise", setting, nothing, noisy);
  print(name, "sum of exponentials: pulse", setting + text(" over noise %.2f", silent / noisy), nothing, silent);
}

}  // namespace

int main(int argc, char** argv) {
  // --smoke leaves out the millions of samples.
  const bool quick = argc > 1 && std::string(argv[1]) == "--smoke";
  std::printf("# %s, GCC %s, median of 7 repeats\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE,
              __VERSION__);
  const std::size_t million = quick ? 10'000 : 1'000'000;
  const std::size_t length = quick ? std::size_t{1} << 14 : std::size_t{1} << 21;
  double unit = 0;
  {
    Eigen::FFT<double> fft;
    std::vector<double> time(length, 1.0);
    std::vector<std::complex<double>> spectrum;
    unit = median_seconds(7, [&] { fft.fwd(spectrum, time); }) / 4;
    print("fft", "F(" + std::to_string(length) + ")", "kissfft/4", nothing, unit);
  }
  const std::string name = std::to_string(million) + " samples";
  for (const double order : {0.1, 0.5, 0.9}) {
    for (const double tolerance : {1e-6, 1e-9, 1e-12}) run<double>(name, million, order, tolerance, unit);
  }
  run<float>(name + " in float", million, 0.5, 1e-6, unit);
  if (!quick) {
    run<double>("10^7 samples", 10'000'000, 0.5, 1e-12, 10 * unit);
  }
  {
    const std::vector<double> samples = monotone<double>(million);
    const double sample_time = 1 / static_cast<double>(million);
    const Judge judge(samples, 0.5, sample_time);
    std::vector<double> output;
    const double by_fft =
        median_seconds(3, [&] { output = frac::grunwald_letnikov_derivative_by_fft(samples, 0.5, sample_time); });
    print(name, "fft convolution", "order 0.5" + text(" in F %.2f", by_fft / unit), judge.error(output), by_fft);
    for (const std::size_t memory : {std::size_t{100}, std::size_t{1000}}) {
      const double seconds =
          median_seconds(1, [&] { output = frac::grunwald_letnikov_derivative(samples, 0.5, sample_time, memory); });
      print(name, "short memory", "order 0.5 memory " + std::to_string(memory), judge.error(output), seconds);
    }
  }
  const std::vector<double> fewer = monotone<double>(10'000);
  const Judge judge(fewer, 0.5, 1e-4);
  std::vector<double> output;
  const double direct = median_seconds(1, [&] { output = frac::grunwald_letnikov_derivative(fewer, 0.5, 1e-4); });
  print("10000 samples", "direct sum", "order 0.5", judge.error(output), direct);
}
