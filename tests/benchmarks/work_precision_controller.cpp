// Digital realisations of powers of s and the fractional PID: error and time.  Prints
// case,method,setting,error,seconds.
//  - power: largest relative error on the band, seconds for one design (median of 5)
//  - filter: largest difference from quadruple precision over 10^6 samples of noise relative to the largest output,
//    seconds per sample and section
//  - step: median and 99.9th percentile of single calls of FractionalPid::step over 10^6 calls; the error column is
//  empty
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "frac/digital_filter.hpp"
#include "frac/fractional_pid.hpp"
#include "support/filter_in_quadruple.hpp"
#include "support/random.hpp"

namespace {

using support::Quad;
using Clock = std::chrono::steady_clock;

// Of this program, so that what else the machine does weighs less.
double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

void powers() {
  const double sample_time = 1e-3;
  const double sampling = 2 * M_PI / sample_time;
  for (const double order : {0.5, -0.5, 0.9}) {
    for (const double share : {0.05, 0.1, 0.25}) {
      for (const auto method : frac::discretisations()) {
        const auto design = [&] {
          return frac::digital_power(order, {share * sampling * 1e-4, share * sampling}, frac::Tolerance{1e-3},
                                     sample_time, method);
        };
        std::vector<double> seconds;
        frac::DigitalPower power = design();
        for (int repeat = 0; repeat < 5; ++repeat) {
          const double start = processor_seconds();
          power = design();
          seconds.push_back(processor_seconds() - start);
        }
        const std::size_t size = power.taps.empty() ? power.parallel.rates.size() : power.taps.size();
        std::printf("s^%g to %g fs,%s,%zu %s,%.2e,%.2e\n", order, share, std::string(to_string(method)).c_str(), size,
                    power.taps.empty() ? "sections" : "taps", power.error.max_relative, median(seconds));
      }
    }
  }
}

void filters(std::size_t samples) {
  const double sample_time = 1e-3;
  support::Random random(1);
  std::vector<double> input;
  for (std::size_t n = 0; n < samples; ++n) input.push_back(random.normal());
  std::vector<double> output(samples);
  for (const double ratio : {1e4, 1e10}) {
    for (const int poles : {15, 30}) {
      const auto system = frac::approximate(0.5, {2 * M_PI / sample_time / ratio, 300}, frac::PoleCount{poles}).system;
      frac::DigitalFilterDesign design;
      design.sample_time = sample_time;
      design.sections = frac::discretise(system, sample_time).parallel;
      frac::DigitalFilter<double> filter(design);
      std::vector<double> seconds;
      for (int repeat = 0; repeat < 5; ++repeat) {
        filter.reset();
        const double start = processor_seconds();
        filter.run(input, output);
        seconds.push_back(processor_seconds() - start);
      }
      const std::vector<Quad> exact = support::filter_in_quadruple(system, sample_time, input);
      std::printf("s^0.5 fs/wb = %.0e,parallel sections,%d poles %zu samples,%.2e,%.2e\n", ratio, poles, samples,
                  support::worst_difference(exact, output), median(seconds) / static_cast<double>(samples) / poles);
      std::vector<double> signal = input;
      for (const auto& section : frac::discretise(system, sample_time).cascade.sections) {
        double v = 0;
        for (double& value : signal) {
          const double x = value;
          value = x + section.feed * v;
          v += x - section.rate * v;
        }
      }
      const double gain = frac::discretise(system, sample_time).cascade.gain;
      for (double& value : signal) value *= gain;
      std::printf("s^0.5 fs/wb = %.0e,cascade of delta sections,%d poles %zu samples,%.2e,\n", ratio, poles, samples,
                  support::worst_difference(exact, signal));
      std::fflush(stdout);
    }
  }
}

// Zeros after a pulse, where states die out, against noise.
void silence(std::size_t samples) {
  const auto design = filter_design(frac::digital_power(0.5, {30, 300}, frac::PoleCount{15}, 1e-3));
  support::Random random(2);
  std::vector<double> noise, zeros(samples, 0.0), output(samples);
  for (std::size_t n = 0; n < samples; ++n) noise.push_back(random.normal());
  zeros[0] = 1;
  const auto timed = [&](const std::vector<double>& input) {
    std::vector<double> seconds;
    for (int repeat = 0; repeat < 7; ++repeat) {
      frac::DigitalFilter<double> filter(design);
      const double start = processor_seconds();
      filter.run(input, output);
      seconds.push_back(processor_seconds() - start);
    }
    return median(seconds) / static_cast<double>(samples);
  };
  std::printf("s^0.5 parallel sections,noise,%zu sections,,%.2e\n", design.sections.rates.size(), timed(noise));
  std::printf("s^0.5 parallel sections,zeros after a pulse,%zu sections,,%.2e\n", design.sections.rates.size(),
              timed(zeros));
}

template <typename Real>
void steps(const char* name, int calls) {
  frac::FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0.05, .lambda = 0.8, .mu = 0.6};
  config.sample_time = 1e-3;
  config.band = {0.01, 300};
  config.goal = frac::PoleCount{15};
  config.discretisation = frac::Discretisation::tustin;  // 15 sections; `direct` adds some
  config.minimum = -5;
  config.maximum = 5;
  for (const bool is_direct : {false, true}) {
    if (is_direct) config.discretisation = frac::Discretisation::direct;
    const frac::FractionalPidDesign design(config);
    frac::FractionalPid<Real> pid(design);
    std::vector<double> single;
    Real y = 0;
    // What reading the clock twice costs, to be taken off.
    std::vector<double> nothing;
    for (int n = 0; n < 10'000; ++n) {
      const auto start = Clock::now();
      nothing.push_back(seconds_since(start));
    }
    const double clock = median(nothing);
    for (int n = 0; n < calls; ++n) {
      const Real setpoint = static_cast<Real>(n / 1000 % 2);
      const auto start = Clock::now();
      const Real u = pid.step(setpoint, y);
      single.push_back(seconds_since(start) - clock);
      y += static_cast<Real>(1e-3) * (u - y);
    }
    std::sort(single.begin(), single.end());
    const double start = processor_seconds();
    for (int n = 0; n < calls; ++n) y += static_cast<Real>(1e-3) * (pid.step(static_cast<Real>(n / 1000 % 2), y) - y);
    const double mean = (processor_seconds() - start) / calls;
    const auto at = [&](double share) { return single[static_cast<std::size_t>(share * (calls - 1))]; };
    const std::string setting =
        std::to_string(design.integral().sections) + " + " + std::to_string(design.derivative().sections) + " sections";
    std::printf("FractionalPid<%s>::step,mean in a loop,%s,,%.2e\n", name, setting.c_str(), mean);
    std::printf("FractionalPid<%s>::step,median,%s,,%.2e\n", name, setting.c_str(), at(0.5));
    std::printf("FractionalPid<%s>::step,99.9th percentile,%s,,%.2e\n", name, setting.c_str(), at(0.999));
    if (!(std::abs(y) < 2)) std::printf("# the loop did not hold its output: %g\n", static_cast<double>(y));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  std::printf("# %s, GCC %s, medians of repeats\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE, __VERSION__);
  if (!smoke) powers();
  filters(smoke ? 2000 : 1'000'000);
  silence(smoke ? 2000 : 1'000'000);
  steps<double>("double", smoke ? 2000 : 1'000'000);
  steps<float>("float", smoke ? 2000 : 1'000'000);
}
