// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/joint_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "identification/joint/noise_levels.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/noisy_response.hpp"

namespace {

using namespace frac;

constexpr const char* lag = "K/(1 + (T s)^a)";

/// Lags of the same T and a, with gains 1, 2, 3 ... and relative noise that differs from curve to curve by up to four.
std::vector<JointCurve> lags(std::size_t count, int points, double noise, std::mt19937_64& generator) {
  std::vector<JointCurve> curves;
  for (std::size_t c = 0; c < count; ++c) {
    const double gain = static_cast<double>(c) + 1, level = noise * std::pow(2.0, static_cast<double>(c % 3));
    curves.push_back(
        {"curve " + std::to_string(c), support::noisy_response(lag, {gain, 0.7, 0.8}, level, generator, points)});
  }
  return curves;
}

JointFitOptions sharing(std::vector<std::string> names) {
  JointFitOptions options;
  options.fit.component = Component::both;
  options.fit.weight = Weight::relative;
  options.shared = std::move(names);
  return options;
}

bool covers(const ParameterEstimate& estimate, double truth) {
  return estimate.ci95_lower <= truth && truth <= estimate.ci95_upper;
}

TEST(JointFit, RecoversWhatMadeExactCurves) {
  std::mt19937_64 generator(1);
  const JointFitResult result = joint_fit(lags(4, 30, 0, generator), Structure(lag), sharing({"T", "a"}));
  ASSERT_TRUE(result.usable()) << result.message;
  // The search stops where the cost no longer changes in its 14th digit: at exact data, far below these.
  EXPECT_NEAR(result.shared[0].value, 0.7, 1e-8);
  EXPECT_NEAR(result.shared[1].value, 0.8, 1e-8);
  for (std::size_t c = 0; c < 4; ++c)
    EXPECT_NEAR(result.curves[c].parameters[0].value, static_cast<double>(c) + 1, 1e-7);
}

/// Of Im(j omega A + B/(j omega)) = A omega - B/omega, linear in both, with every eighth point far off.
std::vector<JointCurve> with_outliers(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> noise(0, 0.05);
  std::vector<JointCurve> curves;
  for (const double b : {1.0, 2.0, 3.0}) {
    std::vector<double> omega;
    std::vector<std::complex<double>> value;
    for (int i = 0; i < 40; ++i) {
      omega.push_back(0.3 * std::pow(1.06, i));
      const double clean = 1.5 * omega.back() - b / omega.back();
      value.emplace_back(0, clean + noise(generator) + (i % 8 == 3 ? 1.5 : 0));
    }
    curves.push_back({"b" + std::to_string(b), FrequencyResponseData(omega, value)});
  }
  return curves;
}

// Iterated reweighting of the linear problem, which has one minimum under Huber's loss.
TEST(JointFit, MakesTheRobustLossLeast) {
  const auto curves = with_outliers(1);
  JointFitOptions options = sharing({"A"});
  options.fit.component = Component::imaginary;
  options.fit.weight = Weight::absolute;
  options.fit.loss = Loss::huber;
  options.fit.loss_scale = 0.07;
  const JointFitResult result = joint_fit(curves, Structure("A s + B/s"), options);
  ASSERT_TRUE(result.usable()) << result.message;
  Eigen::VectorXd at(4);  // A, and B of each
  at << 1, 1, 1, 1;
  double loss_cost = 0;
  for (int pass = 0; pass < 500; ++pass) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(4, 4);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(4);
    loss_cost = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < 40; ++i) {
        const double omega = curves[c].response()->omega()[i], unit = 1 / result.curves[c].noise;
        Eigen::VectorXd row = Eigen::VectorXd::Zero(4);
        row[0] = omega;
        row[static_cast<Eigen::Index>(c) + 1] = -1 / omega;
        const double rest = row.dot(at) - curves[c].response()->value()[i].imag(), x = std::abs(rest) / 0.07;
        const double weight = unit * unit * (x > 1 ? 1 / x : 1);
        normal += weight * row * row.transpose();
        right += weight * row * curves[c].response()->value()[i].imag();
        loss_cost += unit * unit * 0.0049 * (x > 1 ? 2 * x - 1 : x * x);
      }
    }
    at = normal.ldlt().solve(right);
  }
  // The search stops where the cost no longer changes in its 14th digit, which is the square of what values change by.
  EXPECT_NEAR(result.shared[0].value, at[0], 1e-6);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(result.curves[c].parameters[1].value, at[static_cast<Eigen::Index>(c) + 1], 1e-6);
  EXPECT_NEAR(result.loss_cost, loss_cost, 1e-6 * loss_cost);
}

