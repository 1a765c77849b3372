// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/uncertainty.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "frac/identification/derived.hpp"
#include "identification/statistics/smooth_error.hpp"
#include "special/distributions.hpp"
#include "support/both_parts.hpp"
#include "support/coverage.hpp"
#include "support/noisy_response.hpp"
#include "support/random.hpp"
#include "support/validity_cases.hpp"

namespace {

using frac::Component;
using support::both_parts;
using support::noisy_response;

std::vector<double> grid() {
  return support::four_decades(60);
}

// Where the model is linear in its parameter the profile is a parabola and both intervals are the same; the search
// stops at 1e-6 relative.
TEST(ProfileInterval, EqualsTheCurvatureIntervalOfALinearModel) {
  const auto data = noisy_response("K/(0.5 s^0.6 + 1)", {2}, 0.02, 1);
  const frac::FitResult result = frac::fit(data, frac::Structure("K/(0.5 s^0.6 + 1)"), both_parts());
  const auto interval = frac::profile_interval(data, both_parts(), result, "K");
  EXPECT_NEAR(interval.lower, result.parameters[0].ci95_lower, 1e-5);
  EXPECT_NEAR(interval.upper, result.parameters[0].ci95_upper, 1e-5);
  EXPECT_FALSE(interval.better_minimum_found);
}

// At 1 % noise the lag is linear within its uncertainty to some per cent: third-order terms are of the size of the
// relative standard errors (below 5 %).
TEST(ProfileInterval, IsNearTheCurvatureIntervalAtSmallNoise) {
  const auto data = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 2);
  const frac::FitResult result = frac::fit(data, frac::Structure("K/(T s^a + 1)"), both_parts());
  for (const auto& estimate : result.parameters) {
    const auto interval = frac::profile_interval(data, both_parts(), result, estimate.name);
    const double half_width = estimate.ci95_upper - estimate.value;
    EXPECT_NEAR(interval.lower, estimate.ci95_lower, 0.1 * half_width) << estimate.name;
    EXPECT_NEAR(interval.upper, estimate.ci95_upper, 0.1 * half_width) << estimate.name;
  }
}

// A second arc three decades above the data: its resistance is bounded on one side only.
TEST(ProfileInterval, IsOpenWhereTheDataSetNoLimit) {
  const frac::Structure structure("K/(T s + 1)");
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal(0, 0.02);
  for (int i = 0; i < 40; ++i) {
    omega.push_back(std::pow(10.0, i / 39.0));
    const std::complex<double> exact = structure.response(std::vector<double>{2, 1e-4}, omega.back());
    const double re = normal(generator), im = normal(generator);
    value.push_back(exact + 2.0 * std::complex<double>(re, im));
  }
  const frac::FrequencyResponseData data(omega, value);
  const frac::FitResult result = frac::fit(data, structure, both_parts());
  const auto interval = frac::profile_interval(data, both_parts(), result, "T");
  EXPECT_EQ(interval.lower, -std::numeric_limits<double>::infinity());
  EXPECT_LT(interval.upper, 0.1);
  EXPECT_GT(interval.upper, 1e-4);
}

// An end is where the least cost with the parameter held there is 1 + t^2/(n - k) times the minimum, as a fit of its
// own finds it; with the model far from linear (5 % noise, the imaginary part alone), so that nothing is symmetric. An
// end to 1e-6 of its distance leaves the rise of the cost, 2 % of it, to 4e-8; t = 1.972 for 196 degrees of freedom.
TEST(ProfileInterval, EndsWhereTheCostIsThatOfItsDefinition) {
  std::mt19937_64 generator(2026);
  const frac::Structure structure("K/(1 + (T s)^a)^b");
  const auto data = noisy_response("K/(1 + (T s)^a)^b", {3, 0.5, 0.8, 0.45}, 0.05, generator, 200);
  frac::FitOptions options;
  options.component = Component::imaginary;
  options.weight = frac::Weight::smoothed_relative;
  const frac::FitResult result = frac::fit(data, structure, options);
  for (const auto& estimate : result.parameters) {
    const double limit = result.cost * (1 + std::pow(1.972141 * estimate.widening, 2) / 196);
    const auto interval = frac::profile_interval(data, options, result, estimate.name);
    EXPECT_FALSE(interval.better_minimum_found);
    for (const double end : {interval.lower, interval.upper}) {
      ASSERT_TRUE(std::isfinite(end)) << estimate.name;
      frac::FitOptions held = options;
      held.constraints = {{estimate.name, end, {}, {}, {}}};
      EXPECT_NEAR(frac::fit(data, structure, held).cost / limit, 1, 1e-6) << estimate.name << " = " << end;
    }
  }
}

