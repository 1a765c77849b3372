// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/identification/constraints.hpp"
#include "frac/identification/fit.hpp"
#include "frac/identification/model_library.hpp"
#include "support/both_parts.hpp"
#include "support/random.hpp"
#include "support/random_spelling.hpp"

namespace {

using frac::NamedModel;
using frac::Structure;

constexpr double infinity = std::numeric_limits<double>::infinity();

const frac::ParameterConstraint* constraint_on(const NamedModel& model, const std::string& name) {
  const auto found = std::find_if(model.constraints.begin(), model.constraints.end(),
                                  [&](const auto& each) { return each.name == name; });
  return found == model.constraints.end() ? nullptr : &*found;
}

/// Data of a preset with random parameters within its limits, 40 points with 1 % noise in either part.
frac::FrequencyResponseData data_of(const NamedModel& model, support::Random& random) {
  const Structure structure(model.formula);
  std::vector<double> values;
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    const auto* own = constraint_on(model, structure.parameter_names()[i]);
    const double lower = own != nullptr ? own->lower.value_or(0) : 0,
                 upper = own != nullptr ? own->upper.value_or(4) : 4;
    const bool is_order = structure.parameter_roles()[i] == frac::ParameterRole::order;
    values.push_back(is_order ? random.uniform(std::max(lower, -0.9), std::min(upper, 0.95))
                              : random.log_uniform(0.3, 3));
  }
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (int k = 0; k < 40; ++k) {
    omega.push_back(std::pow(10, -1.5 + 3.0 * k / 39));
    const std::complex<double> noise(random.normal(), random.normal());
    value.push_back(structure.response(values, omega.back()) * (1.0 + 0.01 * noise));
  }
  return {omega, value};
}

frac::FitResult fitted(const frac::FrequencyResponseData& data, const NamedModel& model) {
  frac::FitOptions options = support::both_parts();
  options.constraints = model.constraints;
  return frac::fit(data, Structure(model.formula), options);
}

// A preset is recognised however it is written, and its limits come with it, under the names of the writer.
TEST(ModelSpelling, EveryPresetIsRecognised) {
  for (const NamedModel& preset : frac::model_library()) {
    const Structure structure(preset.formula);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const support::RandomSpelling spelling(structure, seed);
      const NamedModel found = frac::find_model(spelling.text());
      ASSERT_EQ(found.name, preset.name) << spelling.text();
      EXPECT_EQ(found.model_class, preset.model_class);
      ASSERT_EQ(found.constraints.size(), preset.constraints.size());
      const Structure read(found.formula);
      ASSERT_TRUE(structure.correspondence(read)) << found.formula;
      for (std::size_t i = 0; i < read.parameter_names().size(); ++i) {
        const auto* const mine = constraint_on(preset, structure.parameter_names()[i]);
        const auto* const theirs = constraint_on(found, read.parameter_names()[i]);
        ASSERT_EQ(mine != nullptr, theirs != nullptr) << found.formula;
        if (mine == nullptr) continue;
        EXPECT_EQ(mine->lower, theirs->lower);
        EXPECT_EQ(mine->upper, theirs->upper);
        EXPECT_EQ(mine->positive, theirs->positive);
      }
    }
  }
}

TEST(ModelSpelling, NoPresetIsTakenForAnother) {
  for (const NamedModel& one : frac::model_library())
    for (const NamedModel& other : frac::model_library())
      EXPECT_EQ(Structure(one.formula).correspondence(Structure(other.formula)).has_value(), one.name == other.name)
          << one.name << " and " << other.name;
}

// The computation is the same but for the names; only where like parts change places may a sum be rounded otherwise.
TEST(ModelSpelling, ChangesNoFit) {
  support::Random random(3);
  for (const char* name : {"two-power-laws", "fractional-oscillator", "zarc", "r-l-cpe", "two-order-zener",
                           "inertia-and-power-law", "two-rc", "oscillator-delay"}) {
    const NamedModel preset = frac::find_model(name);
    const auto data = data_of(preset, random);
    const frac::FitResult result = fitted(data, preset);
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      const support::RandomSpelling spelling(Structure(preset.formula), seed);
      EXPECT_NEAR(fitted(data, frac::find_model(spelling.text())).cost / result.cost, 1, 1e-10)
          << name << ": " << spelling.text();
    }
  }
}

// Every coefficient of a preset's sum that could be of either sign says which it may have: none rests on the default
// for formulas of the user's own.
TEST(ModelSpelling, PresetsStateTheSignsOfTheirGains) {
  for (const NamedModel& preset : frac::model_library()) {
    const Structure structure(preset.formula);
    for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
      const std::string& name = structure.parameter_names()[i];
      const bool is_gain_in_sum = structure.parameter_roles()[i] == frac::ParameterRole::coefficient &&
                                  structure.parameter_in_sum()[i] && !structure.parameter_keeps_sign()[i];
      const auto* const own = constraint_on(preset, name);
      EXPECT_TRUE(!is_gain_in_sum || (own != nullptr && (own->positive || own->lower))) << preset.name << ", " << name;
    }
  }
}