// Fifteen outliers of thirty standard deviations, on one side.
TEST(JointFit, RobustLossLeavesOutliersWhereTheyAre) {
  int covered = 0, asked = 0, contradicted = 0;
  double plain_error = 0, robust_error = 0;
  constexpr int seeds = 40;
  for (int seed = 0; seed < seeds; ++seed) {
    const auto curves = with_outliers(static_cast<std::uint64_t>(seed) + 100);
    JointFitOptions options = sharing({"A"});
    options.fit.component = Component::imaginary;
    options.fit.weight = Weight::absolute;
    options.fit.loss = Loss::cauchy;
    const JointFitResult robust = joint_fit(curves, Structure("A s + B/s"), options);
    ASSERT_TRUE(robust.usable()) << robust.message;
    covered += covers(robust.shared[0], 1.5) ? 1 : 0;
    for (std::size_t c = 0; c < 3; ++c) covered += covers(robust.curves[c].parameters[1], static_cast<double>(c) + 1);
    asked += 4;
    contradicted += robust.sharing_p_value < 0.01 ? 1 : 0;
    options.fit.loss = Loss::none;
    const JointFitResult plain = joint_fit(curves, Structure("A s + B/s"), options);
    plain_error += plain.shared[0].standard_error;
    robust_error += robust.shared[0].standard_error;
  }
  EXPECT_GT(plain_error, 3 * robust_error);
  // 95 % of 160, less four standard deviations, and what is left of outliers on one side.
  EXPECT_GE(covered, asked * 88 / 100);
  EXPECT_LE(contradicted, 3);
}

// The errors come from block elimination; here from the inverse of the whole normal matrix, with derivatives by
// differences.  Of K, T and a each curve has the first `own` of its own.
void expect_errors_of_the_whole_normal_matrix(std::size_t own, const std::vector<std::string>& shared) {
  std::mt19937_64 generator(2);
  const auto curves = lags(3, 40, 0.01, generator);
  const JointFitResult result = joint_fit(curves, Structure(lag), sharing(shared));
  ASSERT_TRUE(result.usable());
  const auto place = [&](std::size_t curve, std::size_t parameter) {
    return static_cast<Eigen::Index>(parameter < own ? shared.size() + own * curve + parameter : parameter - own);
  };
  const auto estimate = [&](std::size_t curve, std::size_t parameter) {
    return parameter < own ? result.curves[curve].parameters[parameter] : result.shared[parameter - own];
  };
  const auto unknowns = static_cast<Eigen::Index>(shared.size() + 3 * own);
  Eigen::VectorXd values(unknowns);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t p = 0; p < 3; ++p) values[place(c, p)] = estimate(c, p).value;
  const auto residuals = [&](const Eigen::VectorXd& at) {
    Eigen::VectorXd all(3 * 80);
    Eigen::Index row = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::vector<double> parameters{at[place(c, 0)], at[place(c, 1)], at[place(c, 2)]};
      for (std::size_t i = 0; i < 40; ++i) {
        const std::complex<double> data = curves[c].response()->value()[i];
        const std::complex<double> rest =
            (Structure(lag).response(parameters, curves[c].response()->omega()[i]) - data) / std::abs(data);
        all[row++] = rest.real() / result.curves[c].noise;
        all[row++] = rest.imag() / result.curves[c].noise;
      }
    }
    return all;
  };
  Eigen::MatrixXd jacobian(240, unknowns);
  for (Eigen::Index k = 0; k < unknowns; ++k) {
    const double h = 1e-5 * values[k];
    Eigen::VectorXd up = values, down = values;
    up[k] += h;
    down[k] -= h;
    jacobian.col(k) = (residuals(up) - residuals(down)) / (2 * h);
  }
  const double cost = residuals(values).squaredNorm();
  EXPECT_NEAR(result.cost, cost, 1e-9 * cost);
  // At the minimum the gradient vanishes but for the tolerance of the search.
  EXPECT_LT((jacobian.transpose() * residuals(values)).norm(), 1e-5 * jacobian.norm() * std::sqrt(cost));
  const Eigen::MatrixXd covariance =
      cost / static_cast<double>(240 - unknowns) * (jacobian.transpose() * jacobian).inverse();
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < 3; ++p) {
      // Differences of step 1e-5 err by 1e-10; both ways square a condition of some hundreds.
      const double expected = std::sqrt(covariance(place(c, p), place(c, p)));
      EXPECT_NEAR(estimate(c, p).standard_error / estimate(c, p).widening, expected, 1e-6 * expected)
          << estimate(c, p).name;
    }
    const double both = covariance(place(c, 0), place(c, 1));
    // The widening, which differs from parameter to parameter, changes a correlation little.
    const double correlation =
        result.curves[c].covariance[0][1] / (estimate(c, 0).standard_error * estimate(c, 1).standard_error);
    EXPECT_NEAR(correlation,
                both / std::sqrt(covariance(place(c, 0), place(c, 0)) * covariance(place(c, 1), place(c, 1))), 0.25);
  }
}