// An arc that the data do not have leaves valleys so bent that solves of the other parameters stick in one leap, here
// at 0.4 of what the curvature says for Tx.  No end that is said to follow the cost lies where a fit of its own, with
// the parameter held there, leaves less than nine tenths of the distance to the limit.
TEST(ProfileInterval, DoesNotEndWhereTheSearchOfTheOthersSticks) {
  support::Random random(336 * 9000011ULL + 3);
  (void)random.unit();
  const double noise = random.log_uniform(0.003, 0.05);
  const int per_decade = 3 + static_cast<int>(random.below(6));
  const auto kind = static_cast<support::NoiseKind>(random.below(3));
  support::Sweep sweep = support::sweep(support::impedance_models()[5], per_decade, kind, noise, random);
  support::add_noise(sweep, random);
  const frac::Structure structure("R0 + 1/(Q s^n) + Rx/(1 + (Tx s)^ax)");
  frac::FitOptions options = both_parts();
  options.weight = frac::Weight::relative;  // of which costs are comparable, where a learned floor is each fit's own
  const frac::FitResult result = frac::fit(sweep.data(), structure, options);
  const double degrees = 2 * static_cast<double>(sweep.omega.size()) - static_cast<double>(result.parameters.size());
  const double t = frac::detail::student_t_quantile(0.975, degrees);
  int wide = 0;
  for (const auto& estimate : result.parameters) {
    wide += estimate.ci95_upper - estimate.ci95_lower > 0.2 * std::abs(estimate.value);
    if (estimate.interval != frac::IntervalKind::profile) continue;
    for (const double end : {estimate.ci95_lower, estimate.ci95_upper}) {
      frac::FitOptions held = options;
      held.constraints = {{estimate.name, end, {}, {}, {}}};
      const double rise = std::sqrt((frac::fit(sweep.data(), structure, held).cost / result.cost - 1) * degrees);
      EXPECT_GT(rise, 0.9 * t * estimate.widening) << estimate.name << " = " << end;
    }
  }
  EXPECT_GT(wide, 0);  // else nothing would be followed
}

// Two arcs a factor 3 apart share their resistance in nearly any proportion: a long bent valley, in which a step as
// long as the curvature says ends on a slope far up.  Both ends are where its floor has risen, well away from the
// estimate.
TEST(ProfileInterval, FollowsABentValley) {
  const char* const formula = "0.1 + R1/(1 + (0.01 s)^0.8) + R2/(1 + (T s)^0.8)";
  std::mt19937_64 generator(7);
  const auto data = noisy_response(formula, {1, 0.8, 0.03}, 0.01, generator, 80);
  const frac::FitResult result = frac::fit(data, frac::Structure(formula), both_parts());
  for (const frac::ParameterEstimate& estimate : result.parameters) {
    const auto interval = frac::profile_interval(data, both_parts(), result, estimate.name);
    EXPECT_LT(interval.lower, estimate.value - 0.5 * estimate.standard_error) << estimate.name;
    EXPECT_GT(interval.upper, estimate.value + 0.5 * estimate.standard_error) << estimate.name;
    EXPECT_FALSE(interval.better_minimum_found);
  }
}

// Cauchy's loss on clean data acts like least squares, so the two profiles agree but for its 5 % of efficiency and what
// one spread of 60 pairs differs from the other (1/sqrt(240) = 6 %, and the median is 1.6 times as uncertain): 25 %.
TEST(ProfileInterval, FollowsTheLossOfARobustFit) {
  const auto data = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.02, 5);
  const frac::Structure structure("K/(T s^a + 1)");
  frac::FitOptions options = both_parts();
  const auto plain = frac::profile_interval(data, options, frac::fit(data, structure, options), "K");
  options.loss = frac::Loss::cauchy;
  const auto robust = frac::profile_interval(data, options, frac::fit(data, structure, options), "K");
  EXPECT_NEAR((robust.upper - robust.lower) / (plain.upper - plain.lower), 1, 0.25);
  EXPECT_LT(robust.lower, plain.upper);
  EXPECT_LT(plain.lower, robust.upper);
}

double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

