// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/fixed_point.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "support/expect_invalid_argument.hpp"
#include "tools/temporary_folder.hpp"

namespace {

using frac::DigitalFilterDesign;
using frac::FixedPointRanges;

// Runs the header over samples of 32 bits, compiled by cc without a warning.
// @param inputs  of a step; several come one after the other
std::vector<std::int32_t> outputs_of(const std::string& header, const std::vector<std::int32_t>& samples,
                                     int inputs = 1) {
  const TemporaryFolder folder;
  folder.write("model.h", header);
  folder.write("samples", std::string(reinterpret_cast<const char*>(samples.data()), 4 * samples.size()));
  folder.write("main.c",
               std::string("#include \"model.h\"\n#include <stdio.h>\nint main(void)\n{\n  static model_state s;\n") +
                   "  int32_t x[2], y;\n  model_init(&s);\n  while (fread(x, " + std::to_string(4 * inputs) +
                   ", 1, stdin) == 1) {\n    y = model_step(&s, x[0]" + (inputs == 2 ? ", x[1]" : "") +
                   ");\n    fwrite(&y, 4, 1, stdout);\n  }\n  return 0;\n}\n");
  const std::string at = folder.path();
  const std::string compile = "cc -std=c99 -O2 -Wall -Wextra -Werror -pedantic -Wshadow -Wconversion -o '" + at +
                              "run' '" + at + "main.c' 2>'" + at + "messages'";
  EXPECT_EQ(std::system(compile.c_str()), 0) << content_of(folder.path("messages"));
  EXPECT_EQ(std::system(("'" + at + "run' <'" + at + "samples' >'" + at + "outputs'").c_str()), 0);
  const std::string bytes = content_of(folder.path("outputs"));
  std::vector<std::int32_t> outputs(bytes.size() / 4);
  std::memcpy(outputs.data(), bytes.data(), bytes.size());
  return outputs;
}

// Long runs at either end of the range, which drive states and their errors furthest, and noise.
std::vector<std::int32_t> samples() {
  std::mt19937 random(9);
  std::vector<std::int32_t> x;
  while (x.size() < 200'000) {
    const std::size_t length = std::size_t{1} << random() % 15;
    const bool is_noise = random() % 3 == 0;
    const std::int32_t end = random() % 2 == 0 ? INT32_MAX : INT32_MIN;
    for (std::size_t n = 0; n < length; ++n) x.push_back(is_noise ? static_cast<std::int32_t>(random()) : end);
  }
  return x;
}

void expect_within_bound(const DigitalFilterDesign& design, const FixedPointRanges& ranges, double least_share) {
  const auto header = frac::fixed_point_header(design, ranges, {.name = "model", .comment = "A filter."});
  EXPECT_NE(header.text.find("an output differs from the exact one by "), std::string::npos);
  const auto x = samples();
  const auto outputs = outputs_of(header.text, x);
  ASSERT_EQ(outputs.size(), x.size());
  frac::DigitalFilter<double> exact(design);
  double worst = 0, largest = 0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double expected = exact.step(std::ldexp(x[n], -31) * ranges.input);
    largest = std::max(largest, std::abs(expected));
    worst = std::max(worst, std::abs(std::ldexp(outputs[n], -31) * ranges.output - expected));
  }
  ASSERT_LT(largest, ranges.output) << "nothing was cut";
  // Rounding of the exact filter in double, far below.
  EXPECT_LE(worst, header.error_bound + 1e-12 * largest);
  EXPECT_GE(worst, least_share * header.error_bound) << "the bound is not idle";
  // The whole point: an error near the last bit of the output, in spite of slow states.
  EXPECT_LT(header.error_bound, 1e-6 * ranges.output);
}

class FixedPoint : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("cc --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no C compiler";
  }
};

