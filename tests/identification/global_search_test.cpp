// SPDX-License-Identifier: BSD-3-Clause
// The search for the global optimum: how often it is found, and what is said about it.
#include "identification/search/global_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/model_library.hpp"
#include "identification/statistics/curvature_fit.hpp"

namespace {

using frac::Component;
using frac::FitOptions;
using frac::FitResult;
using frac::FrequencyResponseData;
using frac::Structure;

FrequencyResponseData noisy(const std::string& formula, const std::vector<double>& parameters, double from, double to,
                            double noise, std::uint64_t seed) {
  constexpr int points = 100;
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0, noise);
  const Structure structure(formula);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (int i = 0; i < points; ++i) {
    omega.push_back(from * std::pow(to / from, i / (points - 1.0)));
    const std::complex<double> exact = structure.response(parameters, omega.back());
    const double real = normal(generator), imaginary = normal(generator);
    value.push_back(exact + std::abs(exact) * std::complex<double>(real, imaginary));
  }
  return {std::move(omega), std::move(value)};
}

/// The best cost known: of a local solve from the parameters behind the data.
double cost_from_truth(const FrequencyResponseData& data, const Structure& structure,
                       const std::vector<double>& parameters, FitOptions options) {
  options.global_start = false;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    options.constraints.push_back({structure.parameter_names()[i], {}, {}, {}, parameters[i]});
  }
  return frac::fit(data, structure, options).cost;
}

struct Case {
  const char* formula;
  std::vector<double> parameters;
  double from, to;
};

class FindsTheOptimum : public testing::TestWithParam<Case> {};

// The share to reach is 99 % (imaginary part: 95 %); the benchmark work_precision_fit_global measures it with hundreds
// of seeds.  Here one miss in ten seeds is allowed: at 99 % two misses have a chance of 0.4 %, and a search that finds
// the optimum half the time passes with a chance of 1 %.
TEST_P(FindsTheOptimum, WithoutStartsForEachSeed) {
  const Case& test = GetParam();
  const Structure structure(test.formula);
  for (const Component component : {Component::both, Component::imaginary}) {
    int missed = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const FrequencyResponseData data = noisy(test.formula, test.parameters, test.from, test.to, 0.01, seed);
      FitOptions options;
      options.component = component;
      options.weight = frac::Weight::relative;  // of which the cost is the same for every fit
      options.seed = seed;
      const FitResult result = frac::fit(data, structure, options);
      missed += result.cost > 1.001 * cost_from_truth(data, structure, test.parameters, options);
      EXPECT_GE(result.confidence_of_optimum, 0.9) << "seed " << seed;
    }
    EXPECT_LE(missed, 1) << frac::to_string(component);
  }
}

INSTANTIATE_TEST_SUITE_P(
    GlobalSearch, FindsTheOptimum,
    testing::Values(
        Case{"1/(b2 s^a2 + b1 s^a1 + b0)", {0.8, 2.2, 0.5, 0.9, 1}, 1e-2, 1e2},
        Case{"1/(b2 s^a2 + b1 s^a1 + b0)", {14994, 1.31, 6009.5, 0.97, 1.69}, 1e-5, 1e-1},
        Case{"1/(b2 s^a2 + b1 s^a1 + b0)", {0.7943, 2.5708, 5.2385, 0.8372, 1.5560}, 1e-2, 1e2},
        Case{"K/(1 + (T s)^a)^b", {3, 0.5, 0.8, 0.45}, 1e-2, 1e2},
        Case{"K exp(-L s)/(T s^a + 1)", {2, 0.5, 3, 0.8}, 1e-2, 1e1},
        Case{"K exp(-L s)/(b2 s^a2 + b1 s^a1 + 1)", {1, 0.3, 0.8, 2.2, 0.5, 0.9}, 1e-2, 1e1},
        Case{"R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)", {0.01, 0.02, 3, 0.8, 0.03, 900, 0.9}, 1e-3, 1e5},
        // A peak of three or four of the hundred points: what a search among some of the points must not lose.
        Case{"K/(s^a2 + b1 s^a1 + 1)", {1, 2, 0.1, 1}, 1e-2, 1e2}));