TEST(JointFit, ErrorsAreThoseOfTheWholeNormalMatrix) {
  expect_errors_of_the_whole_normal_matrix(1, {"T", "a"});
}

TEST(JointFit, ErrorsOfSeveralOwnParametersAreThoseOfTheWholeNormalMatrix) {
  expect_errors_of_the_whole_normal_matrix(2, {"a"});
}

// 200 trials of five curves with three levels of noise, seeds used for nothing else.  The number of intervals that hold
// the truth is binomial; the limits are 3.3 standard deviations below 95 %, and for p values above 5 %.
TEST(JointFit, IntervalsHoldTheTruthAndCurvesThatShareAreBelieved) {
  constexpr int trials = 200;
  std::mt19937_64 generator(90210);
  double shared[2] = {0, 0}, own = 0, doubted = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const JointFitResult result = joint_fit(lags(5, 25, 0.01, generator), Structure(lag), sharing({"T", "a"}));
    shared[0] += covers(result.shared[0], 0.7);
    shared[1] += covers(result.shared[1], 0.8);
    for (std::size_t c = 0; c < 5; ++c) own += covers(result.curves[c].parameters[0], static_cast<double>(c) + 1) / 5.0;
    doubted += result.sharing_p_value < 0.05;
  }
  const double deviation = std::sqrt(0.95 * 0.05 / trials);
  RecordProperty("shared_T", std::to_string(shared[0] / trials));
  RecordProperty("shared_a", std::to_string(shared[1] / trials));
  RecordProperty("own_K", std::to_string(own / trials));
  RecordProperty("doubted", std::to_string(doubted / trials));
  EXPECT_GT(shared[0] / trials, 0.95 - 3.3 * deviation);
  EXPECT_GT(shared[1] / trials, 0.95 - 3.3 * deviation);
  EXPECT_GT(own / trials, 0.95 - 3.3 * deviation);
  EXPECT_LT(doubted / trials, 0.05 + 3.3 * deviation);
}

/// Lags whose time constant follows Arrhenius, T = T0 exp(E/(8.314 temperature)) with T(330 K) = 0.7 s, gains as above.
constexpr double energy = 3e4;
std::vector<JointCurve> arrhenius(std::size_t count, double noise, std::mt19937_64& generator) {
  std::vector<JointCurve> curves;
  for (std::size_t c = 0; c < count; ++c) {
    const double temperature = 300 + 15 * static_cast<double>(c), gain = static_cast<double>(c) + 1;
    const double time = 0.7 * std::exp(energy / 8.314 * (1 / temperature - 1 / 330.0));
    curves.push_back({"curve " + std::to_string(c),
                      support::noisy_response(lag, {gain, time, 0.8}, noise, generator, 25),
                      {{"temperature", temperature}}});
  }
  return curves;
}

