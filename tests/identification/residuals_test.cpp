// SPDX-License-Identifier: BSD-3-Clause
#include "identification/residuals/residuals.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "identification/residuals/parameter_map.hpp"
#include "identification/search/search_starts.hpp"

namespace {

using frac::Component;
using frac::Weight;

struct Case {
  const char* formula;
  std::vector<double> parameters;
  std::vector<frac::ParameterConstraint> constraints;
};

const frac::Realisation exact = frac::ExactRealisation{};
const frac::detail::DataScale scale = {0.3, 0.01, 2, 4, 0.5, 30};

std::vector<Case> cases() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{"K/(T s^a + 1)", {0.8, 0.4, 0.7}, {}},
          {"K exp(-L s)/(T s^a + 1)", {-0.8, 0.05, 0.4, 1.3}, {{"K", {}, -infinity, {}, {}}}},
          {"1/(b2 s^a2 + b1 s^a1 + b0)", {0.8, 2.2, 0.5, 0.9, 1}, {{"b0", {}, 0.5, 3, {}}}},
          {"K/(1 + (T s)^a)^b", {2, 0.3, 0.6, 0.8}, {{"a", {}, 0, 1, {}}}},
          {"R0 + R1/(1 + R1 Q1 s^n1)", {0.1, 0.5, 0.3, 0.8}, {{"R0", 0.1, {}, {}, {}}}}};
}

frac::FrequencyResponseData samples() {
  std::vector<double> omega, sigma;
  std::vector<std::complex<double>> value;
  for (int i = 0; i < 12; ++i) {
    omega.push_back(0.5 * std::pow(1.4, i));
    value.push_back({0.4 + 0.1 * i, -0.3 - 0.05 * i});
    sigma.push_back(0.1 + 0.02 * i);
  }
  return {omega, value, sigma};
}

// Central differences with a step of 1e-5: their own error is about step^2 = 1e-10 times third derivatives plus
// rounding 1e-16/step = 1e-11, both of the size of the residuals (about 1).
void expect_jacobian_of_differences(const Case& test, Component component, Weight weight,
                                    const frac::Realisation& realisation) {
  const frac::FrequencyResponseData data = samples();
  const frac::Structure structure(test.formula);
  const frac::detail::ParameterMap map(structure, test.constraints, scale);
  const std::vector<double> theta = map.to_theta(test.parameters);
  const frac::detail::ResidualRule rule = frac::detail::residual_rule(data, component, weight);
  const frac::detail::FrequencyResiduals residuals(data, structure, realisation, map, rule);
  const std::size_t rows = residuals.count();
  std::vector<double> residual(rows), jacobian(rows * theta.size()), above(rows), below(rows);
  ASSERT_TRUE(residuals.evaluate(theta, residual.data(), jacobian.data()));
  for (std::size_t k = 0; k < theta.size(); ++k) {
    constexpr double step = 1e-5;
    std::vector<double> shifted = theta;
    shifted[k] += step;
    ASSERT_TRUE(residuals.evaluate(shifted, above.data(), nullptr));
    shifted[k] -= 2 * step;
    ASSERT_TRUE(residuals.evaluate(shifted, below.data(), nullptr));
    for (std::size_t i = 0; i < rows; ++i) {
      const double difference = (above[i] - below[i]) / (2 * step);
      EXPECT_NEAR(jacobian[k * rows + i], difference, 1e-7 * (1 + std::abs(difference)))
          << test.formula << ' ' << frac::to_string(component) << ' ' << frac::to_string(weight) << ' '
          << frac::to_string(realisation) << " row " << i << " column " << k;
    }
  }
}

TEST(Residuals, JacobianAgreesWithDifferencesForEveryComponentAndWeight) {
  for (const Case& test : cases()) {
    for (const Component component :
         {Component::imaginary, Component::real, Component::both, Component::magnitude, Component::phase}) {
      for (const Weight weight :
           {Weight::relative, Weight::absolute, Weight::given, Weight::smoothed_relative, Weight::log_complex}) {
        if (weight == Weight::log_complex && (component == Component::imaginary || component == Component::real))
          continue;
        expect_jacobian_of_differences(test, component, weight, frac::ExactRealisation{});
      }
    }
  }
}