// Of 200 trials a true 95 % covers 190 +- 3.1: 178 is four standard deviations below, and 92 % (184) still within two
// of what is promised.  White noise of the same models is held to the same, and to intervals no more than 12 % wider
// than white noise allows (the mean over possible correlations of 60 points; sd of an estimated one 1/sqrt(120)).
TEST(CorrelatedNoise, IsAllowedForByTheIntervals) {
  for (const support::CoverageModel& model : {support::coverage_models()[0], support::coverage_models()[2]}) {
    for (const double correlation : {0.0, 0.7}) {
      support::CoverageCase scene{model};
      scene.correlation = correlation;
      const support::Coverage coverage = support::measure_coverage(scene, 200, 811);
      EXPECT_GE(least(coverage.share), 178.0 / 200) << model.name << " r = " << correlation;
    }
  }
}

// Against the restricted likelihood, of the residuals before they turn, and the covariance of two influences with the
// whole covariance matrix, for points at random places.  Of matrices with a condition of up to 1e5 that loses 1e-16 *
// 1e5 of some 100; the filter as much.
TEST(SmoothError, HasTheLikelihoodOfItsCovarianceMatrix) {
  support::Random random(12);
  constexpr Eigen::Index points = 30, columns = 3, rows = 2 * points;
  Eigen::MatrixXd basis(rows, columns);
  Eigen::VectorXd residual(rows);
  Eigen::MatrixXd influence(rows, 2);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index k = 0; k < columns; ++k) basis(i, k) = random.normal();
    residual[i] = 0.01 * random.normal();
    influence.row(i) << random.normal(), random.normal();
  }
  basis = Eigen::HouseholderQR<Eigen::MatrixXd>(basis).householderQ() * Eigen::MatrixXd::Identity(rows, columns);
  frac::detail::ResidualAxis axis{2};
  for (Eigen::Index i = 0; i < points; ++i) {
    axis.position.push_back((axis.position.empty() ? 0 : axis.position.back()) + std::abs(random.normal()));
    axis.factor.push_back(std::polar(1 + 0.1 * random.normal(), 3 * random.normal()));
  }
  const frac::detail::SmoothError smooth(std::span(residual.data(), static_cast<std::size_t>(rows)), basis, axis);
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(rows, rows);
  for (Eigen::Index i = 0; i < points; ++i) {
    const std::complex<double> factor = axis.factor[static_cast<std::size_t>(i)];
    turn.block<2, 2>(2 * i, 2 * i) << factor.real(), -factor.imag(), factor.imag(), factor.real();
  }
  const Eigen::MatrixXd x = turn * basis;
  const Eigen::MatrixXd a = turn * influence;
  const Eigen::VectorXd r = turn * residual;
  const double by_turning = std::log(std::abs(turn.determinant()));
  const double degrees = rows - columns;
  // More than are filtered side by side.
  const std::vector<double> shares{0, 1e-3, 0.2, 0.3, 0.5, 0.7, 0.8, 0.9, 0.99, 0.9999};
  for (const double length : {0.3, 3.0, 60.0}) {
    const auto likelihoods = smooth.at(shares, length);
    ASSERT_EQ(likelihoods.size(), shares.size());
    for (std::size_t each = 0; each < shares.size(); ++each) {
      const double share = shares[each];
      Eigen::MatrixXd covariance = (1 - share) * Eigen::MatrixXd::Identity(rows, rows);
      for (Eigen::Index i = 0; i < rows; ++i) {
        for (Eigen::Index j = i % 2; j < rows; j += 2) {
          const double q =
              std::sqrt(3.0) / length *
              std::abs(axis.position[static_cast<std::size_t>(i / 2)] - axis.position[static_cast<std::size_t>(j / 2)]);
          covariance(i, j) += share * (1 + q) * std::exp(-q);
        }
      }
      const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
      const Eigen::MatrixXd known = x.transpose() * factor.solve(x);
      const Eigen::VectorXd pull = x.transpose() * factor.solve(r);
      const double left = r.dot(factor.solve(r)) - pull.dot(known.llt().solve(pull));
      const double logarithm = by_turning - factor.matrixLLT().diagonal().array().log().sum() -
                               0.5 * std::log(known.determinant()) - 0.5 * degrees * std::log(left);
      const auto& found = likelihoods[each];
      EXPECT_NEAR(found.logarithm, logarithm, 1e-8) << share << ' ' << length;
      EXPECT_NEAR(found.variance / (left / degrees), 1, 1e-9) << share << ' ' << length;
      const Eigen::MatrixXd exact = a.transpose() * covariance * a;
      const frac::detail::SmoothError::Possibility possible{1, share, length};
      const Eigen::MatrixXd error = smooth.covariance(smooth.influences(influence), {&possible, 1}) - exact;
      EXPECT_LT(error.norm(), 1e-12 * exact.norm()) << share << ' ' << length;
    }
  }
}

