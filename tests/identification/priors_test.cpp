// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/joint_fit.hpp"
#include "frac/identification/statistics.hpp"
#include "frac/identification/time_fit.hpp"
#include "frac/identification/uncertainty.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/noisy_response.hpp"

namespace {

using namespace frac;

/// A + j omega B with noise of deviation 0.1 on both parts, at omega 0.1 to 2: the real part tells A alone, the
/// imaginary part B alone, and both are linear.
FrequencyResponseData line(double a, double b, std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, 0.1);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (int i = 1; i <= 20; ++i) {
    omega.push_back(0.1 * i);
    const double real = a + noise(generator), imaginary = b * omega.back() + noise(generator);
    value.emplace_back(real, imaginary);
  }
  return {omega, value};
}

FitOptions plain() {
  FitOptions options;
  options.component = Component::both;
  options.weight = Weight::absolute;
  return options;
}

ParameterConstraint prior_of(const std::string& name, ParameterPrior prior) {
  ParameterConstraint constraint{name, {}, {}, {}, {}};
  constraint.prior = prior;
  return constraint;
}

double mean_of_real_part(const FrequencyResponseData& data) {
  double sum = 0;
  for (const auto& each : data.value()) sum += each.real();
  return sum / static_cast<double>(data.size());
}

// Of a mean of 20 values and a normal prior the posterior is known: precisions add up.  The variance of the noise is
// what the residuals leave, each parameter counting by what the data tell of it.
TEST(Priors, MeetTheClosedFormOfAMean) {
  std::mt19937_64 generator(1);
  const FrequencyResponseData data = line(2, 1, generator);
  const ParameterPrior prior{2.1, 0.03, false};
  FitOptions options = plain();
  options.constraints = {prior_of("A", prior)};
  const FitResult result = fit(data, Structure("A + B s"), options);
  ASSERT_TRUE(result.usable()) << result.message;
  const double variance = result.cost / (40 - result.effective_parameters);
  const double of_data = 20 / variance, of_prior = 1 / (0.03 * 0.03);
  // The noise is taken as settled at four digits, and its share in the estimate is less than one.
  const double mean = (of_data * mean_of_real_part(data) + of_prior * 2.1) / (of_data + of_prior);
  EXPECT_NEAR(result.parameters[0].value, mean, 1e-4 * std::abs(mean - 2.1));
  EXPECT_NEAR(result.parameters[0].standard_error / result.parameters[0].widening, 1 / std::sqrt(of_data + of_prior),
              2e-4 * 0.03);
  EXPECT_NEAR(result.effective_parameters, 1 + of_data / (of_data + of_prior), 1e-3);
  ASSERT_EQ(result.priors.size(), 1u);
  EXPECT_NEAR(result.priors[0].distance, (mean - 2.1) / 0.03, 1e-3);
  // Prior and mean are independent, so their difference has the sum of their variances.
  // A widening w is that of the estimate, of which the mean has the share of_data/(of_data + of_prior).
  const double added = (std::pow(result.parameters[0].widening, 2) - 1) * (of_data + of_prior) / (of_data * of_data);
  const double apart = (mean_of_real_part(data) - 2.1) / std::sqrt(1 / of_data + added + 1 / of_prior);
  EXPECT_NEAR(result.priors[0].conflict, apart, 1e-3 * std::abs(apart));
  // The profile follows a parabola here.
  const ProfileInterval profile = profile_interval(data, options, result, "A");
  const double half = student_t_95(40 - result.effective_parameters) * result.parameters[0].standard_error;
  EXPECT_NEAR(profile.lower, mean - half, 1e-3 * half);
  EXPECT_NEAR(profile.upper, mean + half, 1e-3 * half);
}