TEST(Residuals, JacobianAgreesWithDifferencesThroughEveryRealisation) {
  for (const Case& test : cases()) {
    // Its outer power is not one of s, so no realisation expresses it.
    if (test.formula == std::string("K/(1 + (T s)^a)^b")) continue;
    for (const frac::Realisation& realisation : {frac::Realisation(frac::OustaloupRealisation{{1e-2, 1e3}, 6}),
                                                 frac::Realisation(frac::LadderRealisation({1e-2, 1e3}, 6)),
                                                 frac::Realisation(frac::GrunwaldLetnikovRealisation{0.05, 0}),
                                                 frac::Realisation(frac::GrunwaldLetnikovRealisation{0.05, 100})}) {
      expect_jacobian_of_differences(test, Component::both, Weight::relative, realisation);
    }
  }
}

// With the best factor the cost is what was foretold, to rounding of sums of squares.  Nothing is foretold of the
// phase, nor where the bounds of b0 cut the factor or R0 is known.
TEST(Residuals, TheBestFactorTellsTheCostWithIt) {
  const frac::FrequencyResponseData data = samples();
  int untold = 0;
  for (const Case& test : cases()) {
    const frac::Structure structure(test.formula);
    const frac::detail::ParameterMap map(structure, test.constraints, scale);
    const std::string first = structure.parameter_names().front();
    for (const Component component :
         {Component::imaginary, Component::real, Component::both, Component::magnitude, Component::phase}) {
      for (const Weight weight : {Weight::relative, Weight::absolute, Weight::given, Weight::log_complex}) {
        if (weight == Weight::log_complex && (component == Component::imaginary || component == Component::real))
          continue;
        const frac::detail::ResidualRule rule = frac::detail::residual_rule(data, component, weight);
        const frac::detail::FrequencyResiduals residuals(data, structure, exact, map, rule);
        std::vector<double> theta = map.to_theta(test.parameters);
        const double before = residuals.cost(theta), told = frac::detail::match_magnitude(residuals, theta),
                     after = residuals.cost(theta);
        const double rounding = 1e-13 * (before + after);
        if (told == 0) {
          ++untold;
          EXPECT_TRUE(component == Component::phase || first == "R0" || first == "b2") << test.formula;
          continue;
        }
        EXPECT_NEAR(after, told, rounding)
            << test.formula << ' ' << frac::to_string(component) << ' ' << frac::to_string(weight);
        EXPECT_LE(after, before + rounding);
      }
    }
  }
  // Of the 18 pairs of component and weight all of R0, those of the phase, and some of b0.
  EXPECT_LT(untold, 18 + 4 * 4 + 14);
}

// An unstable model costs a million times as much, squared, with the factor too.
TEST(Residuals, TheBestFactorTellsTheCostOfAnUnstableModel) {
  const frac::FrequencyResponseData data = samples();
  const frac::Structure structure("K/(T s + 1)");
  const frac::detail::ParameterMap map(structure, {{"T", {}, -std::numeric_limits<double>::infinity(), {}, {}}}, scale);
  const frac::detail::ResidualRule rule = frac::detail::residual_rule(data, Component::both, Weight::relative);
  const auto costs = [&](bool only_stable) {
    const frac::detail::FrequencyResiduals residuals(data, structure, exact, map, rule, only_stable);
    std::vector<double> theta = map.to_theta(std::vector<double>{0.8, -0.4});
    const double told = frac::detail::match_magnitude(residuals, theta);
    return std::pair(told, residuals.cost(theta));
  };
  const auto [told, cost] = costs(true);
  EXPECT_NEAR(told, cost, 1e-12 * cost);
  EXPECT_NEAR(told, 1e12 * costs(false).first, 1e-3 * told);
}

/// Counts the costs that are computed, and may keep to itself what is known of them beforehand.
class Counted final : public frac::detail::Residuals {
 public:
  Counted(const frac::detail::FrequencyResiduals& residuals, bool tells)
      : Residuals(residuals.map()), residuals_(residuals), tells_(tells) {}
  [[nodiscard]] std::size_t points() const noexcept override { return residuals_.points(); }
  [[nodiscard]] std::size_t per_point() const noexcept override { return residuals_.per_point(); }
  bool evaluate(std::span<const double> theta, double* residual, double* jacobian) const override {
    ++costs;
    return residuals_.evaluate(theta, residual, jacobian);
  }
  [[nodiscard]] BestFactor best_factor(std::span<const double> theta) const override {
    const BestFactor best = residuals_.best_factor(theta);
    return tells_ ? best : BestFactor{best.factor};
  }
  mutable std::size_t costs = 0;

 private:
  const frac::detail::FrequencyResiduals& residuals_;
  bool tells_;
};