// Blocks of four hold an error whose length is that of 200 points or more to (4/200)^2: that of a mean of four.
TEST(SmoothError, OfManyPointsIsThatOfBlocks) {
  support::Random random(13);
  constexpr std::size_t points = 1000;
  frac::detail::ResidualAxis axis;
  std::vector<double> residual;
  Eigen::MatrixXd covariance(points, points);
  for (std::size_t i = 0; i < points; ++i) {
    axis.position.push_back(static_cast<double>(i));
    axis.factor.push_back(1 + 0.3 * std::sin(static_cast<double>(i)));
    residual.push_back(random.normal() + 2 * std::sin(static_cast<double>(i) / 150));
  }
  const Eigen::MatrixXd basis = Eigen::MatrixXd::Constant(points, 1, 1 / std::sqrt(static_cast<double>(points)));
  Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXd>(residual.data(), points), x = basis.col(0);
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double factor = axis.factor[static_cast<std::size_t>(i)].real();
    r[i] *= factor;
    x[i] *= factor;
  }
  const frac::detail::SmoothError smooth(residual, basis, axis);
  for (const double share : {0.1, 0.7}) {
    constexpr double length = 200;
    for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
      for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
        const double q = std::sqrt(3.0) / length * static_cast<double>(std::abs(i - j));
        covariance(i, j) = share * (1 + q) * std::exp(-q) + (i == j ? 1 - share : 0);
      }
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    const double known = x.dot(factor.solve(x)), pull = x.dot(factor.solve(r));
    const double left = r.dot(factor.solve(r)) - pull * pull / known;
    const double degrees = points - 1;
    EXPECT_NEAR(smooth.at(std::vector<double>{share}, length).front().variance / (left / degrees), 1, 1e-3) << share;
    const frac::detail::SmoothError::Possibility possible{1, share, length};
    EXPECT_NEAR(smooth.covariance(smooth.influences(basis), {&possible, 1})(0, 0) / x.dot(covariance * x), 1, 1e-3)
        << share;
  }
}

// Of 200 trials 95 % are 190 +- 3.1.  Intervals that allow for a smooth error are held to 92 % of all parameters taken
// together, at three standard deviations of 800 values of which those of a trial go together (.92 - 3 sqrt(.92 *
// .08/200) = .86), and each to 80 %: a length of the error that the points do not tell is averaged over, not known.
// Intervals that know noise of first order alone hold 33 to 92 % on the mean (interval_coverage).
TEST(SmoothError, IsAllowedForByTheIntervals) {
  for (const double deviation : {0.003, 0.01, 0.03}) {
    for (const support::CoverageModel& model : {support::coverage_models()[1], support::coverage_models()[4]}) {
      support::CoverageCase scene{model, 60, 0.003};
      scene.smooth = {support::SmoothDeviation::Kind::process, deviation, 2};
      const support::Coverage coverage = support::measure_coverage(scene, 200, 4711);
      double mean = 0;
      for (const double share : coverage.share) mean += share / static_cast<double>(coverage.share.size());
      EXPECT_GE(mean, 0.86) << model.name << ' ' << deviation;
      EXPECT_GE(least(coverage.share), 0.8) << model.name << ' ' << deviation;
    }
  }
}

TEST(CorrelatedNoise, IsToldFromWhiteNoise) {
  support::Random random(4);
  support::CoverageCase scene{support::coverage_models()[0]};
  const frac::Structure structure(scene.model.formula);
  scene.points = 200;
  const frac::FitResult white = frac::fit(support::covered_data(scene, random), structure, both_parts());
  EXPECT_LT(white.noise_correlation, 0.1);
  // The 400 residuals tell a share of smooth variance to about 1/20, which is 20 times the variance of a gain as white
  // noise tells it, with a probability of a twentieth left: at most a root of 2 for a gain.
  for (const auto& estimate : white.parameters) {
    EXPECT_GE(estimate.widening, 0.9) << estimate.name;
    EXPECT_LE(estimate.widening, std::sqrt(2.0)) << estimate.name;
  }
  EXPECT_LT(white.smooth_error, white.rms / 3);
  scene.correlation = 0.7;
  const frac::FitResult correlated = frac::fit(support::covered_data(scene, random), structure, both_parts());
  // 400 values know a correlation of .7 to sqrt((1 - .49)/400) = .036.
  EXPECT_NEAR(correlated.noise_correlation, 0.7, 0.12);
  EXPECT_NE(correlated.message.find("Neighbouring residuals go together"), std::string::npos) << correlated.message;
}

