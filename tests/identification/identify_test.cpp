// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/identify.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/identification/statistics.hpp"
#include "frac/identification/validate.hpp"
#include "identification/verdict/equivalent_candidates.hpp"
#include "identification/verdict/evidence.hpp"
#include "identification/verdict/ruling.hpp"
#include "support/both_parts.hpp"
#include "support/noisy_response.hpp"
#include "support/random.hpp"

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

// Ratios of more parameters are as good by AICc, which rewards what follows the noise.  Nobody is told to use these
// while the verdict, undecided, prefers a simpler model that follows the data.
TEST(Identify, UndecidedItDoesNotChooseMoreParametersThanItsVerdictPrefers) {
  int undecided = 0;
  for (const char* formula : {"1/(s^2 + 0.3 s^0.5 + 1)", "((s + 1)/(0.05 s + 1))^0.5"}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const auto result = frac::identify(noisy(formula, {}, 0.1, seed), frac::default_candidates(), {}, both_parts());
      if (result.verdict != Verdict::undecided) continue;
      const frac::Finalist& preferred = result.evidence > 0 ? *result.fractional : *result.integer;
      if (!result.ranking[preferred.index].lack_of_fit.adequate) continue;
      ++undecided;
      EXPECT_LE(result.ranking[result.chosen].fit.free_parameters, preferred.parameters) << formula << ' ' << seed;
    }
  }
  EXPECT_GE(undecided, 3);
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

// Whatever the ranking thinks of a structure, its row is the optimum of that structure: no higher than what fit() finds
// from other draws.  Two solves of one minimum agree to 1e-6; another minimum of these data is 1.5 % or more above.  A
// search by itself finds the lowest with probability .95, so that fit() misses more than 5 of 30 in 1 of 300 rankings.
TEST(Identify, EveryRowIsTheOptimumOfItsStructure) {
  frac::FitOptions options = both_parts();
  options.weight = frac::Weight::relative;
  const auto data = noisy("K s^a/(T s^b + 1)", {2, 0.3, 0.5, 0.8}, 0.003, 11);
  const auto result = frac::identify(data, frac::default_candidates(), {}, options);
  options.seed = 2;
  int compared = 0, missed_by_fit = 0;
  for (const frac::RankedFit& row : result.ranking) {
    if (row.from_family) continue;
    options.constraints = row.model.constraints;
    const double best = frac::fit(data, frac::Structure(row.model.formula), options).rms;
    EXPECT_LE(row.fit.rms / best, 1.01) << row.name;
    missed_by_fit += row.fit.rms / best < 0.99 ? 1 : 0;
    ++compared;
  }
  EXPECT_LE(missed_by_fit, 5);
  EXPECT_GT(compared, 20);
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

// Systems of whole order beyond the presets: of third order, and a ladder of four RC arcs, which at noise of 1 % might
// also be the approximation of a fractional system and at 0.1 % is none.
TEST(Verdict, ThreePolesAndAnRcLadderAreOfWholeOrder) {
  const std::vector<frac::NamedModel> all = frac::default_candidates();
  const char* const poles = "1/((s + 1) (2 s + 1) (0.3 s + 1))";
  const char* const ladder = "0.2 + 1/(0.03 s + 1) + 1.5/(0.3 s + 1) + 1/(3 s + 1) + 0.7/(30 s + 1)";
  const auto verdict_on = [&](const char* formula, double noise) {
    const auto result = frac::identify(support::noisy_response(formula, {}, noise, 7u), all, {}, both_parts());
    EXPECT_TRUE(result.integer && result.ranking.at(result.integer->index).name.starts_with("rational:"))
        << result.verdict_sentence;
    return result.verdict;
  };
  EXPECT_EQ(verdict_on(poles, 0.01), Verdict::fractional_not_supported);
  EXPECT_NE(verdict_on(ladder, 0.01), Verdict::fractional_supported);
  EXPECT_EQ(verdict_on(ladder, 0.001), Verdict::fractional_not_supported);
}

// Computed data: what meets them to rounding leaves nothing for further poles, or for an order, to explain.  On a
// narrow band a ratio comes near a power, but not to rounding.
TEST(Verdict, ExactDataAreDecided) {
  const std::vector<frac::NamedModel> all = frac::default_candidates();
  const auto verdict_on = [&](const char* formula, const std::vector<double>& omega) {
    const frac::Structure structure(formula);
    std::vector<std::complex<double>> value;
    for (const double each : omega) value.push_back(structure.response({}, each));
    return frac::identify(frac::FrequencyResponseData(omega, value), all, {}, both_parts()).verdict;
  };
  EXPECT_EQ(verdict_on("(s + 3)/(s^3 + 2 s^2 + 4 s + 3)", grid()), Verdict::fractional_not_supported);
  EXPECT_EQ(verdict_on("10 + 5/(0.1 s + 1) + 3/(2 s + 1) + 2/(20 s + 1)", grid()), Verdict::fractional_not_supported);
  std::vector<double> narrow;
  for (int i = 0; i < 100; ++i) narrow.push_back(0.7 * std::pow(2.0, i / 99.0));
  EXPECT_EQ(verdict_on("1/(s^0.9 + 1)", narrow), Verdict::fractional_supported);
}

// A resistance beside a Gerischer element is among no candidates, and its ratios come nearer with each pole, by a
// factor of about 15, until the digits of the file end: 17 of them, or 9.  A chain of five lags is met by five poles at
// once.
TEST(Verdict, ARatioThatComesNearerWithEachPoleRefutesNothing) {
  const std::vector<frac::NamedModel> all = frac::default_candidates();
  std::vector<double> omega;
  for (int i = 0; i < 60; ++i) omega.push_back(0.1 * std::pow(10.0, 2 * i / 59.0));
  const auto verdict_on = [&](auto&& response, int digits) {
    const auto written = [&](double x) {
      const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) + 1 - digits);
      return digits < 17 ? unit * std::round(x / unit) : x;
    };
    std::vector<std::complex<double>> value;
    for (const double each : omega) {
      const std::complex<double> exact = response(std::complex<double>(0, each));
      value.emplace_back(written(exact.real()), written(exact.imag()));
    }
    return frac::identify(frac::FrequencyResponseData(omega, value), all, {}, both_parts()).verdict;
  };
  const auto gerischer = [](std::complex<double> s) { return 0.4 + 1.0 / std::sqrt(1.0 + s); };
  const auto lags = [](std::complex<double> s) {
    return 1.0 / ((1.0 + 0.07 * s) * (1.0 + 0.3 * s) * (1.0 + s) * (1.0 + 2.5 * s) * (1.0 + 9.0 * s));
  };
  for (const int digits : {9, 17}) {
    EXPECT_NE(verdict_on(gerischer, digits), Verdict::fractional_not_supported) << digits;
    EXPECT_EQ(verdict_on(lags, digits), Verdict::fractional_not_supported) << digits;
  }
}

