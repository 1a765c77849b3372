// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/identify.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/both_parts.hpp"
#include "support/noisy_response.hpp"

namespace {

using frac::Component;
using frac::ModelClass;
using frac::Verdict;
using support::both_parts;

constexpr int points = 80;

std::vector<double> grid() {
  return support::four_decades(points);
}

frac::FrequencyResponseData noisy(const char* formula, const std::vector<double>& parameters, double noise,
                                  unsigned seed) {
  return support::noisy_response(formula, parameters, noise, seed, points);
}

std::vector<frac::NamedModel> models(const std::vector<std::string>& names) {
  std::vector<frac::NamedModel> result;
  for (const std::string& name : names) result.push_back(frac::find_model(name));
  return result;
}

TEST(Identify, SupportsAFractionalOrderWhereThereIsOne) {
  const auto result = frac::identify(noisy("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 1),
                                     models({"power-law", "fractional-lag", "lag", "oscillator"}), {}, both_parts());
  EXPECT_EQ(result.ranking[result.chosen].name, "fractional-lag");
  EXPECT_EQ(result.verdict, Verdict::fractional_supported) << result.verdict_sentence;
  EXPECT_NE(result.verdict_sentence.find("a = 0.6"), std::string::npos) << result.verdict_sentence;
}

// Twenty seeds of data from an integer-order lag: a 5 % test may call for the fractional order now and then, evidence
// above 10 (likelihood ratio 150) has a chance of some 1e-3 each.
TEST(Identify, DoesNotInventAFractionalOrder) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto result =
        frac::identify(noisy("K/(T s + 1)", {2, 0.5}, 0.01, seed), models({"fractional-lag", "lag"}), {}, both_parts());
    EXPECT_NE(result.verdict, Verdict::fractional_supported) << seed << ": " << result.verdict_sentence;
  }
}

TEST(Identify, ChoosesTheSimplestOfWhatTheDataCannotTellApart) {
  // On data of a plain lag the fractional lag fits as well, with one parameter more.
  const auto result = frac::identify(noisy("K/(T s + 1)", {2, 0.5}, 0.01, 3),
                                     models({"fractional-lag", "lag", "oscillator"}), {}, both_parts());
  EXPECT_EQ(result.ranking[result.chosen].name, "lag");
}

TEST(Identify, RanksACurveWithoutParameters) {
  const frac::Structure structure("K/(T s^2 + 1)");
  std::vector<std::complex<double>> curve;
  std::mt19937_64 generator(4);
  std::normal_distribution<double> normal(0, 0.01);
  std::vector<std::complex<double>> value;
  for (const double w : grid()) {
    curve.push_back({1 + w, std::sin(w) - 2});
    value.push_back(curve.back() * (1.0 + normal(generator)));
  }
  const auto result =
      frac::identify({grid(), value}, models({"lag", "power-law"}), {{"static-backlash", curve}}, both_parts());
  EXPECT_EQ(result.ranking.front().name, "static-backlash");
  EXPECT_EQ(result.ranking.front().model_class, ModelClass::fixed_curve);
  EXPECT_TRUE(result.ranking.front().fit.parameters.empty());
  EXPECT_EQ(result.verdict, Verdict::fractional_not_supported) << result.verdict_sentence;
  EXPECT_LT(result.evidence, 0);
}

TEST(Identify, RankingIsByAiccAndWeightsSumToOne) {
  const auto result =
      frac::identify(noisy("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.05, 2),
                     models({"lag", "power-law", "fractional-lag", "two-power-laws"}), {}, both_parts());
  double total = 0;
  for (std::size_t i = 0; i < result.ranking.size(); ++i) {
    total += result.ranking[i].akaike_weight;
  }
  for (std::size_t i = 1; i < result.ranking.size(); ++i) {
    EXPECT_LE(result.ranking[i - 1].fit.aicc, result.ranking[i].fit.aicc);
  }
  EXPECT_NEAR(total, 1, 1e-12);
  EXPECT_EQ(result.ranking.front().delta_aicc, 0);
}

TEST(Identify, DoesNotDependOnThreads) {
  const auto data = noisy("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.05, 2);
  const auto list = models({"lag", "power-law", "fractional-lag"});
  const auto one = frac::identify(data, list, {}, both_parts(), 1),
             two = frac::identify(data, list, {}, both_parts(), 2);
  ASSERT_EQ(one.ranking.size(), two.ranking.size());
  for (std::size_t i = 0; i < one.ranking.size(); ++i) EXPECT_EQ(one.ranking[i].fit.cost, two.ranking[i].fit.cost);
}

TEST(Identify, SaysWhatItSkipped) {
  const frac::FrequencyResponseData data({1.0}, {{1, -1}});
  const auto result = frac::identify(data, models({"gain", "two-zarc"}), {}, both_parts());
  ASSERT_EQ(result.skipped.size(), 1u);
  EXPECT_NE(result.skipped[0].find("two-zarc: 2 residuals"), std::string::npos) << result.skipped[0];
}

TEST(Identify, RefusesEmptyAndMismatchedInput) {
  const auto data = noisy("K", {2}, 0.01, 1);
  EXPECT_THROW((void)frac::identify(data, {}, {}, both_parts()), std::invalid_argument);
  EXPECT_THROW((void)frac::identify(data, {}, {{"short", {1.0}}}, both_parts()), std::invalid_argument);
}

TEST(ModelLibrary, EveryPresetParsesAndIsConstrainedByName) {
  std::set<std::string> names;
  for (const frac::NamedModel& model : frac::model_library()) {
    EXPECT_TRUE(names.insert(model.name).second) << model.name;
    const frac::Structure structure(model.formula);
    for (const auto& constraint : model.constraints) EXPECT_NO_THROW((void)structure.parameter_index(constraint.name));
    EXPECT_EQ(model.model_class == ModelClass::fractional, structure.has_fractional_order()) << model.name;
  }
}

TEST(ModelLibrary, TakesAFormulaForAName) {
  EXPECT_EQ(frac::find_model("K/(T s^0.5 + 1)").model_class, ModelClass::fractional);
  EXPECT_EQ(frac::find_model("K/(T s^2 + 1)").model_class, ModelClass::integer_order);
  EXPECT_EQ(frac::find_model("lag").formula, "K/(T s + 1)");
  EXPECT_THROW((void)frac::find_model("K/(T s"), frac::FormulaError);
}

}  // namespace
