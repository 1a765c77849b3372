// SPDX-License-Identifier: BSD-3-Clause
// Joint fits of records over time, and of these with frequency responses.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "frac/identification/joint_fit.hpp"
#include "frac/model/frequency_response_data.hpp"
#include "support/exact_output.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/noisy_response.hpp"

namespace {

using namespace frac;

constexpr const char* lag = "K/(1 + (T s)^a)";

JointFitOptions sharing(std::vector<std::string> names) {
  JointFitOptions options;
  options.shared = std::move(names);
  return options;
}

/// offset + K u of an input that rises in even steps, with noise.
TimeResponseData amplified(double gain, double offset, double deviation, std::size_t samples,
                           std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, deviation);
  std::vector<double> time, input, output;
  for (std::size_t i = 0; i < samples; ++i) {
    time.push_back(0.5 * static_cast<double>(i));
    input.push_back(1 + 0.25 * static_cast<double>(i));
    output.push_back(offset + gain * input.back() + noise(generator));
  }
  return {time, input, output};
}

/// Response of K/(1 + (T s)^a) to an input that goes up and down, exact, and noise.
TimeResponseData record_of(double gain, double time_constant, double order, double deviation,
                           std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, deviation);
  std::vector<double> time, input;
  for (int i = 0; i < 60; ++i) {
    time.push_back(0.1 * i);
    input.push_back(i < 30 ? 1 : -0.5);
  }
  const FractionalTransferFunction model({{gain, 0}}, {{1, 0}, {std::pow(time_constant, order), order}});
  std::vector<double> output = support::exact_output(model, time, input, Hold::zero_order);
  for (double& each : output) each += noise(generator);
  return {time, input, output};
}

// Lines y = c + K u of one slope and different c: the slope of all is the mean of their slopes by their precision, the
// noise of each and the degrees of freedom left by the slope and every c.
TEST(JointRecords, MeetTheClosedFormOfLinesOfOneSlope) {
  std::mt19937_64 generator(1);
  std::vector<JointCurve> curves;
  for (const std::size_t samples : {20U, 30U, 40U})
    curves.push_back(
        {"of " + std::to_string(samples),
         amplified(2, static_cast<double>(samples), 0.01 * static_cast<double>(samples), samples, generator)});
  const JointFitResult result = joint_fit(curves, Structure("K"), sharing({"K"}));
  ASSERT_TRUE(result.usable()) << result.message;
  EXPECT_EQ(result.residuals, 90U);
  EXPECT_EQ(result.free_parameters, 4U);
  double weighted = 0, precision = 0;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const TimeResponseData& data = *curves[c].record();
    double middle = 0, square = 0, product = 0;
    for (const double u : data.input()) middle += u / static_cast<double>(data.size());
    for (std::size_t i = 0; i < data.size(); ++i) {
      square += std::pow(data.input()[i] - middle, 2);
      product += (data.input()[i] - middle) * data.output()[i];
    }
    const double variance = std::pow(result.curves[c].noise, 2);
    weighted += product / variance;
    precision += square / variance;
  }
  EXPECT_NEAR(result.shared[0].value, weighted / precision, 1e-10);  // of a linear problem, to rounding
  const double scale = result.cost / (90 - 4);
  EXPECT_NEAR(result.shared[0].standard_error / result.shared[0].widening, std::sqrt(scale / precision),
              1e-8 * std::sqrt(scale / precision));
}

/// offset + 2 u of an input that wanders, in noise of first order of that standard deviation and correlation.
TimeResponseData amplified_in_slow_noise(double offset, double deviation, double correlation,
                                         std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  std::vector<double> time, input, output;
  double noise = normal(generator);
  for (int i = 0; i < 200; ++i) {
    time.push_back(0.5 * i);
    input.push_back(std::sin(0.11 * i) + (i % 50 < 25 ? 1 : -1));
    output.push_back(offset + 2 * input.back() + deviation * noise);
    noise = correlation * noise + std::sqrt(1 - correlation * correlation) * normal(generator);
  }
  return {time, input, output};
}

