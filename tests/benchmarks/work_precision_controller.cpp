// SPDX-License-Identifier: BSD-3-Clause
// Digital realisations of powers of s and the fractional PID: error and time.  Prints
// case,method,setting,error,seconds.
//  - power: largest relative error on the band, seconds for one design (median of 5)
//  - filter: largest difference from quadruple precision over 10^6 samples of noise relative to the largest output,
//    seconds per sample and section; the last of 10^8 samples of a constant through an integral against the closed form
//  - kernel: seconds per sample and section of each instruction set this processor has
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

#include "base/instruction_set.hpp"
#include "digital/section_kernel_loops.hpp"
#include "frac/digital/digital_filter.hpp"
#include "frac/digital/fractional_pid.hpp"
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
        std::printf("s^%g to %g fs,%s,%zu sections %zu taps gain beyond %.2g,%.2e,%.2e\n", order, share,
                    std::string(to_string(method)).c_str(), power.parallel.rates.size(), power.taps.size(),
                    power.most_amplification, power.error.max_relative, median(seconds));
      }
    }
  }
}

std::vector<double> noise(std::size_t samples) {
  support::Random random(1);
  std::vector<double> values;
  for (std::size_t n = 0; n < samples; ++n) values.push_back(random.normal());
  return values;
}

// Median of five runs from rest.
double seconds_of(frac::DigitalFilter<double>& filter, const std::vector<double>& input, std::vector<double>& output) {
  std::vector<double> seconds;
  for (int repeat = 0; repeat < 5; ++repeat) {
    filter.reset();
    const double start = processor_seconds();
    filter.run(input, output);
    seconds.push_back(processor_seconds() - start);
  }
  return median(seconds);
}

void filters(std::size_t samples) {
  const double sample_time = 1e-3;
  const std::vector<double> input = noise(samples);
  std::vector<double> output(samples);
  for (const double ratio : {1e4, 1e10}) {
    for (const int poles : {15, 30}) {
      const auto system = frac::approximate(0.5, {2 * M_PI / sample_time / ratio, 300}, frac::PoleCount{poles}).system;
      frac::DigitalFilterDesign design;
      design.sample_time = sample_time;
      design.sections = frac::discretise(system, sample_time).parallel;
      frac::DigitalFilter<double> filter(design);
      const double seconds = seconds_of(filter, input, output);
      const std::vector<Quad> exact = support::filter_in_quadruple(system, sample_time, input);
      std::printf("s^0.5 fs/wb = %.0e,parallel sections,%d poles %zu samples,%.2e,%.2e\n", ratio, poles, samples,
                  support::worst_difference(exact, output), seconds / static_cast<double>(samples) / poles);
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

void direct_designs(std::size_t samples) {
  const std::vector<double> input = noise(samples);
  std::vector<double> output(samples);
  const double sample_time = 1e-3;
  for (const double order : {0.1, 0.5, 0.9, -0.5}) {
    for (const double share : {0.05, 0.25}) {
      const double upper = share * 2 * M_PI / sample_time;
      const auto power = frac::digital_power(order, {upper / 1e10, upper}, frac::PoleCount{30}, sample_time);
      const auto design = filter_design(power);
      frac::DigitalFilter<double> filter(design);
      const double seconds = seconds_of(filter, input, output);
      const double sections = static_cast<double>(design.sections.rates.size());
      std::printf("s^%g to %g fs fs/wb = %.0e,direct,30 poles %zu taps %zu samples,%.2e,%.2e\n", order, share,
                  1e10 / share, design.taps.size(), samples,
                  support::worst_difference(support::design_in_quadruple(design, input), output),
                  seconds / static_cast<double>(samples) / sections);
      std::fflush(stdout);
    }
  }
}

template <typename Real>
void kernel(const char* name, const char* method, const frac::detail::SectionKernels<Real>& kernels) {
  constexpr std::size_t sizes[] = {16, 32};
  constexpr int blocks = 20'000;
  for (const std::size_t size : sizes) {
    std::vector<Real> rate(size), weight(size, 1), state(size), lost(size);
    for (std::size_t i = 0; i < size; ++i) rate[i] = static_cast<Real>(std::pow(10.0, -0.2 * static_cast<double>(i)));
    const frac::detail::SectionArrays<Real> bank{rate.data(), weight.data(), state.data(), lost.data(), size};
    Real x[frac::detail::section_block], y[frac::detail::section_block];
    support::Random random(3);
    for (Real& value : x) value = static_cast<Real>(random.normal());
    std::vector<double> seconds;
    for (int repeat = 0; repeat < 7; ++repeat) {
      const double start = processor_seconds();
      for (int block = 0; block < blocks; ++block) kernels.run_changes(bank, x, y, frac::detail::section_block);
      seconds.push_back(processor_seconds() - start);
    }
    const double each = static_cast<double>(blocks) * frac::detail::section_block * static_cast<double>(size);
    std::printf("sections in %s,%s,%zu sections,,%.2e\n", name, method, size, median(seconds) / each);
  }
}

template <typename Real>
void kernels(const char* name) {
  kernel(name, "SSE2", frac::detail::section_kernels<Real, 16>);
#if defined(__x86_64__)
  using frac::detail::InstructionSet;
  const InstructionSet known = frac::detail::processor_instruction_set();
  if (known >= InstructionSet::avx2) kernel(name, "AVX2", frac::detail::avx2_section_kernels<Real>());
  if (known >= InstructionSet::avx512) kernel(name, "AVX-512", frac::detail::avx512_section_kernels<Real>());
#endif
}

// A constant through integrals for very long: the last sample against its closed form.
void long_streams(std::size_t samples) {
  constexpr std::size_t part = 10'000;
  const double sample_time = 1e-3;
  const double count = static_cast<double>(samples);
  {
    const auto model = frac::FractionalTransferFunction::parse("1/s^1.5");
    const auto design = filter_design(model, sample_time, 1e-12, count);
    frac::DigitalFilter<double> filter(design);
    const std::vector<double> ones(part, 1.0);
    std::vector<double> output(part);
    const double start = processor_seconds();
    for (std::size_t n = 0; n < samples; n += part) filter.run(ones, output);
    const double seconds = processor_seconds() - start;
    const double exact = std::pow((count - 1) * sample_time, 1.5) / std::tgamma(2.5);
    std::printf("stream of %.0e samples,DigitalFilter of 1/s^1.5,%zu states,%.2e,%.2e\n", count, filter.states(),
                std::abs(output.back() / exact - 1), seconds);
  }
  frac::FractionalPidConfig config;
  config.gains = {.kp = 0, .ki = 1, .kd = 0, .lambda = 1, .mu = 1};
  config.sample_time = sample_time;
  frac::FractionalPid<double> pid(config);
  const double start = processor_seconds();
  for (std::size_t n = 0; n < samples; ++n) (void)pid.step(0.1, 0);
  const double exact = (count - 0.5) * 0.1 * sample_time;
  std::printf("stream of %.0e samples,FractionalPid lambda = 1,,%.2e,%.2e\n", count, std::abs(pid.output() / exact - 1),
              processor_seconds() - start);
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
    const std::string setting = std::to_string(design.integral().sections.rates.size()) + " + " +
                                std::to_string(design.derivative().sections.rates.size()) + " sections";
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
  direct_designs(smoke ? 2000 : 1'000'000);
  long_streams(smoke ? 20'000 : 100'000'000);
  kernels<double>("double");
  kernels<float>("float");
  silence(smoke ? 2000 : 1'000'000);
  steps<double>("double", smoke ? 2000 : 1'000'000);
  steps<float>("float", smoke ? 2000 : 1'000'000);
}