// The mean of n values of first-order noise has the variance (1 + r)/(1 - r) of white noise over n, but for terms of
// the order of 1/(n (1 - r)), here 1 %; the correlation is known to 1/sqrt(2000) = .016, which moves the root of that
// ratio by .016/(1 - r^2) = 3 %: three of both are 10 %.
TEST(CorrelatedNoise, WidensAMeanAsTheoryHasIt) {
  support::Random random(9);
  support::CoverageCase scene{{"gain", "K s^0.5", {2}}, 1000};
  scene.correlation = 0.7;
  const frac::FitResult result =
      frac::fit(support::covered_data(scene, random), frac::Structure(scene.model.formula), both_parts());
  EXPECT_NEAR(result.parameters[0].widening / std::sqrt(1.7 / 0.3), 1, 0.1);
}

// Frequency under another name would be fitted as a number.
TEST(Fit, RefusesFormulasWhoseFrequencyIsAParameter) {
  const auto data = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 1);
  for (const auto& [formula, hint] :
       {std::pair{"K/(1 + (j w tau)^a)", "for j omega write s"}, std::pair{"K/(1 + jw T)", "for j omega write s"},
        std::pair{"K/(s + i omega)", "for j omega write s"}, std::pair{"K/(T p + 1)", "the variable is s"},
        std::pair{"K/(T S + 1)", "the variable is s"}, std::pair{"K/(T x + 1)", "the variable is s"},
        std::pair{"K/(T y^a + 1)", "no s in it"}}) {
    try {
      (void)frac::fit(data, frac::Structure(formula), {});
      ADD_FAILURE() << formula << " was fitted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(hint), std::string::npos) << error.what();
    }
  }
  EXPECT_NO_THROW((void)frac::fit(data, frac::Structure("K"), {}));
}

// As above: 178 of 200.  The two-lag falls by four decades, most of them below noise of 0.3 % of its gain.
TEST(LearnedWeight, CoversUnderRelativeAdditiveAndMixedNoise) {
  const support::CoverageModel model = support::coverage_models()[4];
  const double floor = 0.003 * support::largest_value(model);
  for (const auto& [relative, additive] : {std::pair{0.01, 0.0}, std::pair{0.0, floor}, std::pair{0.01, floor}}) {
    support::CoverageCase scene{model, 60, relative, additive};
    scene.weight = frac::Weight::learned;
    const support::Coverage coverage = support::measure_coverage(scene, 200, 77);
    EXPECT_GE(least(coverage.share), 178.0 / 200) << relative << " relative, " << additive << " additive";
  }
}

// Additive noise of 0.01 beside 1 % makes a floor of 1; the likelihood knows it to some 20 % from 400 values, a factor
// 1.6 is more than twice that.  Without it relative weight is kept, to the last bit.
TEST(LearnedWeight, FindsTheFloorOrNone) {
  support::Random random(5);
  const support::CoverageModel model = support::coverage_models()[4];
  const frac::Structure structure(model.formula);
  frac::FitOptions options = both_parts();
  options.weight = frac::Weight::learned;
  const frac::FitResult mixed = frac::fit(support::covered_data({model, 200, 0.01, 0.01}, random), structure, options);
  EXPECT_GT(mixed.noise_floor, 1 / 1.6);
  EXPECT_LT(mixed.noise_floor, 1.6);
  EXPECT_NE(mixed.message.find("does not fall with the data"), std::string::npos) << mixed.message;
  const auto relative_data = support::covered_data({model, 200, 0.01, 0}, random);
  const frac::FitResult relative = frac::fit(relative_data, structure, options);
  EXPECT_EQ(relative.noise_floor, 0);
  options.weight = frac::Weight::relative;
  EXPECT_EQ(relative.cost, frac::fit(relative_data, structure, options).cost);
}