// The best of twelve draws for each of five starts is the same whether their costs are known beforehand, where that of
// the best is the only one to compute, or each is computed.
TEST(Residuals, DrawsAreComparedByTheirCosts) {
  const frac::FrequencyResponseData data = samples();
  for (const char* formula : {"K/(T s^a + 1)", "K/(T s + 1) + 1", "R + 1/(Q s)^a"}) {
    const frac::Structure structure(formula);
    const frac::detail::ParameterMap map(structure, {}, scale);
    const frac::detail::ResidualRule rule = frac::detail::residual_rule(data, Component::both, Weight::relative);
    const frac::detail::FrequencyResiduals residuals(data, structure, exact, map, rule);
    const Counted known(residuals, true), unknown(residuals, false);
    for (unsigned seed = 1; seed <= 20; ++seed) {
      std::mt19937_64 one(seed), other(seed);
      EXPECT_EQ(frac::detail::screened_draws(known, {}, one, false),
                frac::detail::screened_draws(unknown, {}, other, false))
          << formula << seed;
    }
    EXPECT_EQ(unknown.costs, 20U * 5 * 12) << formula;
    // Two that differ by rounding are both computed.
    if (map.scales_as_a_whole()) {
      EXPECT_LT(known.costs, 20U * 5 * 2) << formula;
    }
  }
}

// A start may be so far below the data that their difference has no digit of it left.
TEST(Residuals, TheBestFactorIsThatOfAModelFarBelowTheData) {
  const frac::FrequencyResponseData data = samples();
  const frac::Structure structure("K/(T s^a + 1)");
  const frac::detail::ParameterMap map(structure, {}, scale);
  for (const Component component : {Component::imaginary, Component::real, Component::both, Component::magnitude}) {
    const frac::detail::ResidualRule rule = frac::detail::residual_rule(data, component, Weight::absolute);
    const frac::detail::FrequencyResiduals residuals(data, structure, exact, map, rule);
    const auto matched = [&](double gain) {
      std::vector<double> theta = map.to_theta(std::vector<double>{gain, 0.4, 0.7});
      const double told = frac::detail::match_magnitude(residuals, theta);
      return std::pair(map.to_user(theta)[0], told);
    };
    const auto [gain, cost] = matched(1);
    for (const double start : {1e-20, 1e-15, 1e15}) {
      EXPECT_NEAR(matched(start).first, gain, 1e-12 * gain) << frac::to_string(component) << start;
      EXPECT_NEAR(matched(start).second, cost, 1e-12 * cost) << frac::to_string(component) << start;
    }
  }
}

// By the model itself, with each value times 2 to its exponent.  A number in a sum, an exponent that changes with an
// order, a known gain and a limit in the unit of the model keep the whole from doubling, and what it then costs is not
// that of twice the model.
TEST(ParameterMap, TellsWhichModelsScaleAsAWhole) {
  const auto ordered = [](std::optional<double> most, bool positive) {
    frac::ParameterConstraint lesser{"A", {}, {}, {}, {}}, greater{"B", {}, {}, most, {}};
    greater.above = "A";
    lesser.positive = greater.positive = positive;
    return std::vector{lesser, greater};
  };
  std::vector<Case> all = cases();
  all.insert(all.end(), {{"K/(T s + 1)", {2, 0.4}, {{"T", 0.4, {}, {}, {}}}},
                         {"K/(T s + 1)", {2, 0.4}, {{"K", 2, {}, {}, {}}}},
                         {"K/(T s + 1) + 1", {2, 0.4}, {}},
                         {"1/(T s + 1)", {0.4}, {}},
                         {"R + 1/(Q s)^a", {0.5, 2, 0.7}, {}},
                         {"A + B/(T s + 1)", {0.5, 2, 0.4}, ordered({}, false)},
                         {"A + B/(T s + 1)", {0.5, 2, 0.4}, ordered({}, true)},
                         {"A + B/(T s + 1)", {0.5, 2, 0.4}, ordered(3, true)},
                         {"A + K/(B s + 1)", {0.5, 1, 2}, ordered({}, true)}});
  int scaling = 0;
  for (const auto& [formula, parameters, constraints] : all) {
    const frac::Structure structure(formula);
    const frac::detail::ParameterMap map(structure, constraints, scale);
    std::vector<double> theta = map.to_theta(parameters);
    const std::vector<double> before = map.to_user(theta);
    for (std::size_t k = 0; k < theta.size(); ++k) {
      const frac::detail::ParameterMap::Free& entry = map.free()[k];
      const double factor = std::pow(2, entry.value_exponent);
      theta[k] = entry.logarithmic ? theta[k] + std::log(factor) : theta[k] * factor;
    }
    const std::vector<double> after = map.to_user(theta);
    bool doubles = true;
    for (const double omega : {1.0, 4.0, 9.0}) {
      const std::complex<double> twice = 2.0 * structure.response(before, omega, exact);
      doubles = doubles && std::abs(structure.response(after, omega, exact) - twice) <= 1e-13 * std::abs(twice);
    }
    EXPECT_EQ(map.scales_as_a_whole(), doubles) << formula << ' ' << constraints.size();
    scaling += doubles;
  }
  EXPECT_EQ(scaling, 4 + 3);
}