TEST(Verdict, TwoZarcsAreFractional) {
  const auto data = support::noisy_response("0.2 + 1/(0.3 s^0.8 + 1) + 2/(10 s^0.7 + 1)", {}, 0.01, 8u);
  const auto result = frac::identify(data, frac::default_candidates(), {}, both_parts());
  EXPECT_EQ(result.verdict, Verdict::fractional_supported) << result.verdict_sentence;
  ASSERT_TRUE(result.fractional && result.integer);
  EXPECT_LT(result.fractional->parameters, result.integer->parameters);
  EXPECT_LT(result.fractional->prediction_rms, result.integer->prediction_rms);
  EXPECT_TRUE(result.differ_most_omega < data.omega().front() || result.differ_most_omega > data.omega().back());
}

// Evidence compares two models.  With a probability of 0.05, or 0.5 where the verdict is left open, both are taken to
// be far from the truth, and then either class is as likely.
TEST(Verdict, OddsAllowThatBothModelsAreFarFromTheTruth) {
  for (const double noise : {0.001, 0.3}) {
    const auto result = frac::identify(support::noisy_response("1/(s^0.9 + 1)", {}, noise, 2u, 30),
                                       models({"lag", "fractional-lag"}), {}, both_parts());
    const double neither = result.verdict == Verdict::undecided ? 0.5 : 0.05;
    const double by_evidence = 1 / (1 + std::exp(-result.evidence / 2));
    const double stated = 1 / (1 + std::pow(10.0, -result.log10_odds));
    EXPECT_NEAR(stated, (1 - neither) * by_evidence + neither / 2, 1e-12) << result.verdict_sentence;
    EXPECT_EQ(result.verdict, noise < 0.01 ? Verdict::fractional_supported : Verdict::undecided);
  }
}

// A lag is found as a fractional lag of order 1 too, with a parameter less than the ratio it is compared with: that
// evidence is none for fractional orders, and the odds are those of an order that departs.
TEST(Verdict, EvidenceForWholeOrdersIsNoneForFractionalOnes) {
  auto candidates = models({"fractional-lag", "K/(T s + 1) + C + A s"});
  for (const char* gain : {"K", "C", "A"}) candidates[1].constraints.push_back({gain, {}, {}, {}, {}, {}, {}, true});
  const auto result =
      frac::identify(support::noisy_response("1/(s + 1)", {}, 0.01, 5u, 60), candidates, {}, both_parts());
  ASSERT_EQ(result.verdict, Verdict::fractional_not_supported) << result.verdict_sentence;
  ASSERT_GT(result.evidence, 0);
  ASSERT_LT(result.departure_evidence, 0);
  const double stated = 1 / (1 + std::pow(10.0, -result.log10_odds));
  EXPECT_NEAR(stated, 0.95 / (1 + std::exp(-result.departure_evidence / 2)) + 0.025, 1e-12);
  EXPECT_NE(result.verdict_sentence.find("to 1 for whole orders"), std::string::npos) << result.verdict_sentence;
}