// Measured cell, absolute weight: nearly all starts end on a plateau at large tau, 0.7 % or 39 % above the optimum.
// 1.40313787e-05 is the least cost known for this file and model.
TEST(GlobalSearch, FindsTheOptimumOfAMeasuredCellForEverySeed) {
  const std::string file = std::string(FRACFIT_SOURCE_DIR) + "/../shared/cases-ident/impedancepy_exampleData.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no measured files here";
  struct Row {
    double omega, real, imaginary;
  };
  std::vector<Row> rows;
  std::ifstream input(file);
  for (std::string line; std::getline(input, line);) {
    if (line.starts_with('#')) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    Row row{};
    fields >> row.omega >> row.real >> row.imaginary;
    row.omega *= 2 * std::numbers::pi;
    if (row.imaginary < 0) rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.omega < b.omega; });
  ASSERT_EQ(rows.size(), 57u);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (const Row& row : rows) {
    omega.push_back(row.omega);
    value.emplace_back(row.real, row.imaginary);
  }
  const Structure structure("R0 + R1/(1 + R1 C1 s) + 1/(C2 s + 1/(R2 + W/((tau s)^0.5 tanh((tau s)^0.5))))");
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    FitOptions options;
    options.component = Component::both;
    options.weight = frac::Weight::absolute;
    options.seed = seed;
    const FitResult result = frac::fit({omega, value}, structure, options);
    EXPECT_LE(result.cost, 1.001 * 1.40313787e-05) << "seed " << seed << ": " << result.message;
  }
}

// The closed form against the posterior it is the mean of: a search space with an unknown number of basins (each number
// from 1 to 60 alike) of unknown shares (uniform on the simplex), drawn at random; how often is the lowest minimum
// among those found, given how many were found?  A cut at 60 basins lifts the chance a little, by less than the scatter
// here.
TEST(ConfidenceOfOptimum, IsTheShareOfSearchesThatFoundIt) {
  constexpr int starts = 30;
  std::mt19937_64 generator(3);
  std::exponential_distribution<double> exponential;
  std::vector<int> searches(starts + 1, 0), found(starts + 1, 0);
  for (int trial = 0; trial < 60000; ++trial) {
    const std::size_t basins = 1 + generator() % 60;
    std::vector<double> share(basins);
    for (double& each : share) each = exponential(generator);
    std::discrete_distribution<std::size_t> basin(share.begin(), share.end());
    std::set<std::size_t> seen;
    for (int start = 0; start < starts; ++start) seen.insert(basin(generator));
    ++searches[seen.size()];
    // The shares are exchangeable, so basin 0 may be the lowest.
    found[seen.size()] += seen.contains(0);
  }
  for (std::size_t minima = 1; minima <= 8; ++minima) {
    const double share = found[minima] / static_cast<double>(searches[minima]);
    // Each count has at least 800 searches: four standard deviations of a share of 0.9 are 0.042.
    ASSERT_GT(searches[minima], 800);
    EXPECT_NEAR(frac::detail::confidence_of_optimum(starts, minima), share, 0.045) << minima << " minima";
  }
  EXPECT_EQ(frac::detail::confidence_of_optimum(2, 1), 0);
}

TEST(ConfidenceOfOptimum, IsUnknownAfterALocalSolveAndCertainForAnExactFit) {
  const std::vector<double> truth{0.8, 0.4, 0.7};
  const FrequencyResponseData data = noisy("K/(T s^a + 1)", truth, 1e-2, 1e2, 0, 1);
  FitOptions options;
  options.component = Component::both;
  const Structure structure("K/(T s^a + 1)");
  const FitResult exact = frac::fit(data, structure, options);
  EXPECT_EQ(exact.confidence_of_optimum, 1);
  EXPECT_GE(exact.starts_at_best, 1u);
  options.global_start = false;
  options.constraints = {{"K", {}, {}, {}, 1}, {"T", {}, {}, {}, 1}, {"a", {}, {}, {}, 0.5}};
  EXPECT_TRUE(std::isnan(frac::fit(data, structure, options).confidence_of_optimum));
}

