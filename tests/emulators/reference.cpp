// SPDX-License-Identifier: BSD-3-Clause
// usage: emulator_reference <case> <float|double> <samples> <header>
// Writes the C header of a case, and prints the bits of what the library's own class gives for the samples of
// firmware.c; in fixed point, for which there is no class, the header alone.
#include <bit>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

#include "frac/digital/c_header.hpp"
#include "frac/digital/fixed_point.hpp"

namespace {

frac::FractionalPidDesign pid_design(frac::Discretisation discretisation) {
  frac::FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0.05, .lambda = 0.8, .mu = 0.6};
  config.sample_time = 0.02;
  config.band = {0.1, 70};
  config.goal = frac::PoleCount{8};
  config.minimum = -5;
  config.maximum = 5;
  config.discretisation = discretisation;
  return frac::FractionalPidDesign(config);
}

frac::DigitalFilterDesign filter_design() {
  const auto model = frac::FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  return frac::model_filter(model, frac::FrequencyBand{0.01, 100}, 0.01, 1e-3).design;
}

template <typename Real, typename Step>
void print_bits(int samples, Step step) {
  std::uint32_t drawn = 1;
  for (int n = 0; n < samples; ++n) {
    drawn = drawn * 1664525u + 1013904223u;
    const Real measured = static_cast<Real>(static_cast<std::int32_t>(drawn) / 256) / Real{8388608};
    const Real output = step(static_cast<Real>(n / 50 % 3), measured);
    if constexpr (sizeof(Real) == 4) {
      std::printf("%08x\n", std::bit_cast<std::uint32_t>(output));
    } else {
      std::printf("%016llx\n", static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(output)));
    }
  }
}

std::string fixed_point(const std::string& name, const frac::CHeaderOptions& options) {
  if (name.starts_with("fixed-pid")) {
    const auto rule = name == "fixed-pid" ? frac::Discretisation::tustin : frac::Discretisation::direct;
    return frac::fixed_point_header(pid_design(rule), {.input = 2, .output = 10}, options).text;
  }
  if (name == "fixed-all") {
    // Taps, a difference, sections, a pair of complex poles, an integrator and dead time.
    frac::DigitalFilterDesign design;
    design.sample_time = 0.02;
    design.dead_samples = 5;
    design.differences = 1;
    design.integrators = 1;
    design.taps = {0.7, 0.4, -0.1};
    design.sections = {
        .output = frac::SectionOutput::state, .direct = 0.3, .rates = {0.2, 1e-3}, .weights = {0.1, -5e-4}};
    design.pair_rates = {{0.04, 0.2}};
    design.pair_weights = {{0.02, -0.05}};
    return frac::fixed_point_header(design, {.input = 4, .output = 20}, options).text;
  }
  const auto power = frac::digital_power(-0.5, {0.1, 70}, frac::PoleCount{8}, 0.02, frac::Discretisation::tustin);
  return frac::fixed_point_header(frac::filter_design(power), {.input = 5, .output = 100}, options).text;
}

template <typename Real>
void run(const std::string& name, int samples, const frac::CHeaderOptions& options, std::ofstream& header) {
  if (name == "filter") {
    const auto design = filter_design();
    header << frac::c_header(design, options);
    frac::DigitalFilter<Real> filter(design);
    print_bits<Real>(samples, [&](Real setpoint, Real measured) { return filter.step(setpoint - measured); });
    return;
  }
  const auto design = pid_design(name == "pid" ? frac::Discretisation::tustin : frac::Discretisation::direct);
  header << frac::c_header(design, options);
  frac::FractionalPid<Real> pid(design);
  print_bits<Real>(samples, [&](Real setpoint, Real measured) { return pid.step(setpoint, measured); });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  const frac::CHeaderOptions options{.name = "model", .precision = frac::precision_from_string(argv[2])};
  std::ofstream header(argv[4]);
  const int samples = std::stoi(argv[3]);
  if (std::string(argv[1]).starts_with("fixed")) {
    header << fixed_point(argv[1], options);
  } else if (options.precision == frac::Precision::float_type) {
    run<float>(argv[1], samples, options, header);
  } else {
    run<double>(argv[1], samples, options, header);
  }
  return header.flush() ? 0 : 1;
}