/// Slope of lines of one slope, each with an offset of its own, by weighted least squares in noise of first order, the
/// inverse covariance of which is tridiagonal: 1 at both ends and 1 + r^2 between them, -r beside, over 1 - r^2.
struct Slope {
  double value, standard_deviation;
};
Slope slope_of(const std::vector<JointCurve>& curves, const std::vector<double>& deviation,
               const std::vector<double>& correlation) {
  double weighted = 0, precision = 0;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const TimeResponseData& data = *curves[c].record();
    const auto n = static_cast<Eigen::Index>(data.size());
    const double r = correlation[c];
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      inverse(i, i) = i == 0 || i == n - 1 ? 1 : 1 + r * r;
      if (i > 0) inverse(i, i - 1) = inverse(i - 1, i) = -r;
    }
    inverse /= (1 - r * r) * deviation[c] * deviation[c];
    const Eigen::Map<const Eigen::VectorXd> u(data.input().data(), n), y(data.output().data(), n);
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(n);
    // Without the share that the offset takes.
    const Eigen::VectorXd alone = inverse * u - inverse * one * (one.dot(inverse * u) / one.dot(inverse * one));
    weighted += alone.dot(y);
    precision += alone.dot(u);
  }
  return {weighted / precision, 1 / std::sqrt(precision)};
}

std::vector<JointCurve> three_in_slow_noise(std::mt19937_64& generator, const std::vector<double>& deviation,
                                            const std::vector<double>& correlation) {
  std::vector<JointCurve> curves;
  for (std::size_t c = 0; c < deviation.size(); ++c)
    curves.push_back({"of " + std::to_string(c),
                      amplified_in_slow_noise(static_cast<double>(c), deviation[c], correlation[c], generator)});
  return curves;
}

// The slope is linear in the data, so that it is the closed form to rounding.
TEST(JointRecords, InNoiseOfToldCorrelationMeetTheClosedForm) {
  std::mt19937_64 generator(11);
  const std::vector<double> correlation(3, 0.8);
  const auto curves = three_in_slow_noise(generator, {0.1, 0.2, 0.4}, correlation);
  JointFitOptions options = sharing({"K"});
  options.over_time.noise_correlation = 0.8;
  const JointFitResult result = joint_fit(curves, Structure("K"), options);
  ASSERT_TRUE(result.usable()) << result.message;
  std::vector<double> deviation;
  for (const auto& each : result.curves) deviation.push_back(each.noise);
  EXPECT_NEAR(result.shared[0].value, slope_of(curves, deviation, correlation).value, 1e-9);
}

// 200 draws of three records of other noise each.  The estimate errs by what weighted least squares with the true
// covariance err by, but for what the estimated correlations and levels add: r is known to sqrt((1 - r^2)/200) = .04,
// by which the standard error of one record is off by 1/(1 - r^2) .04 = 12 % at r = .8, and that of three by 7 %.  The
// mean square of 200 errors over the true deviation is 1 +- sqrt(2/200) = .1; four of these, and .1 for the noise of
// the weights.  Intervals that hold 95 % hold 1.3 % fewer where they are 7 % off either way, and 200 draws spread it by
// 1.6 %: 178 and 199 are three of these away from .937 and .95.
TEST(JointRecords, IntervalsInSlowNoiseHoldTheTruth) {
  std::mt19937_64 generator(12);
  const std::vector<double> deviation{0.1, 0.2, 0.4}, correlation{0.5, 0.8, 0.8};
  JointFitOptions options = sharing({"K"});
  options.over_time.noise = RecordNoise::coloured;
  options.fit.global_start = false;  // one optimum, as the problem is linear
  options.fit.constraints = {{"K", {}, {}, {}, 1}};
  int held = 0;
  double square = 0;
  constexpr int draws = 200;
  for (int draw = 0; draw < draws; ++draw) {
    const auto curves = three_in_slow_noise(generator, deviation, correlation);
    const JointFitResult result = joint_fit(curves, Structure("K"), options);
    ASSERT_TRUE(result.usable()) << result.message;
    const ParameterEstimate& slope = result.shared[0];
    held += slope.ci95_lower <= 2 && 2 <= slope.ci95_upper ? 1 : 0;
    square += std::pow((slope.value - 2) / slope_of(curves, deviation, correlation).standard_deviation, 2) / draws;
  }
  EXPECT_NEAR(square, 1, 0.5);
  EXPECT_GE(held, 178) << square;
  EXPECT_LE(held, 199) << square;
}