TEST_F(FixedPoint, KeepsItsErrorBound) {
  const auto power = [](double order) {
    return frac::filter_design(
        frac::digital_power(order, {0.1, 70}, frac::Tolerance{1e-3}, 0.02, frac::Discretisation::tustin));
  };
  // A bound that adds up all parts at their worst is met to some per cent by chance.
  expect_within_bound(power(-0.5), {.input = 5, .output = 100}, 0.01);
  expect_within_bound(power(0.5), {.input = 5, .output = 200}, 0.01);
  const auto relaxation = frac::FractionalTransferFunction::parse("3/(1 + (0.5 s)^0.7)");
  expect_within_bound(frac::model_filter(relaxation, frac::FrequencyBand{1e-3, 1e2}, 0.01, 1e-3).design,
                      {.input = 1, .output = 3.2}, 0.01);
  // Rates above 1 and near 2, whose low-passes swing beyond their input, and slow ones.
  DigitalFilterDesign rough;
  rough.sections = {
      .output = frac::SectionOutput::state, .direct = 0.3, .rates = {1.9, 1.2, 1e-6}, .weights = {0.1, 0.2, 2e-7}};
  expect_within_bound(rough, {.input = 1, .output = 4}, 0.01);
}

frac::FractionalPidConfig pid_config(double lambda, double mu) {
  frac::FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0.05, .lambda = lambda, .mu = mu};
  config.sample_time = 0.01;
  config.band = {0.1, 100};
  config.goal = frac::PoleCount{8};
  config.setpoint_weight = 0.7;
  config.derivative_setpoint_weight = 0;
  config.discretisation = frac::Discretisation::tustin;
  return config;
}

// Set-point and measured value of a controller: constant at any level, or noise.  The set-point follows at a distance
// that keeps the integral within its range for the length of the run.
std::vector<std::int32_t> pairs_of_samples(std::size_t count) {
  std::mt19937 random(12);
  std::vector<std::int32_t> x;
  double sum = 0;
  while (x.size() < 2 * count) {
    const std::size_t length = std::size_t{1} << random() % 7;
    const auto level = static_cast<std::int32_t>(random());
    // Errors of either sign by turns, as the sum asks for.
    const double error = (sum > 0 ? -1 : 1) * std::ldexp(1.0 + static_cast<double>(random() % 8), -4);
    for (std::size_t n = 0; n < length; ++n) {
      const double setpoint = std::clamp(std::ldexp(level, -31) + error, -1.0, 1 - std::ldexp(1.0, -31));
      const auto whole = static_cast<std::int32_t>(std::floor(std::ldexp(setpoint, 31)));
      x.push_back(whole);
      x.push_back(level);
      sum += std::ldexp(static_cast<double>(whole) - level, -31);
    }
  }
  return x;
}