// ln|K j omega/data| is linear in ln K.
TEST(Priors, MeetTheClosedFormOfAMeanOfLogarithms) {
  std::mt19937_64 generator(2);
  std::normal_distribution<double> noise(0, 0.05);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  double sum = 0;
  for (int i = 1; i <= 16; ++i) {
    omega.push_back(i);
    const double factor = noise(generator);
    sum += factor + std::log(10.0);
    value.emplace_back(0, 10 * i * std::exp(factor));
  }
  FitOptions options;
  options.component = Component::magnitude;
  options.weight = Weight::relative;  // of magnitudes: ln|model/data|
  options.constraints = {prior_of("K", {11, 0.02, true})};
  const FitResult result = fit({omega, value}, Structure("K s"), options);
  ASSERT_TRUE(result.usable()) << result.message;
  const double of_data = 16 / (result.cost / (16 - result.effective_parameters)), of_prior = 1 / (0.02 * 0.02);
  const double mean = (of_data * sum / 16 + of_prior * std::log(11.0)) / (of_data + of_prior);
  EXPECT_NEAR(std::log(result.parameters[0].value), mean, 1e-5);
  EXPECT_NEAR(result.parameters[0].standard_error / result.parameters[0].widening,
              result.parameters[0].value / std::sqrt(of_data + of_prior), 1e-3 * 0.2);
}

// Between a parameter that is fixed and one of which nothing is known.
TEST(Priors, CountInCriteriaByWhatTheyLeaveToTheData) {
  std::mt19937_64 generator(3);
  const FrequencyResponseData data = line(2, 1, generator);
  const auto fitted = [&](std::vector<ParameterConstraint> constraints) {
    FitOptions options = plain();
    options.constraints = std::move(constraints);
    return fit(data, Structure("A + B s"), options);
  };
  const FitResult open = fitted({}), held = fitted({{"A", 2.05, {}, {}, {}}});
  const FitResult vague = fitted({prior_of("A", {2.05, 1e3, false})});
  const FitResult sharp = fitted({prior_of("A", {2.05, 1e-5, false})});
  // Shares of 1e-9 and 4e-7 of a parameter remain, worth a few units each.
  EXPECT_NEAR(vague.aicc, open.aicc, 1e-5);
  EXPECT_NEAR(vague.bic, open.bic, 1e-5);
  EXPECT_NEAR(sharp.aicc, held.aicc, 1e-4);
  EXPECT_NEAR(sharp.bic, held.bic, 1e-4);
  EXPECT_NE(sharp.message.find("little more than the prior"), std::string::npos) << sharp.message;
}

TEST(Priors, SaySoWhereTheDataContradictThem) {
  std::mt19937_64 generator(4);
  const FrequencyResponseData data = line(2, 1, generator);
  FitOptions options = plain();
  // The mean of 20 values is known to 0.022: 3 is thirty of them away, and 15 of both.
  options.constraints = {prior_of("A", {3, 0.06, false})};
  const FitResult result = fit(data, Structure("A + B s"), options);
  EXPECT_LT(result.priors[0].conflict, -5);
  EXPECT_NE(result.message.find("contradict the prior of A"), std::string::npos) << result.message;
}

// What the data cannot tell apart, R of R C s say, is told by the prior; without one it is not identified.
TEST(Priors, CompleteWhatTheDataLeaveOpen) {
  std::mt19937_64 generator(5);
  const FrequencyResponseData data = support::noisy_response("K/(1 + R C s)", {3, 2, 0.5}, 0.01, generator, 40);
  FitOptions options;
  options.component = Component::both;
  options.constraints = {prior_of("R", {2, 0.05, true})};
  const FitResult result = fit(data, Structure("K/(1 + R C s)"), options);
  ASSERT_TRUE(result.usable());
  const ParameterEstimate &r = result.parameters[1], &c = result.parameters[2];
  ASSERT_EQ(r.name, "R");
  EXPECT_NEAR(r.value, 2, 1e-3);
  EXPECT_NEAR(r.standard_error, 0.1, 1e-3);
  EXPECT_TRUE(r.identified);
  EXPECT_NEAR(c.standard_error / c.value, 0.05, 0.002);  // that of R, and 0.3 % of the data beside
  FitOptions open = options;
  open.constraints.clear();
  EXPECT_FALSE(fit(data, Structure("K/(1 + R C s)"), open).parameters[1].identified);
}