// A model with 20 parameters may follow measured data, and predict what was left out worse than a ratio that misses
// them by little.  Figures of the impedance of a lithium cell whose residuals are drift.
TEST(Verdict, WhatPredictsWorseIsNotSupportedEvenWhereItAloneFollows) {
  const frac::detail::Competitor fractional{}, integer{};
  frac::ParameterEstimate order{};
  order.value = 0.52;
  const frac::detail::Comparison pair{.fractional = fractional,
                                      .integer = integer,
                                      .fractional_follows = true,
                                      .integer_follows = false,
                                      .share = 1,
                                      .orders = {true, &order, 0, false},
                                      .departure = {.evidence = 139.6, .parameters = 25},
                                      .only_integer_grew = false,
                                      .rounded = false,
                                      .over_time = false};
  const auto verdict = [&](double prediction, double extrapolation) {
    frac::IdentificationResult result{};
    result.evidence = result.departure_evidence = result.evidence_beside_smooth_error = 139.6;
    result.fractional = frac::Finalist{0, 25, prediction, extrapolation};
    result.integer = frac::Finalist{1, 24, 1.3e-5, 5.5e-5};
    return frac::detail::ruling(result, pair, {}).verdict;
  };
  EXPECT_EQ(verdict(3.9e-5, 8.8e-5), Verdict::undecided);
  EXPECT_EQ(verdict(1.3e-5, 5.5e-5), Verdict::fractional_supported);
}

/// A candidate of 100 residuals of which every second one is 0, so that no neighbours go together.
frac::detail::Competitor leaving(frac::ModelClass model_class, const char* model, std::size_t parameters, double rms) {
  frac::detail::Competitor left;
  left.ranked.model_class = model_class;
  left.ranked.fit.model = model;
  left.ranked.fit.termination = frac::FitTermination::converged;
  left.ranked.fit.free_parameters = parameters;
  left.ranked.fit.relative_rms = rms;
  left.ranked.fit.residuals = 100;
  for (int i = 0; i < 50; ++i) left.residual.insert(left.residual.end(), {rms, 0});
  const frac::Structure structure(model);
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    frac::ParameterEstimate estimate{};
    estimate.value = structure.parameter_roles()[i] == frac::ParameterRole::order ? 0.6 : 1;
    estimate.standard_error = 0.01;
    estimate.ci95_lower = estimate.value - 0.02;
    estimate.ci95_upper = estimate.value + 0.02;
    left.ranked.fit.parameters.push_back(estimate);
  }
  return left;
}

// A stable member of a family leaves its part in the verdict to the unstable one that it stands for.  Where both are
// one model, one of them is kept, and the part with it; what is another model still leaves it.
TEST(Verdict, AStableModelThatIsTheUnstableOneTakesItsPart) {
  using frac::ModelClass;
  const auto member = [](double rms, bool stands_in) {
    frac::detail::Competitor each = leaving(ModelClass::integer_order, "K/(T s + 1)", 2, rms);
    each.ranked.from_family = true;
    each.stands_in = stands_in;
    return each;
  };
  const auto merged = [](std::vector<frac::detail::Competitor> all) {
    frac::detail::merge_equivalent(all, {}, 1, [](const auto&, const auto&) { return true; });
    return all;
  };
  for (const bool first : {true, false}) {
    const auto twins = merged({member(1e-3, first), member(1e-3, !first)});
    ASSERT_EQ(twins.size(), 1u);
    EXPECT_FALSE(twins[0].stands_in);
  }
  const auto others = merged({member(1e-3, true), member(2e-3, false)});
  ASSERT_EQ(others.size(), 2u);
  EXPECT_TRUE(others[0].stands_in);
}

// By the formula of evidence_against(), written out: the closest leaves 0.1 %, so that the smooth error is ten times
// that, 1 %, and what others leave beyond it counts in units of both.  A ratio of ten parameters that comes nearly as
// close is no better than one of three that leaves 0.5 %.
TEST(Verdict, EvidenceBesideASmoothErrorPaysForNothingThatFollowsIt) {
  using frac::ModelClass;
  const auto price = [](double k) { return 100 * k * std::log(100.0) / (98 - k); };
  const auto beyond = [](double rms) { return 100 * (rms * rms - 1e-6) / (1e-6 + 1e-4); };
  std::vector<frac::detail::Competitor> all = {
      leaving(ModelClass::fractional, "K/(T s^a + 1)", 3, 1e-3),
      leaving(ModelClass::integer_order, "K/(T s + 1)", 2, 0.03),
      leaving(ModelClass::integer_order, "K (b1 s + 1)/(a2 s^2 + a1 s + 1)", 10, 1.2e-3)};
  const double of_ratio = beyond(1.2e-3) + price(10) - price(3);
  EXPECT_NEAR(frac::detail::evidence_beside_smooth_error(all, 1).fractional, of_ratio, 1e-9 * of_ratio);
  all.push_back(leaving(ModelClass::integer_order, "K/(a2 s^2 + a1 s + 1)", 3, 5e-3));
  EXPECT_NEAR(frac::detail::evidence_beside_smooth_error(all, 1).fractional, beyond(5e-3), 1e-9 * of_ratio);
  // An order that departs already has no way to go; one of 0.95 in errors of 0.01 has 0.05, of which the smooth error
  // takes its share of the variance.
  EXPECT_NEAR(frac::detail::evidence_beside_smooth_error(all, 1).departing, beyond(5e-3), 1e-9 * of_ratio);
  frac::ParameterEstimate& order = all[0].ranked.fit.parameters[2];
  ASSERT_EQ(order.value, 0.6);
  order.value = 0.95;
  order.ci95_lower = 0.93, order.ci95_upper = 0.97;
  const double error = 0.02 / frac::student_t_95(97);
  const double falls = std::pow(0.05 / error, 2) * 1e-6 / (1e-6 + 1e-4);
  EXPECT_NEAR(frac::detail::evidence_beside_smooth_error(all, 1).departing, beyond(5e-3) - falls, 1e-9 * of_ratio);
  EXPECT_TRUE(std::isnan(frac::detail::evidence_beside_smooth_error({}, 1).fractional));
  all.resize(1);
  EXPECT_TRUE(std::isnan(frac::detail::evidence_beside_smooth_error(all, 1).fractional));
}

