// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/power_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/identification/component_power_law.hpp"
#include "frac/structure.hpp"

namespace {

// Rounding of logarithms of size 10 over spans of a few e-folds: some units of 1e-15.
constexpr double rounding = 1e-13;

TEST(PowerLaw, PassesThroughExactData) {
  std::vector<double> x, y;
  for (int i = 0; i < 9; ++i) {
    x.push_back(0.01 * std::pow(1.7, i));
    y.push_back(3.5 * std::pow(x.back(), -0.62));
  }
  const frac::PowerLaw law = frac::fit_power_law(x, y);
  EXPECT_NEAR(law.exponent, -0.62, rounding);
  EXPECT_NEAR(law.coefficient, 3.5, 3.5 * 10 * rounding);
  EXPECT_NEAR(law.r_squared, 1, rounding);
  EXPECT_NEAR(law(2.0), 3.5 * std::pow(2.0, -0.62), 100 * rounding);
}

// ln x = 0, 1, 2 and ln y = 0, 1.1, 1.9: slope .95, residuals -.05, .1, -.05, so s^2 = .015 with one degree of freedom,
// whose t is tan(.475 pi) = 12.7062047.
TEST(PowerLaw, MatchesARegressionDoneByHand) {
  const std::vector<double> x = {1, std::exp(1.0), std::exp(2.0)};
  const std::vector<double> y = {1, std::exp(1.1), std::exp(1.9)};
  const frac::PowerLaw law = frac::fit_power_law(x, y);
  const double t = std::tan(0.475 * M_PI);
  const double slope_error = std::sqrt(0.015 / 2);
  const double log_coefficient_error = std::sqrt(0.015 * (1.0 / 3 + 0.5));
  EXPECT_NEAR(law.exponent, 0.95, rounding);
  EXPECT_NEAR(law.coefficient, std::exp(0.05), rounding);
  EXPECT_NEAR(law.exponent_standard_error, slope_error, rounding);
  EXPECT_NEAR(law.exponent_ci95_lower, 0.95 - t * slope_error, 1e-9);  // the quantile's own accuracy
  EXPECT_NEAR(law.exponent_ci95_upper, 0.95 + t * slope_error, 1e-9);
  EXPECT_NEAR(std::log(law.coefficient_ci95_upper), 0.05 + t * log_coefficient_error, 1e-9);
  EXPECT_NEAR(std::log(law.coefficient_ci95_lower), 0.05 - t * log_coefficient_error, 1e-9);
  EXPECT_NEAR(law.r_squared, 1 - 0.015 / 1.82, rounding);
  EXPECT_NEAR(law.rms_log_residual, std::sqrt(0.015), rounding);
}

// 4000 trials: the coverage of a 95 % interval scatters by sqrt(.95 .05/4000) = 0.34 %; four of these are allowed.
TEST(PowerLaw, IntervalsCoverTheTruthAtTheirLevel) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> noise(0, 0.1);
  int exponent_covered = 0, coefficient_covered = 0;
  constexpr int trials = 4000;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> x, y;
    for (int i = 0; i < 6; ++i) {
      x.push_back(5.0 * (i + 1));
      y.push_back(2 * std::sqrt(x.back()) * std::exp(noise(generator)));
    }
    const frac::PowerLaw law = frac::fit_power_law(x, y);
    exponent_covered += law.exponent_ci95_lower <= 0.5 && 0.5 <= law.exponent_ci95_upper;
    coefficient_covered += law.coefficient_ci95_lower <= 2 && 2 <= law.coefficient_ci95_upper;
  }
  EXPECT_NEAR(exponent_covered / double(trials), 0.95, 0.014);
  EXPECT_NEAR(coefficient_covered / double(trials), 0.95, 0.014);
}

TEST(PowerLaw, TwoPointsGiveNoInterval) {
  const frac::PowerLaw law = frac::fit_power_law(std::vector<double>{1, 4}, std::vector<double>{3, 6});
  EXPECT_NEAR(law.exponent, 0.5, rounding);
  EXPECT_TRUE(std::isnan(law.exponent_ci95_lower));
  EXPECT_TRUE(std::isnan(law.rms_log_residual));
}