// Where truths come from the prior, intervals hold 95 % of them and conflicts are standard normal numbers.
TEST(Priors, IntervalsCoverTruthsThatComeFromThem) {
  constexpr int seeds = 300;
  int covered = 0, contradicted = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 generator(static_cast<std::uint64_t>(seed) + 5000);
    std::normal_distribution<double> normal;
    const double truth = 0.7 + 0.02 * normal(generator);
    const FrequencyResponseData data = support::noisy_response("K/(1 + (T s)^a)", {2, 0.5, truth}, 0.05, generator, 25);
    FitOptions options;
    options.component = Component::both;
    options.constraints = {prior_of("a", {0.7, 0.02, false}), {"K", {}, {}, {}, 2.0}, {"T", {}, {}, {}, 0.5}};
    options.constraints[0].start = 0.7;
    options.global_start = false;
    const FitResult result = fit(data, Structure("K/(1 + (T s)^a)"), options);
    const ParameterEstimate& a = result.parameters[2];
    ASSERT_EQ(a.name, "a");
    covered += a.ci95_lower <= truth && truth <= a.ci95_upper ? 1 : 0;
    contradicted += std::abs(result.priors[0].conflict) > 2.576 ? 1 : 0;
  }
  // 95 % and 1 % of 300, give or take four standard deviations.
  EXPECT_NEAR(covered, 285, 15);
  EXPECT_LE(contradicted, 10);
}

TEST(Priors, OfCurvesFittedTogetherMeetTheClosedForm) {
  std::mt19937_64 generator(6);
  std::vector<JointCurve> curves;
  for (const double b : {1.0, 2.0, 3.0}) curves.push_back({"b" + std::to_string(b), line(2, b, generator)});
  JointFitOptions options;
  options.fit = plain();
  options.shared = {"A"};
  options.fit.constraints = {prior_of("A", {2.05, 0.02, false}), prior_of("B", {2, 0.05, false})};
  const JointFitResult result = joint_fit(curves, Structure("A + B s"), options);
  ASSERT_TRUE(result.usable()) << result.message;
  double square = 0;  // of omega
  for (int i = 1; i <= 20; ++i) square += 0.01 * i * i;
  double sum = 0, weight = 0;
  const double scale = result.cost / (120 - result.effective_parameters);
  for (std::size_t c = 0; c < 3; ++c) {
    const double variance = scale * std::pow(result.curves[c].noise, 2);
    sum += 20 * mean_of_real_part(*curves[c].response()) / variance;
    weight += 20 / variance;
    double product = 0;
    for (std::size_t i = 0; i < 20; ++i)
      product += curves[c].response()->omega()[i] * curves[c].response()->value()[i].imag();
    const double precision = square / variance + 1 / 0.0025;
    const ParameterEstimate& b = result.curves[c].parameters[1];
    EXPECT_NEAR(b.value, (product / variance + 2 / 0.0025) / precision, 1e-4);
    EXPECT_NEAR(b.standard_error / b.widening, 1 / std::sqrt(precision), 1e-4 * 0.05);
    ASSERT_EQ(result.curves[c].priors.size(), 1u);
  }
  const double precision = weight + 1 / 0.0004;
  EXPECT_NEAR(result.shared[0].value, (sum + 2.05 / 0.0004) / precision, 1e-5);
  EXPECT_NEAR(result.shared[0].standard_error / result.shared[0].widening, 1 / std::sqrt(precision), 1e-4 * 0.02);
  ASSERT_EQ(result.priors.size(), 1u);
  // Parameters the data tell: what they say of each, over what is known of it.
  double told = weight / precision;
  for (std::size_t c = 0; c < 3; ++c) {
    const double of_data = square / (scale * std::pow(result.curves[c].noise, 2));
    told += of_data / (of_data + 1 / 0.0025);
  }
  EXPECT_NEAR(result.effective_parameters, told, 1e-3);
  // The first and the third curve contradict a prior of 2 for what is 1 and 3 in them.
  EXPECT_GT(std::abs(result.curves[0].priors[0].conflict), 5);
  EXPECT_GT(std::abs(result.curves[2].priors[0].conflict), 5);
}