TEST(Verdict, NeitherClassIsToldAgainstTheEvidenceBesideASmoothError) {
  const frac::detail::Competitor fractional{};
  frac::detail::Competitor integer{};
  integer.ranked.fit.rms = 1;
  frac::ParameterEstimate order{};
  order.value = 0.52;
  const frac::detail::Comparison pair{.fractional = fractional,
                                      .integer = integer,
                                      .fractional_follows = true,
                                      .integer_follows = true,
                                      .share = 1,
                                      .orders = {true, &order, 0, false},
                                      .departure = {},
                                      .only_integer_grew = false,
                                      .rounded = false,
                                      .over_time = false};
  const auto verdict = [&](double evidence, double beside) {
    frac::IdentificationResult result{};
    result.evidence = result.departure_evidence = evidence;
    result.evidence_beside_smooth_error = result.departure_beside_smooth_error = beside;
    result.fractional = frac::Finalist{0, 4, 1, 1};
    result.integer = frac::Finalist{1, 4, 1, 1};
    return frac::detail::ruling(result, pair, {}).verdict;
  };
  EXPECT_EQ(verdict(30, 11), Verdict::fractional_supported);
  EXPECT_EQ(verdict(30, 9), Verdict::undecided);
  EXPECT_EQ(verdict(-30, -1), Verdict::fractional_not_supported);
  EXPECT_EQ(verdict(-30, 1), Verdict::undecided);
  // Over time there is none.
  EXPECT_EQ(verdict(30, std::numeric_limits<double>::quiet_NaN()), Verdict::fractional_supported);
}

// Nor does a ratio of 16 parameters refute: figures of a coil with eddy currents, whose outliers it alone follows.
TEST(Verdict, WhatPredictsWorseRefutesNothingEvenWhereItAloneFollows) {
  const frac::detail::Competitor fractional{};
  frac::detail::Competitor integer{};
  integer.ranked.fit.rms = 6.949e-3;
  const frac::detail::Comparison pair{.fractional = fractional,
                                      .integer = integer,
                                      .fractional_follows = false,
                                      .integer_follows = true,
                                      .share = 1,
                                      .orders = {},
                                      .departure = {.evidence = -181.3, .parameters = 6},
                                      .only_integer_grew = false,
                                      .rounded = false,
                                      .over_time = false};
  const auto verdict = [&](double prediction, double extrapolation) {
    frac::IdentificationResult result{};
    result.evidence = result.departure_evidence = result.departure_beside_smooth_error = -181.3;
    result.fractional = frac::Finalist{0, 6, 0.03841, 0.05442};
    result.integer = frac::Finalist{1, 16, prediction, extrapolation};
    return frac::detail::ruling(result, pair, {}).verdict;
  };
  EXPECT_EQ(verdict(0.2059, 0.3), Verdict::undecided);
  EXPECT_EQ(verdict(0.03, 0.05), Verdict::fractional_not_supported);
}

// Conduction of heat through a wall that passes it on to a room is among no candidates, and rows of real poles
// approximate it to 0.1 %: that they follow the data is no reason to call the system one of integer order.
TEST(Verdict, ARowOfPolesThatApproximatesIsNoIntegerOrder) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const auto data =
        support::noisy_response("1/(cosh(sqrt(3 s)) + 0.4 sqrt(3 s) sinh(sqrt(3 s)))", {}, 1e-3, seed, 35);
    // The weight of this noise: a floor, which so steep an end of a response feigns, hides where the poles miss it.
    frac::FitOptions options = both_parts();
    options.weight = frac::Weight::relative;
    const auto result = frac::identify(data, frac::default_candidates(), {}, options);
    EXPECT_NE(result.verdict, Verdict::fractional_not_supported) << result.verdict_sentence;
  }
}

