// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/fixed_point.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
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

// What a filter can have, all by chance: slow and fast sections in either form, pairs that ring for up to some thousand
// samples, taps, a difference, an integrator, dead time.
DigitalFilterDesign any_filter(std::mt19937_64& random) {
  const auto uniform = [&](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  const auto spread = [&](double lower, double upper) { return std::exp(uniform(std::log(lower), std::log(upper))); };
  const auto one_in = [&](int count) { return std::uniform_int_distribution<int>(1, count)(random) == 1; };
  DigitalFilterDesign design;
  design.sample_time = spread(1e-3, 1);
  design.sections.output = one_in(2) ? frac::SectionOutput::state : frac::SectionOutput::change;
  design.sections.direct = one_in(4) ? 0 : uniform(-1, 1);
  for (int i = std::uniform_int_distribution<int>(0, 6)(random); i > 0; --i) {
    design.sections.rates.push_back(spread(1e-6, 1.9));
    design.sections.weights.push_back(uniform(-1, 1) * std::pow(design.sections.rates.back(), uniform(0, 1.2)));
  }
  for (int i = std::uniform_int_distribution<int>(0, 2)(random); i > 0; --i) {
    design.pair_rates.push_back(1.0 - std::polar(1 - spread(1e-3, 0.9), spread(1e-3, 3)));
    design.pair_weights.push_back(std::polar(spread(1e-2, 1) * std::abs(design.pair_rates.back()), uniform(-3, 3)));
  }
  if (one_in(2)) {
    design.taps.clear();
    for (int i = std::uniform_int_distribution<int>(1, 9)(random); i > 0; --i) design.taps.push_back(uniform(-2, 2));
  }
  if (one_in(3)) design.differences = 1;
  if (one_in(3)) design.integrators = 1;
  if (one_in(2)) design.rule = frac::IntegratorRule::held;
  if (one_in(2)) design.dead_samples = std::uniform_int_distribution<std::size_t>(1, 20)(random);
  return design;
}

// Ends of the range for times of all lengths, such as a pair's period, and noise.
std::vector<std::int32_t> rough_samples(std::size_t count, std::mt19937_64& random) {
  std::vector<std::int32_t> x;
  while (x.size() < count) {
    const auto kind = random() % 4;
    const std::size_t half = std::size_t{1} + random() % 200, length = half * (1 + random() % 16);
    for (std::size_t n = 0; n < length && x.size() < count; ++n)
      x.push_back(kind == 0 ? static_cast<std::int32_t>(random()) : (n / half + kind) % 2 == 0 ? INT32_MAX : INT32_MIN);
  }
  return x;
}

double largest_output(const DigitalFilterDesign& design, const std::vector<std::int32_t>& x) {
  frac::DigitalFilter<double> exact(design);
  double largest = 0;
  for (const std::int32_t sample : x) largest = std::max(largest, std::abs(exact.step(std::ldexp(sample, -31))));
  return largest;
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
  // With taps, designed in z.
  for (const double order : {-0.5, 0.5, 1.4})
    expect_within_bound(frac::filter_design(frac::digital_power(order, {0.1, 70}, frac::Tolerance{1e-3}, 0.02)),
                        {.input = 5, .output = order < 1 ? 400.0 : 30000.0}, 0.01);
  // With a pair of complex poles, a tenth damped.
  const auto resonance = frac::FractionalTransferFunction::parse("1/(s^2 + 0.2 s + 0.1 s^0.5 + 1)");
  expect_within_bound(frac::model_filter(resonance, frac::FrequencyBand{1e-2, 1e1}, 0.05, 1e-3).design,
                      {.input = 1, .output = 12}, 0.01);
  // Rates above 1 and near 2, whose low-passes swing beyond their input, and slow ones.
  DigitalFilterDesign rough;
  rough.sections = {
      .output = frac::SectionOutput::state, .direct = 0.3, .rates = {1.9, 1.2, 1e-6}, .weights = {0.1, 0.2, 2e-7}};
  expect_within_bound(rough, {.input = 1, .output = 4}, 0.01);
}

// Each of many filters keeps its bound at every sample; how near it comes is recorded.  FRACFIT_FIXED_POINT_CASES
// takes more of them than a build's tests have time for.
TEST_F(FixedPoint, FiltersOfAnyKindKeepTheirErrorBound) {
  const char* const asked = std::getenv("FRACFIT_FIXED_POINT_CASES");
  const int cases = asked != nullptr ? std::atoi(asked) : 24;
  std::mt19937_64 random(31);
  int violations = 0, refused = 0;
  std::vector<double> shares;
  for (int i = 0; i < cases; ++i) {
    SCOPED_TRACE(i);
    const DigitalFilterDesign design = any_filter(random);
    const auto x = rough_samples(5000, random);
    const FixedPointRanges ranges{.input = 1, .output = 1.1 * largest_output(design, x) + 1e-6};
    frac::FixedPointHeader header;
    try {
      header = frac::fixed_point_header(design, ranges, {.name = "model"});
    } catch (const std::invalid_argument& reason) {
      ++refused;
      EXPECT_NE(std::string(reason.what()).find("a larger range is needed"), std::string::npos) << reason.what();
      continue;
    }
    const auto outputs = outputs_of(header.text, x);
    ASSERT_EQ(outputs.size(), x.size());
    frac::DigitalFilter<double> exact(design);
    double share = 0;
    for (std::size_t n = 0; n < x.size(); ++n) {
      const double expected = exact.step(std::ldexp(x[n], -31));
      // Rounding of the exact filter in double, far below.
      const double bound =
          header.error_bound + static_cast<double>(n) * header.error_per_sample + 1e-12 * ranges.output;
      share = std::max(share, std::abs(std::ldexp(outputs[n], -31) * ranges.output - expected) / bound);
    }
    violations += share > 1 ? 1 : 0;
    shares.push_back(share);
  }
  EXPECT_EQ(violations, 0);
  EXPECT_LE(refused, cases / 10);
  std::sort(shares.begin(), shares.end());
  ASSERT_FALSE(shares.empty());
  // A bound that adds up all parts at their worst is met to some per cent by chance.
  EXPECT_GT(shares[shares.size() / 2], 0.01) << "the bound is not idle";
  std::printf("%zu filters, %d refused, %d beyond the bound; largest error over bound: median %.3f, most %.3f\n",
              shares.size(), refused, violations, shares[shares.size() / 2], shares.back());
}

// What the state does where the output is cut: the integral goes on, and comes back with what it took in.
TEST_F(FixedPoint, AnIntegralIsKeptWhileItsOutputIsCut) {
  DigitalFilterDesign design;
  design.sample_time = 0.01;
  design.sections.direct = 1;
  design.integrators = 1;
  const FixedPointRanges ranges{.input = 1, .output = 1};
  const auto header = frac::fixed_point_header(design, ranges, {.name = "model"});
  const auto run = [&](int up) {  // samples of +1, then as many of -1
    std::vector<std::int32_t> x(static_cast<std::size_t>(up), INT32_MAX);
    x.resize(2 * x.size(), -INT32_MAX);
    return outputs_of(header.text, x);
  };
  // 0.01 each sample: up to 10, within the 16 ranges that are kept, and back to 0 but for the half of the last step.
  const auto within = run(1000);
  EXPECT_EQ(within[999], INT32_MAX);
  EXPECT_NEAR(std::ldexp(within[1999], -31), 0.005, header.error_bound + 2000 * header.error_per_sample);
  // Up to 16 instead of 20, and from there 20 down.
  const auto beyond = run(2000);
  EXPECT_EQ(beyond[3999], INT32_MIN);
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
    for (const auto& [lag, method] : {std::pair{0.0, frac::Discretisation::tustin},
                                      {0.05, frac::Discretisation::tustin},
                                      {0.05, frac::Discretisation::direct}}) {
      SCOPED_TRACE(std::to_string(lambda) + " " + std::to_string(mu) + " " + std::to_string(lag) + " " +
                   std::string(frac::to_string(method)));
      auto config = pid_config(lambda, mu);
      config.derivative_filter_time = lag;
      config.discretisation = method;
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

// Gains, orders, weights, lags and designs by chance; FRACFIT_FIXED_POINT_CASES as above.
TEST_F(FixedPoint, ControllersOfAnyKindKeepTheirErrorBound) {
  const char* const asked = std::getenv("FRACFIT_FIXED_POINT_CASES");
  const int cases = asked != nullptr ? std::atoi(asked) : 8;
  std::mt19937_64 random(32);
  const auto uniform = [&](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  const auto spread = [&](double lower, double upper) { return std::exp(uniform(std::log(lower), std::log(upper))); };
  const auto x = pairs_of_samples(4000);
  int violations = 0, refused = 0;
  std::vector<double> shares;
  for (int i = 0; i < cases; ++i) {
    SCOPED_TRACE(i);
    frac::FractionalPidConfig config;
    config.sample_time = spread(1e-3, 1e-1);
    config.gains = {.kp = spread(0.1, 10),
                    .ki = spread(0.1, 10),
                    .kd = i % 4 == 0 ? 0 : spread(1e-3, 0.1),
                    .lambda = uniform(0.2, 1.6),
                    .mu = uniform(0.2, 1.6)};
    config.band = {spread(1e-3, 0.1) / config.sample_time, 1 / config.sample_time};
    config.goal = frac::PoleCount{static_cast<int>(random() % 8) + 2};
    config.setpoint_weight = uniform(0, 1);
    config.derivative_setpoint_weight = uniform(0, 1);
    config.derivative_filter_time = i % 3 == 0 ? 0 : spread(0.1, 10) * config.sample_time;
    config.discretisation = i % 2 == 0 ? frac::Discretisation::direct : frac::Discretisation::tustin;
    const frac::FractionalPidDesign design(config);
    double largest = 0;
    frac::FractionalPid<double> first(design);
    for (std::size_t n = 0; n + 1 < x.size(); n += 2)
      largest = std::max(largest, std::abs(first.step(std::ldexp(x[n], -31), std::ldexp(x[n + 1], -31))));
    const FixedPointRanges ranges{.input = 1, .output = 1.1 * largest};
    frac::FixedPointHeader header;
    try {
      header = frac::fixed_point_header(design, ranges, {.name = "model"});
    } catch (const std::invalid_argument& reason) {
      ++refused;
      EXPECT_NE(std::string(reason.what()).find("a larger range is needed"), std::string::npos) << reason.what();
      continue;
    }
    const auto outputs = outputs_of(header.text, x, 2);
    frac::FractionalPid<double> exact(design);
    double share = 0;
    for (std::size_t n = 0; n < outputs.size(); ++n) {
      const double expected = exact.step(std::ldexp(x[2 * n], -31), std::ldexp(x[2 * n + 1], -31));
      const double bound = header.error_bound + static_cast<double>(n) * header.error_per_sample + 1e-12 * largest;
      share = std::max(share, std::abs(std::ldexp(outputs[n], -31) * ranges.output - expected) / bound);
    }
    violations += share > 1 ? 1 : 0;
    shares.push_back(share);
  }
  EXPECT_EQ(violations, 0);
  EXPECT_LE(refused, cases / 4);
  std::sort(shares.begin(), shares.end());
  ASSERT_FALSE(shares.empty());
  EXPECT_GT(shares[shares.size() / 2], 0.01) << "the bound is not idle";
  std::printf("%zu controllers, %d refused, %d beyond the bound; largest error over bound: median %.3f, most %.3f\n",
              shares.size(), refused, violations, shares[shares.size() / 2], shares.back());
}

// At its limits the controller does what the class does: the integral is kept from winding up by the same share.
TEST_F(FixedPoint, ControllersLeaveTheirLimitsWithTheClass) {
  for (const frac::Discretisation method : {frac::Discretisation::tustin, frac::Discretisation::direct}) {
    auto config = pid_config(0.8, 0.6);
    config.minimum = -3;
    config.maximum = 4;
    config.discretisation = method;
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
}

// The kick of the derivative at a step exceeds the limit by less than the header says is drawn back as in the class,
// and by three times as much: what is stated holds for the worst control error, which leaves half of the room.
TEST_F(FixedPoint, BackCalculationIsThatOfTheClassUpToTheStatedExcess) {
  frac::FractionalPidConfig config;
  config.gains = {.kp = 0.5, .ki = 20, .kd = 0.02, .lambda = 0.9, .mu = 1};
  config.sample_time = 1e-3;
  config.band = {0.1, 300};
  const FixedPointRanges ranges{.input = 1, .output = 5};
  const double step = 0.2, kick = frac::FractionalPid<double>(frac::FractionalPidDesign(config)).step(step, 0);
  const double excess = frac::fixed_point_header(frac::FractionalPidDesign(config), ranges, {}).exact_excess;
  for (const double share : {0.95, 3.0}) {
    config.maximum = kick - share * excess;
    ASSERT_GT(config.maximum, 0);
    const frac::FractionalPidDesign design(config);
    const auto header = frac::fixed_point_header(design, ranges, {.name = "model"});
    EXPECT_EQ(header.exact_excess, excess);
    EXPECT_NE(header.text.find("as long as the sum exceeds it by "), std::string::npos);
    std::vector<std::int32_t> x;
    for (int n = 0; n < 1000; ++n) x.insert(x.end(), {static_cast<std::int32_t>(std::ldexp(step, 31)), 0});
    const auto outputs = outputs_of(header.text, x, 2);
    frac::FractionalPid<double> exact(design);
    double worst = 0;
    for (const std::int32_t output : outputs)
      worst = std::max(worst, std::abs(std::ldexp(output, -31) * ranges.output - exact.step(step, 0)));
    // Within it as above; beyond, what is not drawn back passes through the integral.
    if (share < 1) {
      EXPECT_LT(worst, 1e-6 * ranges.output);
    } else {
      EXPECT_GT(worst, 1e-4 * ranges.output);
    }
  }
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
  design.sections = {.output = frac::SectionOutput::state, .direct = 1, .rates = {0.5}, .weights = {0.5}};
  refusal(design, {.input = 0, .output = 1}, "input range = 0");
  refusal(design, {.input = 1, .output = NAN}, "output range = nan");
  refusal(design, {.input = 1e9, .output = 1}, "a larger range is needed");
  design.integrators = 2;
  refusal(design, {}, "2 integrators");
  design.integrators = 0;
  design.dead_samples = 200'000;
  refusal(design, {}, "dead time of 200000 samples");
  design.dead_samples = 0;
  design.taps = {};
  refusal(design, {}, "no taps");
  design.taps = {1};
  design.pair_rates = {{0, 0.1}};  // on the unit circle but for 0.005 outside
  design.pair_weights = {1};
  refusal(design, {}, "damped too little");
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
}

}  // namespace