/// Output K u of an input that rises in 24 even steps, with noise: K by itself is the mean of y/u with weights u^2.
TimeResponseData amplified(double gain, double noise_deviation, std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, noise_deviation);
  std::vector<double> time, input, output;
  for (int i = 0; i < 24; ++i) {
    time.push_back(0.5 * i);
    input.push_back(1 + 0.25 * i);
    output.push_back(gain * input.back() + noise(generator));
  }
  return {time, input, output};
}

// A straight line y = c + K u with normal noise: with c at rest known or estimated the posterior of K is known.
TEST(Priors, OverTimeMeetTheClosedFormOfALine) {
  std::mt19937_64 generator(8);
  const TimeResponseData data = amplified(2, 0.3, generator);
  const ParameterPrior prior{2.1, 0.03, false};
  for (const bool is_offset_known : {true, false}) {
    TimeFitOptions options;
    if (is_offset_known) options.offset = 0;
    options.constraints = {prior_of("K", prior)};
    const FitResult result = fit(data, Structure("K"), options);
    ASSERT_TRUE(result.usable()) << result.message;
    double middle = 0, square = 0, product = 0;
    if (!is_offset_known)
      for (const double u : data.input()) middle += u / 24;
    for (std::size_t i = 0; i < 24; ++i) {
      square += std::pow(data.input()[i] - middle, 2);
      product += (data.input()[i] - middle) * data.output()[i];
    }
    const double variance = result.cost / (24 - result.effective_parameters);
    const double of_data = square / variance, of_prior = 1 / (0.03 * 0.03);
    const double mean = (product / variance + of_prior * 2.1) / (of_data + of_prior);
    const ParameterEstimate& k = result.parameters[0];
    // The noise is taken as settled at four digits, and its share in the estimate is less than one.
    EXPECT_NEAR(k.value, mean, 1e-4 * std::abs(mean - 2.1));
    EXPECT_NEAR(k.standard_error / k.widening, 1 / std::sqrt(of_data + of_prior), 2e-4 * 0.03);
    EXPECT_NEAR(result.effective_parameters, (is_offset_known ? 0 : 1) + of_data / (of_data + of_prior), 1e-3);
    ASSERT_EQ(result.priors.size(), 1u);
    EXPECT_NEAR(result.priors[0].distance, (mean - 2.1) / 0.03, 1e-3);
    // The profile follows a parabola here.
    const ProfileInterval profile = profile_interval(data, options, result, "K");
    const double half = student_t_95(24 - result.effective_parameters) * k.standard_error;
    EXPECT_NEAR(profile.lower, mean - half, 1e-3 * half);
    EXPECT_NEAR(profile.upper, mean + half, 1e-3 * half);
  }
}