// Two models with as many parameters and the same response are one: it is listed and counted once, under the name of
// the preset.  The sum of two arcs is what the families of sums and of passive elements grow to on these data.
TEST(Identify, ListsAModelInTwoSpellingsOnce) {
  const auto data = support::noisy_response("0.2 + 1/(0.3 s^0.8 + 1) + 2/(10 s^0.7 + 1)", {}, 0.01, 8u);
  const auto apart = frac::identify(data, models({"terms"}), {}, both_parts());
  ASSERT_EQ(apart.ranking.size(), 1u);
  const auto result = frac::identify(data, models({"terms", "two-zarc", "two-rc", "elements"}), {}, both_parts());
  ASSERT_EQ(result.ranking.size(), 2u);
  EXPECT_EQ(result.ranking[0].name, "two-zarc");
  EXPECT_EQ(result.ranking[0].also,
            (std::vector<std::string>{apart.ranking[0].name, "elements:R0+(R1|CPE1)+(R2|CPE2)"}));
  // The same optimum, found in another form.
  EXPECT_NEAR(result.ranking[0].fit.cost, apart.ranking[0].fit.cost, 1e-6 * apart.ranking[0].fit.cost);
  EXPECT_EQ(result.ranking[0].fit.free_parameters, apart.ranking[0].fit.free_parameters);
  // Nothing else comes near, so that all the weight is its own and not half of it.
  EXPECT_GT(result.ranking[0].akaike_weight, 0.999);
}

// A loudspeaker: a coil with eddy currents beside a mechanical resonance.  Ratios need ten parameters for what a sum of
// a constant, a power and a mode says with six.
TEST(Verdict, APowerBesideAModeIsFractional) {
  const auto data = support::noisy_response("1 + 0.3 s^0.67 + s/(s^2/0.16 + s + 1)", {}, 0.01, 3u, 80);
  const auto result = frac::identify(data, frac::default_candidates(), {}, both_parts());
  EXPECT_EQ(result.verdict, Verdict::fractional_supported) << result.verdict_sentence;
  EXPECT_EQ(result.ranking.at(result.fractional->index).fit.free_parameters, 6u);
}

// Rounded to two digits, a fractional lead has errors of 5 % where its first digit is 1 and of 0.5 % where it is 9, in
// steps that a ratio of many poles follows.
TEST(Verdict, AModelThatFollowsTheStepsOfRoundingRefutesNothing) {
  const auto exact = support::noisy_response("1.0475 ((1.5 s + 1)/(0.03 s + 1))^0.46", {}, 0, 1u, 60);
  std::vector<std::complex<double>> value;
  const auto rounded = [](double x) {
    const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) - 1);
    return unit * std::round(x / unit);
  };
  for (const auto& each : exact.value()) value.emplace_back(rounded(each.real()), rounded(each.imag()));
  const auto result =
      frac::identify(frac::FrequencyResponseData(exact.omega(), value), frac::default_candidates(), {}, both_parts());
  EXPECT_NE(result.verdict, Verdict::fractional_not_supported) << result.verdict_sentence;
}

// Noise of 50 % on 12 points leaves an order of 0.8 as possible as 1.  Departure evidence says so.
TEST(Verdict, NotSupportedAsksThatADepartureWouldHaveBeenSeen) {
  int refuted = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto result = frac::identify(support::noisy_response("1/(s + 1)", {}, 0.5, seed, 12),
                                       models({"lag", "fractional-lag"}), {}, both_parts());
    const bool not_supported = result.verdict == Verdict::fractional_not_supported;
    refuted += not_supported;
    EXPECT_EQ(not_supported && !(result.departure_evidence < -8), false) << result.verdict_sentence;
  }
  EXPECT_LT(refuted, 10);
  const auto clear = frac::identify(support::noisy_response("1/(s + 1)", {}, 0.01, 1u, 60),
                                    models({"lag", "fractional-lag"}), {}, both_parts());
  EXPECT_EQ(clear.verdict, Verdict::fractional_not_supported) << clear.verdict_sentence;
  // An order of 0.9 or 1.1 lies tens of standard errors away: s = noise/(sensitivity sqrt(n)) is below 0.005.
  EXPECT_LT(clear.departure_evidence, -50);
}

// Formulas that contain a lag with their diffusion gone follow it as closely, and their orders are numbers.  Seen would
// be what changes a value by pi/20, the angle by which s^0.1 turns: 16 times noise of 1 %, 5 times noise of 3 %.
TEST(Verdict, ALagIsDecidedBesideDiffusionThatDoesNotShow) {
  const auto candidates =
      models({"lag", "r-rc", "oscillator", "diffusion-through-lag", "rc-and-warburg-short", "rc-and-warburg-open"});
  for (const double noise : {0.001, 0.01, 0.03}) {
    const auto result =
        frac::identify(support::noisy_response("2/(3 s + 1)", {}, noise, 4u, 60), candidates, {}, both_parts());
    EXPECT_EQ(result.verdict, Verdict::fractional_not_supported) << result.verdict_sentence;
    EXPECT_GT(result.evidence, -8);
    EXPECT_NE(result.notes.front().find("does not show"), std::string::npos) << result.notes.front();
  }
}