TEST(ParameterMap, ThetaAndParametersAreOneToOne) {
  for (const Case& test : cases()) {
    const frac::detail::ParameterMap map(frac::Structure(test.formula), test.constraints, scale);
    const std::vector<double> back = map.to_user(map.to_theta(test.parameters));
    for (std::size_t i = 0; i < back.size(); ++i) {
      // exp(log(p)) loses a few units of the last place times |log p| <= 10.
      EXPECT_NEAR(back[i], test.parameters[i], 1e-14 * std::abs(test.parameters[i])) << test.formula << ' ' << i;
    }
  }
}

// Seven poles three decades below a band of five have a product of 10^56 times the size of a coefficient at its upper
// end.
TEST(ParameterMap, SumsOverDistantPolesAreWithinReach) {
  const frac::Structure structure("(b0 + b1 s)/((s/p1 + 1) (s/p2 + 1))");
  const frac::detail::ParameterMap map(structure, {}, scale);
  const std::vector<double> far = {1e56, -1e56, 1e-8, 1e-8};
  const std::vector<double> back = map.to_user(map.to_theta(far));
  ASSERT_EQ(back.size(), far.size());
  for (std::size_t i = 0; i < back.size(); ++i) EXPECT_NEAR(back[i], far[i], 1e-14 * std::abs(far[i])) << i;
}

// Relative magnitude residuals are logarithms of the ratio, phase residuals its angle: closed forms for a model twice
// the data and turned by half a radian.
TEST(Residuals, FollowTheirDefinitions) {
  const std::complex<double> datum(0.3, -0.4);
  const frac::FrequencyResponseData data({2.0}, {datum}, {0.1});
  const std::vector<std::complex<double>> model = {datum * std::polar(2.0, 0.5)};
  const auto residual = [&](Component component, Weight weight) {
    return frac::detail::curve_residuals(data, frac::detail::residual_rule(data, component, weight), model);
  };
  constexpr double rounding = 1e-15;
  EXPECT_NEAR(residual(Component::magnitude, Weight::relative)[0], std::log(2.0), rounding);
  EXPECT_NEAR(residual(Component::magnitude, Weight::absolute)[0], 0.5, rounding);
  EXPECT_NEAR(residual(Component::magnitude, Weight::given)[0], 5, 1e-14);
  EXPECT_NEAR(residual(Component::phase, Weight::relative)[0], 0.5, rounding);
  EXPECT_NEAR(residual(Component::phase, Weight::given)[0], 0.5 * 0.5 / 0.1, 1e-14);
  EXPECT_NEAR(residual(Component::both, Weight::log_complex)[0], std::log(2.0), rounding);
  EXPECT_NEAR(residual(Component::both, Weight::log_complex)[1], 0.5, rounding);
  const std::complex<double> difference = model[0] - datum;
  EXPECT_NEAR(residual(Component::imaginary, Weight::relative)[0], difference.imag() / 0.5, rounding);
  EXPECT_NEAR(residual(Component::both, Weight::absolute)[0], difference.real(), rounding);
  EXPECT_NEAR(residual(Component::both, Weight::absolute)[1], difference.imag(), rounding);
}