TEST(JointRecords, RecoverWhatMadeAnExactSpectrumAndAnExactRecord) {
  std::mt19937_64 generator(2);
  const std::vector<JointCurve> curves{{"spectrum", support::noisy_response(lag, {3, 0.7, 0.8}, 0, generator, 30)},
                                       {"record", record_of(2, 0.7, 0.8, 0, generator)}};
  const JointFitResult result = joint_fit(curves, Structure(lag), sharing({"T", "a"}));
  ASSERT_TRUE(result.usable()) << result.message;
  // Records are exact and simulated to 1e-13 of their size; searches end where the cost is rounding.
  EXPECT_NEAR(result.shared[0].value, 0.7, 1e-7);
  EXPECT_NEAR(result.shared[1].value, 0.8, 1e-7);
  EXPECT_NEAR(result.curves[0].parameters[0].value, 3, 1e-6);
  EXPECT_NEAR(result.curves[1].parameters[0].value, 2, 1e-6);
}

// What a spectrum and a record know of common parameters adds up: J'J/s^2 of their fits alone, and the estimates by
// them.  Noise so small that all is linear; central differences are right to the square of their step.
TEST(JointRecords, ASpectrumAndARecordTellTogetherWhatTheyTellAlone) {
  std::mt19937_64 generator(3);
  std::vector<JointCurve> curves{{"spectrum", support::noisy_response(lag, {2, 0.7, 0.8}, 0.002, generator, 40)},
                                 {"record", record_of(2, 0.7, 0.8, 0.004, generator)}};
  JointFitOptions options = sharing({"K", "T", "a"});
  options.fit.weight = Weight::relative;
  options.over_time.offset = 0;
  const JointFitResult joint = joint_fit(curves, Structure(lag), options);
  ASSERT_TRUE(joint.usable()) << joint.message;
  TimeFitOptions over_time;
  over_time.offset = 0;
  const FitResult of_spectrum = fit(*curves[0].response(), Structure(lag), options.fit);
  const FitResult of_record = fit(*curves[1].record(), Structure(lag), over_time);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
  const auto add = [&](const FitResult& alone,
                       const std::function<Eigen::VectorXd(const std::vector<double>&)>& model) {
    std::vector<double> value;
    for (const ParameterEstimate& each : alone.parameters) value.push_back(each.value);
    Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(alone.residuals), 3);
    for (std::size_t k = 0; k < 3; ++k) {
      constexpr double step = 1e-4;
      std::vector<double> above = value, below = value;
      above[k] += step;
      below[k] -= step;
      jacobian.col(static_cast<Eigen::Index>(k)) = (model(above) - model(below)) / (2 * step);
    }
    const double variance = alone.cost / (static_cast<double>(alone.residuals) - 3);
    const Eigen::Matrix3d known = jacobian.transpose() * jacobian / variance;
    information += known;
    weighted += known * Eigen::Map<const Eigen::Vector3d>(value.data());
  };
  add(of_spectrum, [&](const std::vector<double>& value) {
    const auto& data = *curves[0].response();
    Eigen::VectorXd weighed(2 * static_cast<Eigen::Index>(data.size()));
    for (std::size_t i = 0; i < data.size(); ++i) {
      const auto each = Structure(lag).response(value, data.omega()[i]) / std::abs(data.value()[i]);
      weighed.segment<2>(2 * static_cast<Eigen::Index>(i)) << each.real(), each.imag();
    }
    return weighed;
  });
  add(of_record, [&](const std::vector<double>& value) {
    std::mt19937_64 none;
    const std::vector<double> output = record_of(value[0], value[1], value[2], 0, none).output();
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(output.data(), std::ssize(output)));
  });
  const Eigen::Matrix3d covariance = information.inverse();
  const Eigen::Vector3d value = covariance * weighted;
  for (int i = 0; i < 3; ++i) {
    const ParameterEstimate& each = joint.shared[static_cast<std::size_t>(i)];
    const double error = std::sqrt(covariance(i, i));
    // Noise levels are those of the fits alone; the joint fit moves by a second-order term of .1 % of its error, and
    // takes one scale for both, which chance moves by 1/sqrt(2 x 130) = 6 %.
    EXPECT_NEAR(each.value, value[i], 0.02 * error) << each.name;
    EXPECT_NEAR(each.standard_error / each.widening, error, 0.2 * error) << each.name;
  }
}

