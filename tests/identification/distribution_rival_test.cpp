// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/distribution_rival.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "identification/rational/term_problem.hpp"
#include "support/both_parts.hpp"
#include "support/noisy_response.hpp"

namespace {

using Complex = std::complex<double>;
using frac::Verdict;
using frac::detail::Term;
using support::both_parts;

/// Mean of 1/(1 + s t) with ln t about 0 by adaptive quadrature.
Complex spread_lag(Complex s, Term::Kind kind, double width) {
  const bool normal = kind == Term::Kind::normal_spread;
  const double end = normal ? 12 * width : width;
  const auto density = [&](double u) {
    return normal ? std::exp(-0.5 * u * u / (width * width)) / (width * std::sqrt(2 * std::numbers::pi))
                  : 1 / (2 * width);
  };
  using Rule = boost::math::quadrature::gauss_kronrod<double, 31>;
  const auto part = [&](auto of) {
    const auto integrand = [&](double u) { return density(u) * of(1.0 / (1.0 + s * std::exp(u))); };
    return Rule::integrate(integrand, -end, 0, 12, 1e-12) + Rule::integrate(integrand, 0, end, 12, 1e-12);
  };
  return {part([](Complex v) { return v.real(); }), part([](Complex v) { return v.imag(); })};
}

frac::FrequencyResponseData spread_data(Term::Kind kind, double width, double constant, double noise, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0, noise);
  const std::vector<double> omega = support::four_decades(60);
  std::vector<Complex> value;
  for (const double each : omega) {
    const Complex exact = constant + spread_lag(Complex(0, each), kind, width);
    const double real = normal(generator), imaginary = normal(generator);
    value.push_back(exact + std::abs(exact) * Complex(real, imaginary));
  }
  return {omega, value};
}

constexpr Term::Kind kinds[] = {Term::Kind::normal_spread, Term::Kind::even_spread};

frac::detail::TermProblem exact_problem(Term::Kind kind, double width) {
  const frac::FrequencyResponseData data = spread_data(kind, width, 0, 0, 1);
  return {data, frac::detail::residual_rule(data, both_parts())};
}

// Spread over 400 e-folds, more than any data do: v is a step of 1 and, times -i, a hill of area pi/2 at z = 1, to the
// second order in 1/width; in the third the step adds (pi^2/24) |ln z| density, 1e-8 here.
TEST(SpreadLags, OfAllTimesAreAStepAndAHill) {
  const double width = 400;
  const frac::detail::TermProblem problem = exact_problem(Term::Kind::normal_spread, 1);
  const Eigen::MatrixXcd columns =
      problem.columns({{.kind = Term::Kind::normal_spread, .held = true, .log_width = std::log(width)}});
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const double place = -std::log(problem.s()[i].imag()) / width;
    const double density = std::exp(-0.5 * place * place) / (width * std::sqrt(2 * std::numbers::pi));
    const Complex expected(0.5 * std::erfc(-place / std::numbers::sqrt2), -0.5 * std::numbers::pi * density);
    EXPECT_LT(std::abs(columns(i, 0) - expected), 1e-7) << problem.s()[i];
  }
}

// The trapezoidal rule promises 1e-9, quadrature 1e-12.
TEST(SpreadLags, AreTheMeansOfLags) {
  for (const Term::Kind kind : kinds) {
    for (const double width : {0.1, 0.35, 1.0, 3.0}) {
      const frac::detail::TermProblem problem = exact_problem(kind, width);
      const Eigen::MatrixXcd columns = problem.columns({{.kind = kind, .held = true, .log_width = std::log(width)}});
      for (Eigen::Index i = 0; i < columns.rows(); i += 7) {
        const Complex s = problem.s()[i];
        EXPECT_LT(std::abs(columns(i, 0) - spread_lag(s, kind, width)), 1e-9) << width << " at " << s;
      }
    }
  }
}