frac::FrequencyResponseData sampled(const char* formula) {
  const Structure structure(formula);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (int k = 0; k < 41; ++k) {
    omega.push_back(std::pow(10, -2 + 0.1 * k));
    value.push_back(structure.response({}, omega.back()));
  }
  return {omega, value};
}

// Exact data of exact models, so that the search ends at rounding: eight digits of any parameter.
TEST(ModelSpelling, GainsOfAFormulaAreOfEitherSign) {
  const auto data = sampled("2 s^0.5 - 0.5 s^0.9");
  for (const char* formula : {"K1 s^a1 + K2 s^a2", "K1 s^a1+K2 s^a2", "s^a2*K2+s^a1*K1", "K1*(s^(a1))+(K2)*s^a2"}) {
    const frac::FitResult result = fitted(data, frac::find_model(formula));
    ASSERT_TRUE(result.usable()) << formula;
    EXPECT_LT(result.rms, 1e-9) << formula;
    for (const frac::ParameterEstimate& each : result.parameters) {
      const double truth = each.name == "K1" ? 2 : each.name == "K2" ? -0.5 : each.name == "a1" ? 0.5 : 0.9;
      EXPECT_NEAR(each.value, truth, 1e-8) << formula << ", " << each.name;
    }
  }
  // One that is no preset.
  const auto other = sampled("2 s^0.5 - 0.5 s^0.9 - 3/(1 + 2 s)");
  const frac::FitResult result = fitted(other, frac::find_model("A s^0.5 + B s^a + R/(1 + T s)"));
  ASSERT_TRUE(result.usable());
  EXPECT_NEAR(result.parameters[0].value, 2, 1e-7);
  EXPECT_NEAR(result.parameters[1].value, -0.5, 1e-7);
}

// The least |s^0.5| of the data is 0.1, ten times |T|, so that the best T >= 0 is 0, where the response is off by a
// tenth at most.
TEST(ModelSpelling, SaysWhichDefaultLimitWasReached) {
  const auto data = sampled("3/(s^0.5 - 0.01)");
  const Structure structure("K/(s^0.5 + T)");
  frac::FitOptions options = support::both_parts();
  const frac::FitResult held = frac::fit(data, structure, options);
  EXPECT_LT(held.rms, 0.1);
  ASSERT_EQ(held.advice.size(), 1u) << held.message;
  EXPECT_EQ(held.advice[0].remedy, frac::Remedy::give_limits);
  EXPECT_EQ(held.advice[0].parameters, std::vector<std::string>{"T"});
  EXPECT_NE(held.message.find("T is taken as positive"), std::string::npos) << held.message;
  EXPECT_EQ(held.parameters[1].lower_limit, 0);
  EXPECT_EQ(held.parameters[1].upper_limit, infinity);
  EXPECT_EQ(held.parameters[0].lower_limit, -infinity);
  options.constraints = {{"T", {}, -infinity, {}, {}}};
  const frac::FitResult free = frac::fit(data, structure, options);
  EXPECT_NEAR(free.parameters[1].value, -0.01, 1e-9);
  EXPECT_TRUE(free.advice.empty());
  EXPECT_EQ(free.parameters[1].lower_limit, -infinity);
}

TEST(ModelSpelling, SaysNothingOfLimitsThatWereGiven) {
  frac::FitOptions options = support::both_parts();
  options.constraints = {{"a", {}, 0.5, 0.7, {}}};
  const frac::FitResult given = frac::fit(sampled("2/(0.5 s^0.9 + 1)"), Structure("K/(T s^a + 1)"), options);
  EXPECT_TRUE(given.parameters[2].at_bound);
  EXPECT_TRUE(given.advice.empty()) << given.message;
  EXPECT_EQ(given.parameters[2].lower_limit, 0.5);
  EXPECT_EQ(given.parameters[2].upper_limit, 0.7);
  // An order of 4.4 is beyond the default.
  options.constraints = {};
  const frac::FitResult by_default = frac::fit(sampled("2 + s^4.4"), Structure("c + A s^q"), options);
  ASSERT_EQ(by_default.advice.size(), 1u);
  EXPECT_NE(by_default.message.find("q is taken from -4 to 4"), std::string::npos) << by_default.message;
}

// Nobody means the formula of one parameter Lag, or the difference of Two and Rc.
TEST(ModelSpelling, RefusesAPresetInOtherLetters) {
  for (const char* text : {"Lag", "LAG", "Gain", "power_law", "Two-RC", "Rational", "Cole-Cole", "two zarc", "Two Zarc",
                           "fractional  lag", "tworc"}) {
    try {
      (void)frac::find_model(text);
      FAIL() << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("did you mean"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(frac::find_model("Km").name, "gain");
}

// Two factors of one constant have no values of their own.
TEST(ModelSpelling, RefusesProductsWithoutS) {
  const auto data = sampled("2");
  for (const char* text : {"to zarc", "warburg/short", "cole*kole"}) {
    try {
      (void)frac::fit(data, Structure(text), {});
      FAIL() << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("no s in it"), std::string::npos) << error.what();
    }
  }
  EXPECT_NEAR(frac::fit(data, Structure("K"), {}).parameters[0].value, 2, 1e-9);
}

}  // namespace