// Of data without a real part noise of 1 % of the imaginary one has no floor, however large the model's real part: the
// likelihood must speak for one by two, which it does by chance in 2.3 % of the records (half of what chi-squared with
// one degree of freedom has above 4), and in 5 of 40 with one of 2e-3.  Noise of one size has a floor well above the
// values.
TEST(LearnedWeight, SizesDataWithoutRealPartByTheirImaginaryPart) {
  int floors_of_relative = 0, floors_of_absolute = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> noise(0, 0.01);
    std::vector<double> omega;
    std::vector<std::complex<double>> relative, absolute;
    for (int i = 0; i < 60; ++i) {
      omega.push_back(std::pow(10, -2 + i / 15.0));
      const double exact = (2.0 / std::complex<double>(1, 0.5 * omega.back())).imag(), each = noise(generator);
      relative.emplace_back(0, exact * (1 + each));
      absolute.emplace_back(0, exact + each);
    }
    frac::FitOptions options;
    options.component = Component::imaginary;
    const frac::Structure lag("K/(T s + 1)");
    floors_of_relative += frac::fit({omega, relative}, lag, options).noise_floor > 0 ? 1 : 0;
    floors_of_absolute += frac::fit({omega, absolute}, lag, options).noise_floor > 0 ? 1 : 0;
  }
  EXPECT_LE(floors_of_relative, 5);
  EXPECT_EQ(floors_of_absolute, 40);
}

// What the results say is said of one cost: that of the floor found.
TEST(LearnedWeight, IsKeptByWhatFollowsTheFit) {
  support::Random random(6);
  const support::CoverageModel model = support::coverage_models()[4];
  const auto data = support::covered_data({model, 80, 0.01, 0.01}, random);
  frac::FitOptions options = both_parts();
  options.weight = frac::Weight::learned;
  const frac::FitResult result = frac::fit(data, frac::Structure(model.formula), options);
  ASSERT_GT(result.noise_floor, 0);
  const auto interval = frac::profile_interval(data, options, result, "K");
  const double half_width = result.parameters[0].ci95_upper - result.parameters[0].value;
  // Curvature and profile of a well determined gain agree to some per cent.
  EXPECT_NEAR(interval.upper - result.parameters[0].value, half_width, 0.1 * half_width);
  EXPECT_FALSE(interval.better_minimum_found);
}

// The constant that the imaginary part does not see takes over the errors of the arc: R0 = mean of Re G less the arc's.
// Held at the estimates, they left intervals that cover 85 to 88 %.
TEST(ImaginaryPart, ConstantsFromTheRealPartCarryTheErrorsOfTheOthers) {
  for (const auto& model : {support::coverage_models()[1], support::coverage_models()[5]}) {
    support::CoverageCase scene{model};
    scene.component = Component::imaginary;
    EXPECT_GE(least(support::measure_coverage(scene, 200, 31).share), 178.0 / 200) << model.name;
  }
}

// What is fitted is the same function of omega in all four, whatever they are where the residuals do not look, so that
// their time constants have one error.  Where the size of the whole model stood in the place of that of its seen part,
// errors differed by up to a factor of 10, and intervals of the second and third missed the truth in 15 and 17 of 100.
// Solves end at 1e-9 of a parameter or closer.
TEST(ImaginaryPart, TellsAsMuchHoweverTheUnseenPartIsWritten) {
  support::Random random(17);
  const support::CoverageCase scene{{"lag on a constant", "R + K/(T s + 1)", {5, 3, 2}}};
  for (int trial = 0; trial < 6; ++trial) {
    const frac::FrequencyResponseData data = support::covered_data(scene, random);
    std::vector<double> error;
    for (const char* const formula : {"K/(T s + 1)", "R + K/(T s + 1)", "K (Q s + 1)/(T s + 1)", "K A/(T s + 1)"}) {
      frac::FitOptions options;
      options.component = Component::imaginary;
      for (const frac::ParameterEstimate& each : frac::fit(data, frac::Structure(formula), options).parameters)
        if (each.name == "T") error.push_back(each.standard_error);
    }
    for (const double each : error) EXPECT_NEAR(each / error.front(), 1, 1e-4) << trial;
  }
}

// A quantity has one error, as a parameter and as what other parameters tell of it: both are the same quadratic form of
// the covariance of the noise.  Errors widened one by one and joined by the correlations of white noise make it up to
// 1.7 times as large in these data.  Solves end at 1e-9 of a parameter or closer, condition 1e3.
TEST(Covariance, GivesAQuantityTheErrorThatItHasAsAParameter) {
  support::Random random(21);
  support::CoverageCase scene{support::coverage_models()[1]};
  const frac::Structure by_charge(scene.model.formula), by_time("R0 + R1/(1 + (T s)^n1)");
  const frac::DerivedQuantity time("T = (R1 Q1)^(1/n1)", by_charge.parameter_names());
  for (const double deviation : {0.0, 0.01}) {
    scene.smooth = {support::SmoothDeviation::Kind::process, deviation, 2};
    for (int trial = 0; trial < 4; ++trial) {
      const frac::FrequencyResponseData data = support::covered_data(scene, random);
      const frac::FitResult as_parameter = frac::fit(data, by_time, both_parts());
      const auto derived = frac::derived_estimates(frac::fit(data, by_charge, both_parts()), {&time, 1});
      ASSERT_EQ(as_parameter.parameters[2].name, "T");
      EXPECT_NEAR(derived[0].standard_error / as_parameter.parameters[2].standard_error, 1, 1e-4) << trial;
    }
  }
}