// 1/(M s^2) + d + c/s is linear in 1/M, d and c, but from one sign of M to the other the way leads through infinity. Of
// these data, which have no inertia, either sign comes; the least squares are solved by hand, and 1e-6 is what a cost
// that has settled to 1e-10 leaves of rms.
TEST(GlobalSearch, CrossesFromOneSignOfAnInertiaToTheOther) {
  const frac::NamedModel model = frac::find_model("inertia-and-integrator");
  const Structure structure(model.formula);
  FitOptions options;
  options.component = Component::both;
  options.weight = frac::Weight::relative;
  options.constraints = model.constraints;
  std::set<bool> signs;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const double order = (seed % 2 == 0 ? 1 : -1) * (0.25 + 0.05 * static_cast<double>(seed));
    const FrequencyResponseData data = noisy("K s^a/(T s^a + 1)", {2, order, 0.7}, 1e-2, 1e2, 0.01, seed);
    double w0 = 0, w1 = 0, w2 = 0, g0 = 0, g1 = 0, h1 = 0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      const std::complex<double> value = data.value()[i];
      const double x = 1 / (data.omega()[i] * data.omega()[i]), weight = 1 / std::norm(value);
      w0 += weight, w1 += weight * x, w2 += weight * x * x;
      g0 += weight * value.real(), g1 += weight * x * value.real(), h1 += weight * value.imag() / data.omega()[i];
    }
    const double inverse_mass = (w1 * g0 - w0 * g1) / (w0 * w2 - w1 * w1);
    const double d = (g0 + inverse_mass * w1) / w0, c = -h1 / w1;
    double squares = 0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      const double omega = data.omega()[i];
      const std::complex<double> fitted(d - inverse_mass / (omega * omega), -c / omega);
      squares += std::norm(fitted - data.value()[i]) / std::norm(data.value()[i]);
    }
    const FitResult result = frac::fit(data, structure, options);
    EXPECT_NEAR(result.rms / std::sqrt(squares / static_cast<double>(2 * data.size())), 1, 1e-6) << "seed " << seed;
    signs.insert(inverse_mass > 0);
  }
  EXPECT_EQ(signs.size(), 2U);
}

// K ((T1 s + 1)/(T2 s + 1))^a on data of an oscillator: solves that grow T1 and diminish K run out of steps at three
// times the error of the optimum, in three of eight of such data all of the first few, and in some all of a search.  A
// row of a ranking that something else beats by far is to be the optimum of its structure as fit() finds it.
TEST(GlobalSearch, LeavesAHopelessStructureAtAMinimum) {
  const frac::Structure structure("K ((T1 s + 1)/(T2 s + 1))^a");
  frac::FitOptions options;
  options.weight = frac::Weight::relative;
  options.assumptions.stable = false;
  options.constraints = {{"K", {}, -std::numeric_limits<double>::infinity(), {}, {}}, {"a", {}, 0.0, 2.0, {}}};
  int early = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> normal(0, 0.01);
    std::vector<double> omega;
    std::vector<std::complex<double>> value;
    for (int i = 0; i < 40; ++i) {
      const double here = std::pow(10, 1.67 * (i / 39.0 - 0.5));
      const std::complex<double> s(0, here);
      const double real = normal(generator), imaginary = normal(generator);
      omega.push_back(here);
      value.push_back((1.0 + std::complex<double>(real, imaginary)) / (1.0 + 1.087 * s + s * s));
    }
    const frac::FrequencyResponseData data(omega, value);
    const double best = frac::fit(data, structure, options).rms;
    constexpr double hopeless = 0;  // whatever it leaves
    const frac::FitResult row =
        frac::detail::fit_in_reach(data, structure, options, hopeless, frac::detail::Profiled::all);
    // Costs that agree to a thousandth are the same minimum.
    EXPECT_NEAR(row.rms, best, 1e-3 * best) << "data of seed " << seed;
    early += row.message.find("not searched further") == std::string::npos ? 0 : 1;
  }
  // A search whose best end is no minimum goes on.
  EXPECT_GT(early, 0);
}

}  // namespace