TEST(JointRecords, IntervalsCoverTheTruth) {
  constexpr int seeds = 60;
  int covered = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 generator(static_cast<std::uint64_t>(seed) + 400);
    const std::vector<JointCurve> curves{{"spectrum", support::noisy_response(lag, {2, 0.7, 0.8}, 0.02, generator, 25)},
                                         {"record", record_of(1, 0.7, 0.8, 0.02, generator)}};
    const JointFitResult result = joint_fit(curves, Structure(lag), sharing({"T", "a"}));
    ASSERT_TRUE(result.usable()) << result.message;
    for (const ParameterEstimate& each : result.shared) {
      const double truth = each.name == "T" ? 0.7 : 0.8;
      covered += each.ci95_lower <= truth && truth <= each.ci95_upper ? 1 : 0;
    }
  }
  // 95 % of 120, give or take four standard deviations of pairs that always agree: 4 sqrt(.05 .95 60) 2.
  EXPECT_NEAR(covered, 114, 14);
}

// An exact spectrum knows the parameters, so that a record which shares them may be doubted by chance alone: the F test
// is then that of the record with its parameters known.
TEST(JointRecords, AnExactSpectrumMakesNoDoubtOfARecord) {
  constexpr int seeds = 100;
  int doubted = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 generator(static_cast<std::uint64_t>(seed) + 900);
    const std::vector<JointCurve> curves{{"spectrum", support::noisy_response(lag, {2, 0.7, 0.8}, 0, generator, 30)},
                                         {"record", record_of(2, 0.7, 0.8, 0.02, generator)}};
    const JointFitResult result = joint_fit(curves, Structure(lag), sharing({"K", "T", "a"}));
    ASSERT_TRUE(result.usable()) << result.message;
    doubted += result.sharing_p_value < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(doubted, 5, 9);  // 5 %, give or take four standard deviations
}

TEST(JointRecords, AreRefusedWhereTheyMeanNothing) {
  std::mt19937_64 generator(4);
  const std::vector<JointCurve> curves{{"spectrum", support::noisy_response(lag, {3, 0.7, 0.8}, 0, generator, 30)},
                                       {"record", record_of(2, 0.7, 0.8, 0, generator)}};
  JointFitOptions shifted = sharing({"K", "T", "a"});
  shifted.shift = CurveShift{};
  support::expect_invalid_argument([&] { static_cast<void>(joint_fit(curves, Structure(lag), shifted)); },
                                   {"'record'", "over time"});
  JointFitOptions weighed = sharing({"K", "T", "a"});
  weighed.fit.weight = Weight::given;
  const std::vector<JointCurve> records{curves[1], curves[1]};
  support::expect_invalid_argument([&] { static_cast<void>(joint_fit(records, Structure(lag), weighed)); },
                                   {"'record'", "sigma"});
}

}  // namespace