// Central differences of step 1e-5: their third-order term is 1e-10 times third derivatives of order one, and rounding
// 1e-16/1e-5.
TEST(SpreadLags, ChangeAsTheirDerivativesSay) {
  for (const Term::Kind kind : kinds) {
    const frac::detail::TermProblem problem = exact_problem(kind, 1);
    const Term term{.kind = kind, .held = true, .log_size = 0.7, .log_width = std::log(0.8)};
    frac::detail::ProjectedData::Linear linear;
    ASSERT_TRUE(problem.solve(problem.columns({term}), linear));
    const Eigen::MatrixXcd derivatives = problem.derivatives({term}, linear);
    ASSERT_EQ(derivatives.cols(), 2);
    for (Eigen::Index k = 0; k < 2; ++k) {
      constexpr double step = 1e-5;
      Eigen::VectorXd change = Eigen::VectorXd::Zero(2);
      change[k] = step;
      const Eigen::MatrixXcd above = problem.columns(problem.stepped({term}, change)),
                             below = problem.columns(problem.stepped({term}, -change));
      const Eigen::VectorXcd difference = linear.coefficients[0] * (above - below) / (2 * step);
      EXPECT_LT((derivatives.col(k) - difference).lpNorm<Eigen::Infinity>(), 1e-8);
    }
  }
}

// Lags of spread times are no fractional power, whatever spread: at 0.3 % of noise.  Evidence for the
// power would have to be above 10 against the truth itself, a chance of exp(-5) at most for each.
TEST(DistributionRival, IsNotTakenForAFractionalPower) {
  const auto candidates = frac::default_candidates();
  for (const Term::Kind kind : kinds) {
    for (unsigned seed = 1; seed <= 2; ++seed) {
      const auto data = spread_data(kind, 0.8 + 0.4 * seed, seed % 2 == 0 ? 0.3 : 0, 0.003, seed);
      const auto result = frac::identify(data, candidates, {}, both_parts());
      EXPECT_NE(result.verdict, Verdict::fractional_supported) << seed << ": " << result.verdict_sentence;
      if (result.verdict != Verdict::fractional_or_distribution) continue;
      ASSERT_TRUE(result.distribution);
      EXPECT_LE(result.distribution->evidence, 10);
      EXPECT_EQ(result.ranking[result.chosen].model_class, frac::ModelClass::fractional);
    }
  }
}

// A power over four decades is no sum of three spreads: a Cole-Cole arc has tails of a power where a normal spread
// falls off faster than any.
TEST(DistributionRival, DoesNotHideAFractionalPower) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const auto data = support::noisy_response("K/(T s^a + 1)", {2, 0.5, 0.7}, 0.003, seed, 80);
    const auto result = frac::identify(data, frac::default_candidates(), {}, both_parts());
    EXPECT_EQ(result.verdict, Verdict::fractional_supported) << result.verdict_sentence;
    ASSERT_TRUE(result.distribution);
    EXPECT_GT(result.distribution->evidence, 10);
  }
}

// Words name the spread that made the data: a median of 1 s, and a deviation that 0.1 % noise tells to 1 %.
TEST(DistributionRival, NamesTheSpread) {
  const auto data = spread_data(Term::Kind::normal_spread, 1.5, 0, 0.001, 3);
  const auto result = frac::identify(data, frac::default_candidates(), {}, both_parts());
  ASSERT_TRUE(result.distribution) << result.verdict_sentence;
  EXPECT_EQ(result.distribution->parameters, 3u);
  EXPECT_NE(result.distribution->model.find("ln t normal about ln "), std::string::npos) << result.distribution->model;
  EXPECT_NE(result.distribution->model.find("with deviation 1."), std::string::npos) << result.distribution->model;
  EXPECT_LT(result.distribution->evidence, -10);
  EXPECT_EQ(result.verdict_sentence.find("A distribution of relaxation times rather than a fractional power"), 0u)
      << result.verdict_sentence;
}

// A magnitude or a phase is no sum of lags.
TEST(DistributionRival, IsNotAskedOfAMagnitude) {
  auto options = both_parts();
  options.component = frac::Component::magnitude;
  const auto data = support::noisy_response("K/(T s^a + 1)", {2, 0.5, 0.7}, 0.003, 1, 40);
  frac::detail::Competitor any;
  EXPECT_FALSE(frac::detail::distribution_rival(data, options, any, 1));
}

}  // namespace