// Of a gain and a factor beside it the data tell the product alone, whose error 1e26 of variance hides.
TEST(Covariance, TellsNothingOfWhatRoundingHides) {
  support::Random random(22);
  const support::CoverageCase scene{{"lag", "K/(T s + 1)", {3, 2}}};
  const frac::FrequencyResponseData data = support::covered_data(scene, random);
  const frac::Structure structure("K A/(T s + 1)");
  const frac::FitResult result = frac::fit(data, structure, both_parts());
  const std::vector<frac::DerivedQuantity> quantities{{"G = K A", structure.parameter_names()},
                                                      {"f = 1/T", structure.parameter_names()}};
  const auto derived = frac::derived_estimates(result, quantities);
  EXPECT_NEAR(derived[0].value, 3, 0.1);
  EXPECT_TRUE(std::isnan(derived[0].standard_error));
  EXPECT_NEAR(derived[1].standard_error / derived[1].value,
              result.parameters[2].standard_error / result.parameters[2].value, 1e-9);
  EXPECT_TRUE(std::isnan(frac::response_deviation(result, frac::ExactRealisation{}, {1.0})[0].real));
}

// Resampled residuals keep their correlation: the bootstrap tells how far estimates from other data scatter.  400 of
// the former give 3.5 %, 100 of the latter 7 %; r told from 400 residuals to (1 - r^2)/sqrt(400) moves sqrt((1 + r)/(1
// - r)) by 1/sqrt(400), and their size is that of about 400 (1 - r)/(1 + r) free ones, 8 %: three of all together are
// 37 %.
TEST(Bootstrap, KeepsTheCorrelationOfNeighbours) {
  constexpr int trials = 100;
  support::Random random(12);
  support::CoverageCase scene{support::coverage_models()[0], 200};
  scene.correlation = 0.7;
  const frac::Structure structure(scene.model.formula);
  const auto data = support::covered_data(scene, random);
  const frac::FitResult result = frac::fit(data, structure, both_parts());
  const auto intervals = frac::bootstrap(data, both_parts(), result, 400);
  std::array<double, 3> square{};
  for (int trial = 0; trial < trials; ++trial) {
    const frac::FitResult other = frac::fit(support::covered_data(scene, random), structure, both_parts());
    for (std::size_t i = 0; i < 3; ++i)
      square[i] += std::pow(other.parameters[i].value - scene.model.parameters[i], 2) / trials;
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(intervals[i].standard_error / std::sqrt(square[i]), 1, 0.37) << i;
}

TEST(ProfileInterval, RefusesWhatHasNone) {
  const auto data = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 2);
  frac::FitOptions options = both_parts();
  options.constraints = {{"a", 0.6, {}, {}, {}}};
  const frac::FitResult result = frac::fit(data, frac::Structure("K/(T s^a + 1)"), options);
  EXPECT_THROW((void)frac::profile_interval(data, options, result, "a"), std::invalid_argument);
  EXPECT_THROW((void)frac::profile_interval(data, options, result, "b"), std::invalid_argument);
}

// 400 resamples know a standard deviation to 1/sqrt(800) = 3.5 %, and resampling 60 residual pairs adds sqrt(1/240)
// = 6.5 %; three of both together are 22 %.
TEST(Bootstrap, AgreesWithTheCovarianceOnNormalNoise) {
  const auto data = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 4);
  const frac::FitResult result = frac::fit(data, frac::Structure("K/(T s^a + 1)"), both_parts());
  const auto intervals = frac::bootstrap(data, both_parts(), result, 400);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(intervals[i].standard_error * result.parameters[i].widening / result.parameters[i].standard_error, 1,
                0.22)
        << i;
    EXPECT_LT(intervals[i].lower, result.parameters[i].value);
    EXPECT_GT(intervals[i].upper, result.parameters[i].value);
  }
}

