// SPDX-License-Identifier: BSD-3-Clause
// Fits of very many points search on means of them; what they end at is the optimum of all points.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/search/thinned.hpp"
#include "support/noisy_response.hpp"
#include "support/random.hpp"

namespace {

using Complex = std::complex<double>;

std::vector<double> parameters_of(const frac::FitResult& fit) {
  std::vector<double> values;
  for (const auto& each : fit.parameters) values.push_back(each.value);
  return values;
}

/// Residuals of both parts at given parameters, without the library's.  @param floor  0: relative ones
std::vector<double> residuals_of(const frac::FrequencyResponseData& data, const frac::Structure& structure,
                                 const std::vector<double>& parameters, double floor = 0) {
  std::vector<Complex> model(data.size());
  structure.response(parameters, data.omega(), frac::ExactRealisation{}, model);
  std::vector<double> residuals;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const Complex rest = (model[i] - data.value()[i]) / std::hypot(std::abs(data.value()[i]), floor);
    residuals.insert(residuals.end(), {rest.real(), rest.imag()});
  }
  return residuals;
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// What is left of the cost to be gained along any one parameter, (J'r)^2/J'J, moves it by the square root of that share
// of the variance in standard errors: less than a thousandth is asked for.
void expect_optimum(const frac::FrequencyResponseData& data, const frac::Structure& structure,
                    const frac::FitResult& fit, double floor) {
  const std::vector<double> values = parameters_of(fit), residual = residuals_of(data, structure, values, floor);
  const double variance = product(residual, residual) / static_cast<double>(residual.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double step = 1e-5 * values[k];
    std::vector<double> above = values, below = values;
    above[k] += step;
    below[k] -= step;
    std::vector<double> slope = residuals_of(data, structure, above, floor);
    const std::vector<double> other = residuals_of(data, structure, below, floor);
    for (std::size_t i = 0; i < slope.size(); ++i) slope[i] -= other[i];
    const double gain = std::pow(product(slope, residual), 2) / product(slope, slope);
    EXPECT_LT(std::sqrt(gain / variance), 1e-3) << structure.formula() << ' ' << fit.parameters[k].name;
  }
}

// Repeats of a frequency share a bin, over which any model is constant: sums of squares of all points and of the means
// differ by the same number for every model, to rounding of sums of 2000 squares.
TEST(ManyPoints, MeansOfRepeatsAreSufficient) {
  support::Random random(31);
  for (const double size : {1.0, 1e-190, 1e190}) {
    std::vector<double> omega;
    std::vector<Complex> value;
    for (int frequency = 0; frequency < 50; ++frequency) {
      const double here = std::pow(10, 0.06 * frequency - 1);
      for (int repeat = 0; repeat < 40; ++repeat) {
        omega.push_back(here);
        value.push_back(size * (1.0 / Complex(1, here) + 0.3 * Complex(random.normal(), random.normal())));
      }
    }
    const frac::FrequencyResponseData data(omega, value);
    for (const auto component : {frac::Component::both, frac::Component::real, frac::Component::imaginary}) {
      const auto rule = frac::detail::residual_rule(data, component, frac::Weight::relative);
      const auto means = frac::detail::binned(data, rule, 1000);
      ASSERT_TRUE(means);
      ASSERT_EQ(means->data.size(), 50u);
      const auto cost = [&](const frac::detail::ResidualRule& of, const frac::FrequencyResponseData& points,
                            double gain) {
        std::vector<Complex> model;
        for (const double each : points.omega()) model.push_back(size * gain / Complex(1, each));
        std::vector<double> residuals(points.size() * of.per_point());
        EXPECT_TRUE(of.residuals(model, points.value(), residuals.data()));
        return product(residuals, residuals);
      };
      const double of_all = cost(rule, data, 0.5), of_means = cost(means->rule, means->data, 0.5);
      for (const double gain : {-2.0, 0.9, 3.0}) {
        const double change = cost(rule, data, gain) - of_all;
        EXPECT_NEAR(cost(means->rule, means->data, gain) - of_means, change, 1e-12 * (of_all + std::abs(change)));
      }
    }
  }
}

// Over a bin of width h in ln omega the mean of s^a is off from s^a at the mean frequency by a (a - 1) h^2/24 of it:
// for 100 bins of four decades 2.7e-4, and half as much again for how few points in a bin stand.
TEST(ManyPoints, MeansFollowACurveToSecondOrderOfTheBins) {
  const auto error = [](std::size_t bins) {
    const frac::Structure structure("s^1.5");
    const auto data = support::noisy_response("s^1.5", {}, 0.0, 1u, 20'000);
    const auto rule = frac::detail::residual_rule(data, frac::Component::both, frac::Weight::absolute);
    const auto means = frac::detail::binned(data, rule, bins);
    EXPECT_TRUE(means);
    double largest = 0;
    for (std::size_t i = 0; i < means->data.size(); ++i) {
      const Complex exact = structure.response({}, means->data.omega()[i]);
      largest = std::max(largest, std::abs(means->data.value()[i] / exact - 1.0));
    }
    return largest;
  };
  const double coarse = error(100), fine = error(200);
  EXPECT_LT(coarse, 4e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
}

TEST(ManyPoints, OnlyDifferencesHaveMeans) {
  const auto data = support::noisy_response("1/(s + 1)", {}, 0.01, 1u, 100);
  const auto rule = frac::detail::residual_rule(data, frac::Component::phase, frac::Weight::absolute);
  EXPECT_FALSE(frac::detail::binned(data, rule, 10));
}

// Fits end where a step gains 1e-14 of the cost: 3.5e-5 standard errors of 1.2e5 residuals.  The optimum of every sixth
// point would miss that of all by two.
TEST(ManyPoints, FitsEndAtTheOptimumOfAllOfThem) {
  const struct {
    const char *truth, *model;
  } cases[] = {{"0.5 + 2/(1 + (0.3 s)^0.8)", "K0 + K/(1 + (T s)^a)"},
               {"2/(0.01 s^2 + 0.02 s + 1)", "K/(A s^2 + B s + 1)"},
               {"3/(1 + (2 s)^0.9)^0.6", "K/(1 + (T s)^a)^b"}};
  for (const auto& [truth, model] : cases) {
    const auto data = support::noisy_response(truth, {}, 0.02, 7u, 60'000);
    frac::FitOptions options;
    options.weight = frac::Weight::relative;
    const frac::Structure structure(model);
    const frac::FitResult fit = frac::fit(data, structure, options);
    ASSERT_TRUE(fit.usable()) << model;
    expect_optimum(data, structure, fit, 0);
  }
}

// Noise of standard deviation .01 sqrt(|G|^2 + 1.5^2): a floor is told to within the finest step of its search, .12 in
// the logarithm, as stretches of some of the points tell it to some per cent.  Its own fits end at means of the points,
// the result at the optimum of all; relative noise has no floor.
TEST(ManyPoints, AFloorIsToldByMeansAndFittedOnAllPoints) {
  const frac::Structure structure("K0 + K/(1 + (T s)^a)");
  constexpr double noise = 0.01, floor = 1.5;
  support::Random random(17);
  std::vector<double> omega = support::four_decades(100'000);
  std::vector<Complex> value, relative;
  for (const double each : omega) {
    const Complex exact = structure.response(std::vector<double>{0.5, 2, 0.3, 0.8}, each);
    const Complex drawn = noise * Complex(random.normal(), random.normal());
    value.push_back(exact + drawn * std::hypot(std::abs(exact), floor));
    relative.push_back(exact + drawn * std::abs(exact));
  }
  const frac::FrequencyResponseData data(omega, value);
  const frac::FitResult fit = frac::fit(data, structure, {});
  ASSERT_TRUE(fit.usable());
  EXPECT_NEAR(std::log(fit.noise_floor / floor), 0, 0.15);
  expect_optimum(data, structure, fit, fit.noise_floor);
  for (const frac::ParameterEstimate& each : fit.parameters)
    EXPECT_TRUE(std::isfinite(each.standard_error)) << each.name;
  EXPECT_EQ(frac::fit({omega, relative}, structure, {}).noise_floor, 0);
}

// Two arcs contain one: on data of one they leave no more, and by chance of a parameter some squares of noise less.
// Residuals of both parts have means, those of the magnitude have none.
TEST(ManyPoints, RicherModelsLeaveNoMore) {
  const auto data = support::noisy_response("0.5 + 2/(1 + (0.3 s)^0.8)", {}, 0.02, 9u, 60'000);
  const frac::Structure arc("R0 + R1/(1 + R1 Q1 s^n1)"), arcs("R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)");
  for (const frac::Component component : {frac::Component::both, frac::Component::magnitude}) {
    frac::FitOptions options;
    options.weight = frac::Weight::relative;
    options.component = component;
    const frac::FitResult one = frac::fit(data, arc, options), two = frac::fit(data, arcs, options);
    EXPECT_LE(two.cost, one.cost * (1 + 1e-9));
    EXPECT_GT(two.cost, one.cost * (1 - 1e-3));
  }
}

}  // namespace