// The same numbers in other units: factors of 2 change no digit, and the optima are the same to what a solver leaves
// of the cost, 1e-6 of n ln(cost) at most.
TEST(Verdict, WhatDoesNotShowDoesSoInNoUnit) {
  const auto candidates = models({"lag", "diffusion-through-lag"});
  const auto data = support::noisy_response("1/(s + 1)", {}, 0.01, 4u, 60);
  const auto told = frac::identify(data, candidates, {}, both_parts());
  for (const double unit : {std::exp2(-60), std::exp2(40)}) {
    std::vector<double> omega = data.omega();
    std::vector<std::complex<double>> value = data.value();
    for (double& each : omega) each *= std::exp2(10);
    for (auto& each : value) each *= unit;
    const auto result = frac::identify(frac::FrequencyResponseData(omega, value), candidates, {}, both_parts());
    EXPECT_EQ(result.verdict, Verdict::fractional_not_supported) << result.verdict_sentence;
    EXPECT_NEAR(result.departure_evidence, told.departure_evidence, 120 * 1e-6 * 10);
  }
}

// Diffusion that shows is never refuted: neither beyond pi/20 of the response, as at the upper end of these four
// decades, where 1/cosh(sqrt(0.02 s)) falls to 0.3, nor a fiftieth of it that the data ask for.
TEST(Verdict, DiffusionBehindALagThatShowsIsNotRefuted) {
  const auto candidates =
      models({"lag", "oscillator", "three-lags", "diffusion-through-lag", "rc-and-warburg-short", "rational"});
  const auto verdict_on = [&](const char* formula, double noise, unsigned seed) {
    return frac::identify(support::noisy_response(formula, {}, noise, seed, 60), candidates, {}, both_parts()).verdict;
  };
  for (unsigned seed = 1; seed <= 3; ++seed) {
    EXPECT_NE(verdict_on("1/((s + 1) cosh(sqrt(0.02 s)))", 0.03, seed), Verdict::fractional_not_supported) << seed;
    EXPECT_NE(verdict_on("1/((s + 1) cosh(sqrt(0.002 s)))", 1e-3, seed), Verdict::fractional_not_supported) << seed;
    EXPECT_NE(verdict_on("0.3 + 1/(s + 1) + 0.4 tanh(sqrt(10 s))/sqrt(10 s)", 0.03, seed),
              Verdict::fractional_not_supported)
        << seed;
  }
}

// By the definition: of 100 residuals of rms 1 % that are 4 % of a value apart from those of the lag, pi/20 - 0.04 is
// missing, in units of their standard deviation sqrt(100/97) 1 %.
TEST(Verdict, DepartureOfWhatHardlyShows) {
  auto hardly = leaving(ModelClass::fractional, "K/((T2 s + 1) cosh(sqrt(T s)))", 3, 0.01);
  EXPECT_EQ(frac::detail::orders_of(hardly, 1).departure, 0);
  hardly.from_integer_limit = [] { return 0.04; };
  const double missing = std::numbers::pi / 20 - 0.04, error = 0.01 * std::sqrt(100.0 / 97);
  EXPECT_NEAR(frac::detail::orders_of(hardly, 1).departure, std::pow(missing / error, 2), 1e-9);
  EXPECT_NEAR(frac::detail::orders_of(hardly, 0.5).departure, std::pow(missing / error, 2) / 2, 1e-9);
}

// Neither a lag nor a fractional lag follows three poles: one being better than the other says nothing.
TEST(Verdict, NoneIsGivenAmongCandidatesThatAllMissTheData) {
  const auto data = support::noisy_response("1/((s + 1) (2 s + 1) (0.3 s + 1))", {}, 0.01, 9u);
  const auto result = frac::identify(data, models({"lag", "fractional-lag"}), {}, both_parts());
  EXPECT_EQ(result.verdict, Verdict::no_adequate_model) << result.verdict_sentence;
  for (const auto& ranked : result.ranking) {
    EXPECT_FALSE(ranked.lack_of_fit.adequate) << ranked.name;
    EXPECT_FALSE(ranked.lack_of_fit.misses.empty()) << ranked.name;
  }
}

// A rational family is not grown on magnitudes alone.  While it was left out nothing is called fractional.
TEST(Verdict, IsWithheldWhileARivalWasSkipped) {
  frac::FitOptions options;
  options.component = Component::magnitude;
  const auto data = noisy("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 1);
  EXPECT_EQ(frac::identify(data, models({"fractional-lag", "lag"}), {}, options).verdict,
            Verdict::fractional_supported);
  const auto result = frac::identify(data, models({"fractional-lag", "lag", "rational"}), {}, options);
  EXPECT_EQ(result.verdict, Verdict::undecided) << result.verdict_sentence;
  ASSERT_EQ(result.skipped.size(), 1u);
  EXPECT_NE(result.skipped[0].find("rational"), std::string::npos);
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes[0].find("'rational' could not be fitted"), std::string::npos) << result.notes[0];
  EXPECT_NE(result.notes[0].find("both parts"), std::string::npos) << result.notes[0];
}