// The percentiles lie where the covariance puts the interval: 400 resamples know a 2.5 % point to 8 % of the half
// width, and the residuals at hand shift it by some per cent more.  The same for the imaginary part alone.  Resamples
// hold no smooth error, for which the other interval is widened.
TEST(Bootstrap, PutsItsIntervalsWhereTheCovarianceDoes) {
  const auto data = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 8);
  for (const Component component : {Component::both, Component::imaginary}) {
    frac::FitOptions options;
    options.component = component;
    const frac::FitResult result = frac::fit(data, frac::Structure("K/(T s^a + 1)"), options);
    const auto intervals = frac::bootstrap(data, options, result, 400);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& estimate = result.parameters[i];
      const double half_width = (estimate.ci95_upper - estimate.value) / estimate.widening;
      EXPECT_NEAR(intervals[i].lower, estimate.value - half_width, 0.3 * half_width) << estimate.name;
      EXPECT_NEAR(intervals[i].upper, estimate.value + half_width, 0.3 * half_width) << estimate.name;
    }
  }
}

TEST(Bootstrap, DoesNotDependOnThreads) {
  const auto data = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 4);
  const frac::FitResult result = frac::fit(data, frac::Structure("K/(T s^a + 1)"), both_parts());
  const auto one = frac::bootstrap(data, both_parts(), result, 40, 1),
             two = frac::bootstrap(data, both_parts(), result, 40, 2);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(one[i].lower, two[i].lower);
  EXPECT_THROW((void)frac::bootstrap(data, both_parts(), result, 5), std::invalid_argument);
}

// A gain alone: the deviation of K G is sd(K) |part of G|, exactly.
TEST(ResponseDeviation, FollowsTheGain) {
  const auto data = noisy_response("K/(0.5 s^0.6 + 1)", {2}, 0.02, 1);
  const frac::FitResult result = frac::fit(data, frac::Structure("K/(0.5 s^0.6 + 1)"), both_parts());
  const auto deviation = frac::response_deviation(result, frac::ExactRealisation{}, {1.0});
  const std::complex<double> shape = frac::Structure("1/(0.5 s^0.6 + 1)").response({}, 1.0);
  EXPECT_NEAR(deviation[0].real, result.parameters[0].standard_error * shape.real(), 1e-15);
  EXPECT_NEAR(deviation[0].imaginary, -result.parameters[0].standard_error * shape.imag(), 1e-15);
  EXPECT_NEAR(deviation[0].log_magnitude, result.parameters[0].standard_error / result.parameters[0].value, 1e-15);
  EXPECT_NEAR(deviation[0].phase, 0, 1e-15);
}

// K s^a: the phase is a pi/2 at any frequency, and at omega = 1 the magnitude is K.
TEST(ResponseDeviation, OfAPowerLawIsThatOfItsOrderInThePhase) {
  const auto data = noisy_response("K s^a", {2, -0.4}, 0.02, 1);
  const frac::FitResult result = frac::fit(data, frac::Structure("K s^a"), both_parts());
  const auto deviation = frac::response_deviation(result, frac::ExactRealisation{}, {1.0, 30.0});
  const frac::ParameterEstimate &gain = result.parameters[0], &order = result.parameters[1];
  EXPECT_NEAR(deviation[0].log_magnitude, gain.standard_error / gain.value, 1e-14);
  for (const auto& each : deviation) EXPECT_NEAR(each.phase, order.standard_error * std::acos(0.0), 1e-14);
}

TEST(FitResult, NamesOutliersAndTheCentreOfTheBand) {
  auto value = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 6).value();
  value[17] *= 1.5;
  const frac::FitResult result = frac::fit({grid(), value}, frac::Structure("K/(T s^a + 1)"), [] {
    frac::FitOptions options = both_parts();
    options.loss = frac::Loss::cauchy;
    return options;
  }());
  EXPECT_EQ(result.outliers, std::vector<std::size_t>{17});
  // The band from .01 to 100 has its middle at 1 rad/s, where T and T omega^a are the same.
  EXPECT_NEAR(result.centre_omega, 1, 1e-12);
  EXPECT_NEAR(result.parameters[1].centre_value, result.parameters[1].value, 1e-12);
  // The covariance holds the squares of the standard errors, and Cauchy-Schwarz holds between them.
  for (std::size_t i = 0; i < 3; ++i) {
    const double error = result.parameters[i].standard_error;
    EXPECT_NEAR(result.covariance[i][i], error * error, 1e-12 * error * error);
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_LE(std::abs(result.covariance[i][j]), error * result.parameters[j].standard_error * (1 + 1e-12));
      EXPECT_NEAR(result.covariance[i][j], result.covariance[j][i], 1e-12 * std::abs(result.covariance[i][j]));
    }
  }
}

}  // namespace