// R C acts as one time constant on a step response too.
TEST(Priors, OverTimeCompleteWhatTheDataLeaveOpen) {
  std::mt19937_64 generator(9);
  std::normal_distribution<double> noise(0, 0.005);
  std::vector<double> time, input(80, 1.0), output;
  for (int i = 0; i < 80; ++i) {
    time.push_back(0.1 * i);
    output.push_back(3 * (1 - std::exp(-time.back() / (2 * 0.5))) + noise(generator));
  }
  const TimeResponseData data(time, input, output);
  TimeFitOptions options;
  options.offset = 0;
  options.constraints = {prior_of("R", {2, 0.05, true})};
  const Structure structure("K/(1 + R C s)");
  const FitResult result = fit(data, structure, options);
  ASSERT_TRUE(result.usable()) << result.message;
  const ParameterEstimate &r = result.parameters[1], &c = result.parameters[2];
  ASSERT_EQ(r.name, "R");
  EXPECT_NEAR(r.value, 2, 1e-3);
  EXPECT_NEAR(r.standard_error, 0.1, 1e-3);
  EXPECT_TRUE(r.identified);
  // R C itself is known to 0.2 %: the information of 80 samples of 3 (1 - exp(-t)) on its logarithm is 22/0.005^2.
  EXPECT_NEAR(c.standard_error / c.value, 0.05, 0.002);
  options.constraints.clear();
  EXPECT_FALSE(fit(data, structure, options).parameters[1].identified);
}

// Where truths come from the prior, intervals over time hold 95 % of them too.
TEST(Priors, OverTimeIntervalsCoverTruthsThatComeFromThem) {
  constexpr int seeds = 300;
  int covered = 0, contradicted = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 generator(static_cast<std::uint64_t>(seed) + 7000);
    std::normal_distribution<double> normal;
    const double truth = 2 + 0.1 * normal(generator);
    std::vector<double> time, input(30, 1.0), output;
    for (int i = 0; i < 30; ++i) {
      time.push_back(0.4 * i);
      output.push_back(1.5 * (1 - std::exp(-time.back() / truth)) + 0.05 * normal(generator));
    }
    TimeFitOptions options;
    options.offset = 0;
    options.constraints = {{"K", {}, {}, {}, 1.5}, prior_of("T", {2, 0.1, false})};
    options.constraints[1].start = 2;
    options.global_start = false;
    const FitResult result = fit(TimeResponseData(time, input, output), Structure("K/(T s + 1)"), options);
    const ParameterEstimate& t = result.parameters[1];
    ASSERT_EQ(t.name, "T");
    covered += t.ci95_lower <= truth && truth <= t.ci95_upper ? 1 : 0;
    contradicted += std::abs(result.priors[0].conflict) > 2.576 ? 1 : 0;
  }
  // 95 % and 1 % of 300, give or take four standard deviations.
  EXPECT_NEAR(covered, 285, 15);
  EXPECT_LE(contradicted, 10);
}

// Presets leave the sign of a gain open; a prior of its logarithm says that it is positive.
TEST(Priors, OfALogarithmTellTheSignThatAModelLeavesOpen) {
  std::mt19937_64 generator(10);
  FitOptions options = plain();
  ParameterConstraint open = prior_of("A", {2, 0.05, true});
  open.lower = -std::numeric_limits<double>::infinity();
  options.constraints = {open};
  const FitResult result = fit(line(2, 1, generator), Structure("A + B s"), options);
  ASSERT_TRUE(result.usable()) << result.message;
  EXPECT_EQ(result.parameters[0].lower_limit, 0);
  EXPECT_NEAR(result.parameters[0].value, 2, 4 * 0.1 / std::sqrt(20.0));  // four standard errors of the data
}

TEST(Priors, AreRefusedWhereTheyMeanNothing) {
  std::mt19937_64 generator(7);
  const FrequencyResponseData data = line(2, 1, generator);
  const auto refused = [&](std::vector<ParameterConstraint> constraints, const char* text) {
    FitOptions options = plain();
    options.constraints = std::move(constraints);
    support::expect_invalid_argument([&] { static_cast<void>(fit(data, Structure("A + B s"), options)); }, {text});
  };
  refused({prior_of("A", {2, 0, false})}, "deviation must be positive");
  refused({prior_of("A", {-2, 0.1, true})}, "positive value");
  ParameterConstraint both = prior_of("A", {2, 0.1, false});
  both.fixed = 2;
  refused({both}, "is fixed");
  ParameterConstraint signed_one = prior_of("A", {2, 0.1, true});
  signed_one.lower = -5;
  refused({signed_one}, "may be negative");
}

}  // namespace