TEST(JointFit, ALawRecoversWhatMadeExactCurves) {
  std::mt19937_64 generator(11);
  JointFitOptions options = sharing({"a"});
  options.laws = {"T = T0 exp(E/(8.314 temperature))"};
  const JointFitResult result = joint_fit(arrhenius(4, 0, generator), Structure(lag), options);
  ASSERT_TRUE(result.usable()) << result.message;
  ASSERT_EQ(result.shared.size(), 3U);
  EXPECT_EQ(result.shared[1].name, "T0");
  EXPECT_EQ(result.shared[2].name, "E");
  // T0 lies far outside of the temperatures: an error of E of some 1e-9 comes back as eleven times as much.
  EXPECT_NEAR(result.shared[2].value / energy, 1, 1e-6);
  EXPECT_NEAR(result.shared[1].value / (0.7 * std::exp(-energy / (8.314 * 330))), 1, 1e-5);
  EXPECT_NEAR(result.curves[2].parameters[1].value, 0.7, 1e-6);
}

// 200 trials, seeds used for nothing else; the limit is 3.3 standard deviations of the binomial below 95 %.
TEST(JointFit, IntervalsOfALawHoldTheTruth) {
  constexpr int trials = 200;
  std::mt19937_64 generator(60606);
  JointFitOptions options = sharing({"a"});
  options.laws = {"T = T0 exp(E/(8.314 temperature))"};
  double scale = 0, slope = 0, driven = 0, doubted = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const JointFitResult result = joint_fit(arrhenius(5, 0.01, generator), Structure(lag), options);
    scale += covers(result.shared[1], 0.7 * std::exp(-energy / (8.314 * 330)));
    slope += covers(result.shared[2], energy);
    driven += covers(result.curves[2].parameters[1], 0.7);
    doubted += result.sharing_p_value < 0.05;
  }
  const double deviation = std::sqrt(0.95 * 0.05 / trials);
  RecordProperty("T0", std::to_string(scale / trials));
  RecordProperty("E", std::to_string(slope / trials));
  RecordProperty("T", std::to_string(driven / trials));
  RecordProperty("doubted", std::to_string(doubted / trials));
  for (const double held : {scale, slope, driven}) EXPECT_GT(held / trials, 0.95 - 3.3 * deviation);
  EXPECT_LT(doubted / trials, 0.05 + 3.3 * deviation);
}

TEST(JointFit, ALawThatTheCurvesDoNotFollowIsTold) {
  std::mt19937_64 generator(12);
  auto curves = arrhenius(4, 0.01, generator);
  curves[1].covariates[0].second += 20;
  JointFitOptions options = sharing({"a"});
  options.laws = {"T = T0 exp(E/(8.314 temperature))"};
  EXPECT_LT(joint_fit(curves, Structure(lag), options).sharing_p_value, 1e-6);
}

TEST(JointFit, SaysWhatIsNoLaw) {
  std::mt19937_64 generator(13);
  const auto curves = arrhenius(3, 0.01, generator);
  const auto refused = [&](const std::string& law, const std::vector<std::string>& parts) {
    JointFitOptions options = sharing({"a"});
    options.laws = {law};
    support::expect_invalid_argument([&] { return joint_fit(curves, Structure(lag), options); }, parts);
  };
  refused("T", {"NAME = FORMULA"});
  refused("b = b0 temperature", {"'b'", "no parameter"});
  refused("a = a0 temperature", {"'a'", "shared"});
  refused("T = T0 load", {"nothing in it is known", "known are temperature"});
  refused("T = K temperature", {"'K'", "parameter of the model"});
  auto silent = curves;
  silent[1].covariates.clear();
  JointFitOptions options = sharing({"a"});
  options.laws = {"T = T0 temperature"};
  support::expect_invalid_argument([&] { return joint_fit(silent, Structure(lag), options); },
                                   {"curve 1", "'temperature'"});
}