std::string message(const std::vector<double>& x, const std::vector<double>& y) {
  try {
    (void)frac::fit_power_law(x, y);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no exception";
}

TEST(PowerLaw, RefusesWhatHasNoPowerLaw) {
  EXPECT_NE(message({1, 2}, {1}).find("2 x values but 1 y"), std::string::npos);
  EXPECT_NE(message({1}, {1}).find("at least 2"), std::string::npos);
  EXPECT_NE(message({1, -2}, {1, 1}).find("x[1] = -2"), std::string::npos);
  EXPECT_NE(message({1, 2}, {1, NAN}).find("y[1] = nan"), std::string::npos);
  EXPECT_NE(message({2, 2}, {1, 3}).find("all x are equal"), std::string::npos);
}

// Under noise s = 0.1 % least squares of ln y and of relative residuals differ in the coefficient by 3/2 s^2, the mean
// of ln(1 + s n) against that of weights 1/y: under a hundredth of its standard error, which is about 0.2 s here.
TEST(ComponentPowerLaw, AgreesWithTheRegressionOfLogarithmsWhateverTheOtherPart) {
  std::mt19937_64 generator(11);
  std::normal_distribution<double> noise(0, 0.001);
  for (const auto component : {frac::Component::imaginary, frac::Component::real, frac::Component::magnitude}) {
    for (const double exponent : {-3.0, 0.0, 2.0, 14.0 / 3}) {
      std::vector<double> omega, size;
      std::vector<std::complex<double>> value;
      for (int i = 0; i < 40; ++i) {
        omega.push_back(0.2 * std::pow(1.15, i));
        size.push_back(0.7 * std::pow(omega.back(), exponent) * (1 + noise(generator)));
        // The other part is a thousand times as large, and of any shape; a magnitude has a phase of any shape.
        const double other = 1000 * size.back() * std::cos(i);
        value.push_back(component == frac::Component::imaginary ? std::complex<double>(other, -size.back())
                        : component == frac::Component::real    ? std::complex<double>(-size.back(), other)
                                                                : std::polar(size.back(), other));
      }
      const frac::PowerLaw law = frac::fit_power_law(omega, size);
      const frac::NamedModel model = frac::component_power_law(component);
      frac::FitOptions options;
      options.component = component;
      options.weight = frac::Weight::relative;
      options.constraints = model.constraints;
      const auto fit =
          frac::fit(frac::component_alone({omega, value}, component), frac::Structure(model.formula), options);
      ASSERT_TRUE(fit.usable()) << fit.message;
      for (const auto& parameter : fit.parameters) {
        const bool is_exponent = parameter.name == "b";
        const double sign = component == frac::Component::magnitude ? 1 : -1;
        const double expected = is_exponent ? law.exponent : sign * law.coefficient;
        const double error =
            is_exponent ? law.exponent_standard_error : (law.coefficient_ci95_upper - law.coefficient_ci95_lower) / 4;
        EXPECT_NEAR(parameter.value, expected, 0.05 * error) << frac::to_string(component) << exponent;
      }
    }
  }
}

TEST(ComponentPowerLaw, IsOneOfASinglePart) {
  for (const auto component : {frac::Component::both, frac::Component::phase})
    EXPECT_THROW(static_cast<void>(frac::component_power_law(component)), std::invalid_argument);
  // On the imaginary axis the formulas are K omega^b in their part and nothing in the other, also at b = 2.
  for (const double b : {-1.5, 0.0, 2.0, 14.0 / 3}) {
    const auto value = [&](frac::Component component, double omega) {
      const frac::Structure formula(frac::component_power_law(component).formula);
      std::vector<double> parameters;
      for (const auto& name : formula.parameter_names()) parameters.push_back(name == "K" ? 3 : b);
      return formula.response(parameters, omega);
    };
    const double expected = 3 * std::pow(7.0, b);
    EXPECT_NEAR(value(frac::Component::imaginary, 7).imag() / expected, 1, rounding);
    EXPECT_EQ(value(frac::Component::imaginary, 7).real(), 0);
    EXPECT_NEAR(value(frac::Component::real, 7).real() / expected, 1, rounding);
    EXPECT_EQ(value(frac::Component::real, 7).imag(), 0);
  }
}

}  // namespace