// Repeats at +-d around their mean have variance 2 d^2/(2 (2 - 1)) = d^2 per part; relative deviations are the same at
// every frequency here, so pooling changes nothing.
TEST(Residuals, RepeatsTellTheNoise) {
  const std::complex<double> a(3, 4), b(0, -10);
  const double relative = 0.01;
  const frac::FrequencyResponseData data(
      {1, 1, 2, 2}, {a * (1 + relative), a * (1 - relative), b * (1 + relative), b * (1 - relative)});
  const auto rule = frac::detail::residual_rule(data, Component::both, Weight::repeats);
  EXPECT_NEAR(rule.weight[0] * rule.unit, 1 / (5 * relative), 1e-10);
  EXPECT_NEAR(rule.weight[3] * rule.unit, 1 / (10 * relative), 1e-10);
  EXPECT_THROW((void)frac::detail::residual_rule({{1, 1, 2}, {a, b, a}}, Component::both, Weight::repeats),
               std::invalid_argument);
  EXPECT_THROW((void)frac::detail::residual_rule({{1, 1}, {a, a}}, Component::both, Weight::repeats),
               std::invalid_argument);
}

// Repeats at 1 +- r have the relative variance r^2 per part, as above; that at a frequency is the mean over it and up
// to two on either side.
TEST(Residuals, RepeatsArePooledOverFiveFrequencies) {
  const std::vector<double> relative{0.01, 0.05, 0.02, 0.04, 0.03, 0.2};
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (std::size_t k = 0; k < relative.size(); ++k) {
    omega.insert(omega.end(), 2, static_cast<double>(k + 1));
    value.insert(value.end(), {1 + relative[k], 1 - relative[k]});
  }
  const auto rule = frac::detail::residual_rule({omega, value}, Component::both, Weight::repeats);
  for (std::size_t k = 0; k < relative.size(); ++k) {
    double sum = 0, count = 0;
    for (std::size_t j = 0; j < relative.size(); ++j) {
      if (std::max(j, k) - std::min(j, k) > 2) continue;
      sum += relative[j] * relative[j];
      ++count;
    }
    EXPECT_NEAR(rule.weight[2 * k] * rule.unit * std::sqrt(sum / count), 1, 1e-12) << k;
  }
}

// On a pure power law the smoothed magnitude is the magnitude itself: a straight line in logarithms.
TEST(Residuals, SmoothingKeepsAPowerLaw) {
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (int i = 0; i < 20; ++i) {
    omega.push_back(0.1 * std::pow(1.3, i));
    value.push_back(2.0 * std::pow(omega.back(), -0.7));
  }
  const frac::FrequencyResponseData data(omega, value);
  const auto smooth = frac::detail::residual_rule(data, Component::both, Weight::smoothed_relative);
  for (std::size_t i = 0; i < omega.size(); ++i)
    EXPECT_NEAR(smooth.weight[i] * smooth.unit * std::abs(value[i]), 1, 1e-12);
}

// A resonance of 1/(1 + 0.1 s + s^2), its half width (5 %) four points.  A line through two neighbours of the peak
// misses it by ln(1 + (1/4)^2)/2 = 0.03, one through eight by 0.15; noise of 1 % adds at most four standard deviations
// of what two neighbours leave, 0.028.  On the flanks the smoothed magnitude must be better than the data.
TEST(Residuals, SmoothingKeepsAResonance) {
  const frac::Structure structure("1/(1 + 0.1 s + s^2)");
  std::mt19937_64 generator(4);
  std::normal_distribution<double> normal(0, 0.01);
  std::vector<double> omega, exact;
  std::vector<std::complex<double>> value;
  for (int i = 0; i < 400; ++i) {
    omega.push_back(0.1 * std::pow(100.0, i / 399.0));
    const std::complex<double> response = structure.response({}, omega.back());
    exact.push_back(std::abs(response));
    const double real = normal(generator), imaginary = normal(generator);
    value.push_back(response * (1.0 + std::complex<double>(real, imaginary)));
  }
  const frac::FrequencyResponseData data(omega, value);
  const auto smooth = frac::detail::residual_rule(data, Component::both, Weight::smoothed_relative);
  double raw_square = 0, smooth_square = 0;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const double error = std::log(1 / (smooth.weight[i] * smooth.unit * exact[i]));
    EXPECT_NEAR(error, 0, 0.06) << "omega " << omega[i];
    raw_square += std::pow(std::log(std::abs(value[i]) / exact[i]), 2);
    smooth_square += error * error;
  }
  // A line through two neighbours keeps half of the variance, one through eight an eighth; the peak adds its curvature.
  EXPECT_LT(smooth_square, 0.7 * raw_square);
}

TEST(Residuals, LogComplexNeedsMagnitudeOrPhase) {
  const frac::FrequencyResponseData data({1}, {{1, 1}});
  EXPECT_THROW((void)frac::detail::residual_rule(data, Component::imaginary, Weight::log_complex),
               std::invalid_argument);
}

}  // namespace