TEST(JointFit, CurvesThatDoNotShareAreTold) {
  std::mt19937_64 generator(3);
  auto curves = lags(3, 40, 0.01, generator);
  curves.push_back({"other", support::noisy_response(lag, {1, 0.7, 0.85}, 0.01, generator, 40)});
  const JointFitResult result = joint_fit(curves, Structure(lag), sharing({"T", "a"}));
  EXPECT_LT(result.sharing_p_value, 1e-6);
  EXPECT_NE(result.message.find("separate values"), std::string::npos) << result.message;
  EXPECT_GT(result.curves[3].rms, 1.5 * result.curves[3].rms_alone);
}

// One point tells two residuals, fewer than the parameters, but the other curves know all but its gain.
TEST(JointFit, ACurveOfOnePointGetsItsGain) {
  std::mt19937_64 generator(4);
  auto curves = lags(3, 40, 0.001, generator);
  curves.push_back(
      {"short", FrequencyResponseData({1.0}, {Structure(lag).response(std::vector<double>{5, 0.7, 0.8}, 1.0)})});
  const JointFitResult result = joint_fit(curves, Structure(lag), sharing({"T", "a"}));
  ASSERT_TRUE(result.usable()) << result.message;
  const ParameterEstimate& gain = result.curves[3].parameters[0];
  EXPECT_TRUE(gain.identified);
  EXPECT_TRUE(covers(gain, 5)) << gain.ci95_lower << " " << gain.ci95_upper;
  EXPECT_TRUE(std::isnan(result.curves[3].rms_alone));
}

TEST(JointFit, DoesNotDependOnThreads) {
  std::mt19937_64 generator(5);
  const auto curves = lags(6, 20, 0.01, generator);
  JointFitOptions options = sharing({"T", "a"});
  options.threads = 1;
  const JointFitResult one = joint_fit(curves, Structure(lag), options);
  options.threads = 3;
  const JointFitResult three = joint_fit(curves, Structure(lag), options);
  EXPECT_EQ(one.cost, three.cost);
  EXPECT_EQ(one.shared[0].value, three.shared[0].value);
  EXPECT_EQ(one.shared[0].standard_error, three.shared[0].standard_error);
}

TEST(JointFit, SaysWhatItCannotTake) {
  std::mt19937_64 generator(6);
  const auto curves = lags(2, 20, 0.01, generator);
  const auto refused = [&](const JointFitOptions& options, const std::vector<std::string>& parts) {
    support::expect_invalid_argument([&] { return joint_fit(curves, Structure(lag), options); }, parts);
  };
  refused(sharing({}), {"no parameter is shared"});
  refused(sharing({"T", "T"}), {"'T'", "twice"});
  refused(sharing({"b"}), {"b"});
  JointFitOptions fixed = sharing({"T"});
  fixed.fit.constraints.push_back({"T", 0.7, {}, {}, {}});
  refused(fixed, {"'T'", "fixed"});
  support::expect_invalid_argument([&] { return joint_fit({}, Structure(lag), sharing({"T"})); }, {"no curve"});
}

// Spreads as chance makes them with ten degrees of freedom say nothing against one common variance; factors of a
// hundred do; what is not told gets the common level.
TEST(ModeratedVariances, FollowTheDataAsFarAsTheyDiffer) {
  using detail::moderated_variances;
  const auto alike = moderated_variances(std::vector<detail::CurveVariance>{{1.1, 10}, {0.9, 10}, {1.0, 10}, {0, 0}});
  for (const double each : alike) EXPECT_EQ(each, alike.front());
  EXPECT_NEAR(alike.front(), 1.1, 0.1);  // ln of a variance of ten degrees is too low by 0.1 on average
  const auto apart = moderated_variances(std::vector<detail::CurveVariance>{{1e-4, 100}, {1, 100}, {1e4, 100}});
  EXPECT_NEAR(apart[0] / 1e-4, 1, 0.1);
  EXPECT_NEAR(apart[2] / 1e4, 1, 0.1);
  EXPECT_EQ(moderated_variances(std::vector<detail::CurveVariance>{{0, 0}, {0, 0}}), (std::vector<double>{1, 1}));
}

}  // namespace