// The whole controller against its class in double, from the start on, where nothing is cut.
TEST_F(FixedPoint, ControllersKeepTheirErrorBound) {
  const FixedPointRanges ranges{.input = 2, .output = 200};
  for (const auto& [lambda, mu] : {std::pair{0.8, 0.6}, {1.0, 1.0}, {0.5, 1.3}, {1.2, 0.4}}) {
    for (const double lag : {0.0, 0.05}) {
      SCOPED_TRACE(std::to_string(lambda) + " " + std::to_string(mu) + " " + std::to_string(lag));
      auto config = pid_config(lambda, mu);
      config.derivative_filter_time = lag;
      const frac::FractionalPidDesign design(config);
      const auto header = frac::fixed_point_header(design, ranges, {.name = "model"});
      const auto x = pairs_of_samples(20'000);
      const auto outputs = outputs_of(header.text, x, 2);
      frac::FractionalPid<double> exact(design);
      double share = 0, largest = 0;
      for (std::size_t n = 0; n < outputs.size(); ++n) {
        const double expected =
            exact.step(std::ldexp(x[2 * n], -31) * ranges.input, std::ldexp(x[2 * n + 1], -31) * ranges.input);
        largest = std::max(largest, std::abs(expected));
        const double bound = header.error_bound + static_cast<double>(n) * header.error_per_sample;
        const double error = std::abs(std::ldexp(outputs[n], -31) * ranges.output - expected);
        // Rounding of the exact controller in double, far below.
        ASSERT_LE(error, bound + 1e-12 * largest) << n;
        share = std::max(share, error / bound);
      }
      ASSERT_LT(largest, ranges.output) << "nothing was cut";
      EXPECT_GE(share, 0.01) << "the bound is not idle";
      EXPECT_LT(header.error_bound, 1e-6 * ranges.output);
      EXPECT_LT(header.error_per_sample, 1e-9 * ranges.output);
    }
  }
}

// At its limits the controller does what the class does: the integral is kept from winding up by the same share.
TEST_F(FixedPoint, ControllersLeaveTheirLimitsWithTheClass) {
  auto config = pid_config(0.8, 0.6);
  config.minimum = -3;
  config.maximum = 4;
  const frac::FractionalPidDesign design(config);
  const FixedPointRanges ranges{.input = 2, .output = 50};
  const auto header = frac::fixed_point_header(design, ranges, {.name = "model"});
  std::vector<std::int32_t> x;
  for (int n = 0; n < 4000; ++n) {
    x.push_back(n / 500 % 2 == 0 ? 1 << 30 : -(1 << 29));
    x.push_back((n % 100) << 22);
  }
  const auto outputs = outputs_of(header.text, x, 2);
  frac::FractionalPid<double> exact(design);
  int cut = 0;
  for (std::size_t n = 0; n < outputs.size(); ++n) {
    const double expected =
        exact.step(std::ldexp(x[2 * n], -31) * ranges.input, std::ldexp(x[2 * n + 1], -31) * ranges.input);
    cut += exact.saturated() ? 1 : 0;
    // Correction of the integral passes numbers of 30 bits of the output range to the input and back.
    ASSERT_NEAR(std::ldexp(outputs[n], -31) * ranges.output, expected, 1e-6 * ranges.output) << n;
  }
  EXPECT_GT(cut, 500);
  EXPECT_LT(cut, 3500);
}

TEST_F(FixedPoint, CutsWhatIsBeyondItsRange) {
  DigitalFilterDesign design;
  design.sections = {.output = frac::SectionOutput::state, .direct = 1, .rates = {0.5}, .weights = {0.5}};
  const auto header = frac::fixed_point_header(design, {.input = 1, .output = 1}, {.name = "model"});
  // The gain at rest is 2: half of the range fills it.
  std::vector<std::int32_t> x(40, INT32_MAX / 4 * 3);
  x.resize(80, -INT32_MAX);
  const auto outputs = outputs_of(header.text, x);
  EXPECT_EQ(outputs[39], INT32_MAX);
  EXPECT_EQ(outputs[79], INT32_MIN);
}

TEST(FixedPointDesign, RefusesWhatItCannotHold) {
  const auto refusal = [](const DigitalFilterDesign& design, const FixedPointRanges& ranges, const std::string& words) {
    support::expect_invalid_argument([&] { (void)frac::fixed_point_header(design, ranges, {}); }, {words});
  };
  DigitalFilterDesign design;
  refusal(design, {}, "no section");
  design.sections = {.output = frac::SectionOutput::state, .direct = 1, .rates = {0.5}, .weights = {0.5}};
  refusal(design, {.input = 0, .output = 1}, "input range = 0");
  refusal(design, {.input = 1, .output = NAN}, "output range = nan");
  refusal(design, {.input = 1e9, .output = 1}, "a larger range is needed");
  design.taps = {1, 0.5};
  refusal(design, {}, "2 taps");
  design.taps = {1};
  design.integrators = 1;
  refusal(design, {}, "1 integrators");
  const auto pid_refusal = [](const frac::FractionalPidConfig& config, const FixedPointRanges& ranges,
                              const std::string& words) {
    support::expect_invalid_argument(
        [&] { (void)frac::fixed_point_header(frac::FractionalPidDesign(config), ranges, {}); }, {words});
  };
  auto config = pid_config(0.8, 0.6);
  pid_refusal(config, {.input = 1, .output = 0}, "output range = 0");
  pid_refusal(config, {.input = 1e9, .output = 1}, "a larger range is needed");
  config.anti_windup = frac::AntiWindup::conditional_integration;
  pid_refusal(config, {}, "no conditional integration");
  config = pid_config(0.8, 0.6);
  config.setpoint_weight = 1.5;
  pid_refusal(config, {}, "set-point weight of 1.5");
  config = pid_config(0.8, 0.6);
  config.discretisation = frac::Discretisation::direct;
  pid_refusal(config, {}, "taps");
}

}  // namespace