// Relative residuals do not change with the unit of the data, so neither do the cost of a family's member nor the
// relative width of an interval.  A power of two as unit changes no digit of the data; squares of them vanish or
// overflow.  The solvers stop at costs equal to about 1e-10, which moves errors by some 1e-5 of themselves.
TEST(Identify, RatiosAreFittedToDataOfAnySize) {
  const auto data = support::noisy_response("1/((s + 1) (2 s + 1) (0.3 s + 1))", {}, 0.01, 9u);
  const auto scaled = [&](int exponent) {
    std::vector<std::complex<double>> value = data.value();
    for (auto& each : value) each = {std::ldexp(each.real(), exponent), std::ldexp(each.imag(), exponent)};
    return frac::FrequencyResponseData(data.omega(), value);
  };
  const auto candidates = models({"rational:0/3"});
  const auto plain = frac::identify(data, candidates, {}, both_parts()).ranking[0].fit;
  for (const int exponent : {-660, 660}) {
    const auto fit = frac::identify(scaled(exponent), candidates, {}, both_parts()).ranking[0].fit;
    EXPECT_NEAR(fit.rms / plain.rms, 1, 1e-8);
    ASSERT_EQ(fit.parameters.size(), plain.parameters.size());
    EXPECT_NEAR(std::ldexp(fit.parameters[0].value, -exponent) / plain.parameters[0].value, 1, 1e-5);
    EXPECT_NEAR(std::ldexp(fit.parameters[0].standard_error, -exponent) / plain.parameters[0].standard_error, 1, 1e-4);
    EXPECT_LT(fit.parameters[0].ci95_lower, fit.parameters[0].ci95_upper);
  }
}

// Schwarz's criterion for few residuals asks for three more than parameters: one point of one part has none left for
// any candidate, and three have none for a gain.
TEST(Verdict, IsWithheldWhereTooFewResidualsAreLeft) {
  for (const std::size_t count : {1u, 3u}) {
    const std::vector<double> omega{0.1, 1, 10};
    const std::vector<std::complex<double>> value{{0.9, -0.2}, {0.5, -0.5}, {0.1, -0.2}};
    const frac::FrequencyResponseData data({omega.begin(), omega.begin() + static_cast<std::ptrdiff_t>(count)},
                                           {value.begin(), value.begin() + static_cast<std::ptrdiff_t>(count)});
    frac::FitOptions options;
    options.component = Component::imaginary;
    const auto result = frac::identify(data, models({"gain", "power-law", "lag"}), {}, options);
    EXPECT_EQ(result.verdict, Verdict::undecided) << result.verdict_sentence;
    EXPECT_NE(result.verdict_sentence.find("too few"), std::string::npos) << result.verdict_sentence;
    EXPECT_EQ(result.verdict_sentence.find("inf"), std::string::npos) << result.verdict_sentence;
    if (count > 1) continue;
    ASSERT_FALSE(result.skipped.empty());
    EXPECT_NE(result.skipped[0].find("1 residual cannot"), std::string::npos) << result.skipped[0];
  }
}

// A resistance that the data hardly see: its standard error is many e-folds, and the first step of its profile
// overflowed, which took the candidate from the ranking.
TEST(Identify, AParameterNearItsBoundDoesNotRemoveTheCandidate) {
  const std::vector<double> omega{
      0.099999999999999992, 0.16681005372000587, 0.27825594022071243, 0.46415888336127786, 0.77426368268112689,
      1.2915496650148839,   2.1544346900318834,  3.5938136638046254,  5.9948425031894086,  10};
  const std::vector<std::complex<double>> value{
      {0.98893184982450699, -0.099648117264274444}, {0.97209007246542956, -0.1629692113159818},
      {0.92732324408576183, -0.25837705602939909},  {0.82294500142384786, -0.38202861302242536},
      {0.62457546729412361, -0.48455837509680821},  {0.37429670364159756, -0.48455726973743757},
      {0.17752120795004273, -0.38215214340453152},  {0.071445766585467516, -0.25861445720590787},
      {0.027056420997598935, -0.16237603608876561}, {0.0099386880007395033, -0.098961054340117802}};
  const auto result = frac::identify({omega, value}, frac::model_library(), {}, both_parts());
  for (const std::string& skipped : result.skipped) EXPECT_EQ(skipped.find("finite"), std::string::npos) << skipped;
}

// White noise of the stated size passes: each test errs once in a thousand, so more than four of 300 have a chance of
// 2e-5.
TEST(LackOfFit, WhiteNoisePasses) {
  int failures = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const auto data = noisy("K/(T s + 1)", {2, 0.5}, 0.02, seed);
    const auto result = frac::fit(data, frac::Structure("K/(T s + 1)"), both_parts());
    failures += !frac::lack_of_fit(data, both_parts(), result).adequate;
  }
  EXPECT_LE(failures, 4);
}

TEST(LackOfFit, AMissedShapeAndAnUnderstatedSigmaFail) {
  const auto data = noisy("K/(T s^a + 1)", {2, 0.5, 0.8}, 0.01, 3);
  const auto lag = frac::fit(data, frac::Structure("K/(T s + 1)"), both_parts());
  const auto missed = frac::lack_of_fit(data, both_parts(), lag);
  EXPECT_EQ(missed.source, frac::NoiseSource::data);
  EXPECT_FALSE(missed.adequate);
  EXPECT_GT(missed.misfit, 2);

  std::vector<double> sigma;
  for (const auto& value : data.value()) sigma.push_back(0.005 * std::abs(value));
  frac::FitOptions given = both_parts();
  given.weight = frac::Weight::given;
  const frac::FrequencyResponseData with_sigma(data.omega(), data.value(), sigma);
  const auto fitted = frac::fit(with_sigma, frac::Structure("K/(T s^a + 1)"), given);
  const auto understated = frac::lack_of_fit(with_sigma, given, fitted);
  EXPECT_EQ(understated.source, frac::NoiseSource::sigma);
  EXPECT_FALSE(understated.adequate);
  // Twice the stated noise; 160 residuals tell a standard deviation to 6 %, of which this is five times.
  EXPECT_NEAR(understated.misfit, 2, 0.6);
}

TEST(LackOfFit, RepeatsOfExactDataAreNoMisfit) {
  const frac::Structure lag("K/(T s + 1)");
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (const double each : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0})
    for (int repeat = 0; repeat < 3; ++repeat) {
      omega.push_back(each);
      value.push_back(lag.response(std::vector<double>{2, 1}, each));
    }
  const frac::FrequencyResponseData data(omega, value);
  const auto result = frac::fit(data, lag, both_parts());
  EXPECT_TRUE(frac::lack_of_fit(data, both_parts(), result).adequate);
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

// Noise of these seeds is followed by a ratio of order 8 so closely that AICc prefers it.
TEST(Identify, TheChosenDoesNotContradictTheVerdict) {
  const std::vector<frac::NamedModel> models{frac::find_model("fractional-lag-delay"), frac::find_model("lag-delay"),
                                             frac::find_model("rational:1..12")};
  for (const unsigned seed : {66u, 106u}) {
    const auto data = support::noisy_response("1.5 exp(-0.08 s)/(1 + 0.6 s^0.8)", {}, 0.01, seed, 80);
    const auto result = frac::identify(data, models, {}, support::both_parts());
    ASSERT_EQ(result.verdict, frac::Verdict::fractional_supported) << result.verdict_sentence;
    EXPECT_EQ(result.ranking.at(result.chosen).name, "fractional-lag-delay");
  }
}

/// An arc measured with a smooth error of 1 %, as cables and calibrations leave it, which no causal system has.
frac::FrequencyResponseData arc_of_no_causal_system(unsigned seed) {
  support::Random random(seed);
  std::array<double, 3> phase{}, rate{};
  for (std::size_t k = 0; k < 3; ++k) {
    phase[k] = 6.28 * random.unit();
    rate[k] = 1 + 3 * random.unit();
  }
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (int i = 0; i < 60; ++i) {
    omega.push_back(std::pow(10, -1 + 2.5 * i / 59.0));
    const std::complex<double> s(0, omega.back());
    double real = 0, imaginary = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      real += 0.01 / 1.7 * std::cos(rate[k] * std::log(omega.back()) + phase[k]);
      imaginary += 0.01 / 1.7 * std::sin(1.3 * rate[k] * std::log(omega.back()) + phase[k]);
    }
    real += 0.001 * random.normal();
    imaginary += 0.001 * random.normal();
    value.push_back((1.0 / (1.0 + std::pow(s, 0.5)) + 0.05) * std::complex<double>(1 + real, imaginary));
  }
  return {omega, value};
}

// Their orders are so far from whole ones that evidence is above 10 beside such an error, too.  Mostly a ratio follows
// the error and predicts left-out points as well.  In three of 45 such data sets (of 60 seeds) that they are invalid
// alone kept the verdict back, in one of these by rounding; the three are among the six.
TEST(Verdict, OnInvalidDataNoFractionalOrderIsSupported) {
  int departing = 0, for_the_data = 0;
  for (const unsigned seed : {12U, 15U, 16U, 52U, 54U, 56U}) {
    const frac::FrequencyResponseData data = arc_of_no_causal_system(seed);
    if (frac::validate(data).validity != frac::Validity::invalid) continue;
    const auto result = frac::identify(data, models({"rational", "commensurate", "cole-cole"}), {}, {});
    EXPECT_NE(result.verdict, Verdict::fractional_supported) << seed << result.verdict_sentence;
    EXPECT_NE(result.verdict, Verdict::fractional_not_supported) << seed << result.verdict_sentence;
    departing += result.evidence > 10 && result.evidence_beside_smooth_error > 10;
    for_the_data += std::any_of(result.notes.begin(), result.notes.end(),
                                [](const std::string& note) { return note.find("invalid") != std::string::npos; });
  }
  EXPECT_GE(departing, 2);
  EXPECT_GE(for_the_data, 1);
}

}  // namespace
