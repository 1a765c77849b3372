// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;

constexpr int points = 101;

double omega_of(int i) {
  return std::pow(10.0, -1 + 2.0 * i / (points - 1));
}

/// 2 s^0.7 with 1 % seeded Gaussian noise, one point three times too large.
std::string noisy_power_law(int outlier = -1) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> noise(0, 0.01);
  std::ostringstream stream;
  stream.precision(17);
  stream << "omega_rad_s,re,im\n";
  for (int i = 0; i < points; ++i) {
    const auto exact = 2.0 * std::pow(std::complex<double>(0, omega_of(i)), 0.7);
    const auto value = exact + std::abs(exact) * std::complex<double>(noise(generator), noise(generator));
    const double factor = i == outlier ? 3 : 1;
    stream << omega_of(i) << ',' << factor * value.real() << ',' << factor * value.imag() << '\n';
  }
  return stream.str();
}

Json successful(const std::vector<std::string>& arguments) {
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, 0) << result.error;
  return Json::parse(result.output);
}

class FitStatistics : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> fit(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"fit", data, "--component", "both"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  TemporaryFolder folder;
  std::string data = folder.write("data.csv", noisy_power_law());
};

// One point above the real axis, which no lag reaches: two values, two parameters, neither determined.
TEST_F(FitStatistics, AsFewValuesAsParametersDetermineNothingUnlessTheyAreMet) {
  const auto code = [&](const std::string& name, const std::string& row) {
    return run_fracfit({"fit", folder.write(name, "omega_rad_s,re,im\n" + row), "lag", "--component", "both"}).code;
  };
  EXPECT_EQ(code("above.csv", "1,2,3\n"), 1);
  EXPECT_EQ(code("below.csv", "1,0.5,-0.5\n"), 0);
}

TEST_F(FitStatistics, CorrelationIsAMatrixAndCentreDecorrelates) {
  const auto json = successful(fit({"--model", "power-law"}));
  const auto& matrix = json["correlation"];
  ASSERT_EQ(matrix.size(), 2U);
  EXPECT_EQ(matrix[0][0], 1);
  EXPECT_EQ(matrix[1][1], 1);
  EXPECT_EQ(matrix[0][1], matrix[1][0]);
  EXPECT_LE(std::abs(matrix[0][1].get<double>()), 1);
  // The band is symmetric about 1 rad/s on a logarithmic axis, so K is its own value at the centre.
  EXPECT_NEAR(json["centre_omega"].get<double>(), 1, 1e-12);
  EXPECT_NEAR(json["parameters"][0]["centre"]["value"].get<double>() / json["parameters"][0]["value"].get<double>(), 1,
              1e-12);
  EXPECT_TRUE(successful(fit({"--model", "power-law", "--fix", "a=0.7"}))["correlation"][1][1].is_null());
}

TEST_F(FitStatistics, OutliersAreNamedByIndexAndFrequency) {
  const auto json = successful({"fit", folder.write("outlier.csv", noisy_power_law(30)), "--component", "both",
                                "--model", "power-law", "--loss", "cauchy"});
  ASSERT_EQ(json["outliers"].size(), 1U);
  EXPECT_EQ(json["outliers"][0]["index"], 30);
  EXPECT_NEAR(json["outliers"][0]["omega"].get<double>() / omega_of(30), 1, 1e-14);
}

// The other points alone are another way to the same fit: both see the same numbers, so that every digit agrees.
TEST_F(FitStatistics, PointsThatContradictTheirNeighboursAreLeftOutUnlessKept) {
  const auto file = folder.write("outlier.csv", noisy_power_law(30));
  const std::vector<std::string> command{"fit", file, "--component", "both", "--model", "power-law"};
  const auto run = run_fracfit(command);
  EXPECT_NE(run.error.find("1 of 101 points contradicts its neighbours"), std::string::npos) << run.error;
  const auto json = Json::parse(run.output);
  ASSERT_EQ(json["data"]["left_out"].size(), 1U);
  EXPECT_NEAR(json["data"]["left_out"][0].get<double>() / omega_of(30), 1, 1e-14);
  EXPECT_EQ(json["data"]["points"], 101);
  EXPECT_EQ(json["residuals"], 200);
  ASSERT_EQ(json["outliers"].size(), 1U);
  EXPECT_EQ(json["outliers"][0]["index"], 30);
  EXPECT_TRUE(json["outliers"][0]["left_out"].get<bool>());
  std::istringstream lines(noisy_power_law());
  std::string rest;
  int number = -1;  // the header's
  for (std::string line; std::getline(lines, line); ++number)
    if (number != 30) rest += line + "\n";
  const auto without =
      successful({"fit", folder.write("rest.csv", rest), "--component", "both", "--model", "power-law"});
  EXPECT_EQ(json["parameters"], without["parameters"]);
  auto keep = command;
  keep.insert(keep.end(), {"--outliers", "keep"});
  const auto kept = successful(keep);
  EXPECT_TRUE(kept["data"]["left_out"].empty());
  EXPECT_EQ(kept["residuals"], 202);
  // One residual of 2 among 202 of 0.01 raises their spread from 0.01 to 0.14.
  EXPECT_GT(kept["parameters"][0]["standard_error"].get<double>(),
            5 * json["parameters"][0]["standard_error"].get<double>());
}

TEST_F(FitStatistics, WhitenessTellsAMissingShapeFromNoise) {
  const auto right = successful(fit({"--model", "power-law"}))["whiteness"];
  EXPECT_LT(std::abs(right["lag_one_correlation"].get<double>()), 0.3);  // 3/sqrt(n)
  EXPECT_GT(right["p_value"].get<double>(), 0.001);
  const auto wrong = successful(fit({"--model", "gain"}))["whiteness"];
  EXPECT_GT(wrong["lag_one_correlation"].get<double>(), 0.7);
  EXPECT_LT(wrong["p_value"].get<double>(), 1e-6);
}

TEST_F(FitStatistics, ThreeKindsOfIntervalAgreeOnAnEasyProblem) {
  const auto json = successful(fit({"--model", "power-law", "--profile", "--bootstrap", "400"}));
  EXPECT_EQ(json["bootstrap_samples"], 400);
  for (const auto& parameter : json["parameters"]) {
    const double half = (parameter["ci95"][1].get<double>() - parameter["ci95"][0].get<double>()) / 2;
    // 1 % noise on a power law: nearly linear, so the profile agrees to a few percent of its width.
    for (const int side : {0, 1})
      EXPECT_NEAR(parameter["profile_ci95"][side].get<double>(), parameter["ci95"][side].get<double>(), 0.05 * half);
    // A deviation from 400 refits has a sampling error of 1/sqrt(800) = 3.5 %; the residuals of one data set drawn from
    // stand for the noise to 1/sqrt(2 * 101) = 7 %.  Three of both together.  Resamples hold no smooth error, for which
    // the other one is widened.
    EXPECT_NEAR(parameter["bootstrap_standard_error"].get<double>() * parameter["widening"].get<double>() /
                    parameter["standard_error"].get<double>(),
                1, 0.24);
    EXPECT_LT(parameter["bootstrap_ci95"][0].get<double>(), parameter["value"].get<double>());
    EXPECT_GT(parameter["bootstrap_ci95"][1].get<double>(), parameter["value"].get<double>());
    EXPECT_FALSE(parameter["profile_found_better_minimum"].get<bool>());
  }
  const auto table = run_fracfit(fit({"--model", "power-law", "--profile", "--bootstrap", "20", "--format", "table"}));
  for (const char* part : {"profile likelihood", "bootstrap of 20", "correlation of neighbours"})
    EXPECT_NE(table.output.find(part), std::string::npos) << part << " in:\n" << table.output;
  const auto csv = run_fracfit(fit({"--model", "power-law", "--profile", "--format", "csv"}));
  EXPECT_NE(csv.output.find("fixed,profile_lower,profile_upper,unit,lower_limit,upper_limit\n"), std::string::npos)
      << csv.output;
}

// What the intervals are made of: the deviation of the rows is the standard error that is stated.
TEST_F(FitStatistics, RefitsOfTheBootstrapStandInTheirFile) {
  const TemporaryFolder results;
  const auto file = results.path("refits.csv");
  const auto json = successful(fit({"--model", "power-law", "--bootstrap", "40", "--refits", file}));
  std::vector<double> values;
  for (const auto& line : lines_of(content_of(file)))
    if (!line.starts_with('#') && !line.starts_with("sample"))
      values.push_back(std::stod(line.substr(line.find(',') + 1)));
  ASSERT_EQ(values.size(), 40U);
  double mean = 0, square = 0;
  for (const double value : values) mean += value / 40;
  for (const double value : values) square += (value - mean) * (value - mean);
  const double stated = json["parameters"][0]["bootstrap_standard_error"].get<double>();
  EXPECT_NEAR(std::sqrt(square / 39), stated, 1e-10 * stated);
  EXPECT_EQ(results.entries(), 1U);
}

TEST_F(FitStatistics, AFixedParameterHasNoProfile) {
  const auto json = successful(fit({"--model", "power-law", "--fix", "a=0.7", "--profile"}));
  EXPECT_TRUE(json["parameters"][1]["profile_ci95"].is_null());
  EXPECT_FALSE(json["parameters"][0]["profile_ci95"].is_null());
}

TEST_F(FitStatistics, GrowthStopsAtTheStructureOfTheData) {
  const auto json = successful(fit({"--grow", "powers"}));
  EXPECT_EQ(json["model"], "K1 s^a1");
  EXPECT_EQ(json["growth"]["chosen"], 0);
  EXPECT_EQ(json["growth"]["fits"].size(), 2U);
  // The interval of the order holds the true one; a 95 % interval misses 1 seed in 20, 1.5 of them practically none.
  const double half = 1.5 * 1.98 * json["parameters"][1]["standard_error"].get<double>();
  EXPECT_NEAR(json["parameters"][1]["value"].get<double>(), 0.7, half);
}

TEST_F(FitStatistics, WeightsOfTheLibraryAreAtHand) {
  for (const char* weight : {"smoothed-relative", "log-complex"}) {
    const auto json = successful(fit({"--model", "power-law", "--weight", weight}));
    EXPECT_EQ(json["options"]["weight"], weight);
    // 1 % noise on 202 residuals: K to 0.1 %, the order to 0.1 % of itself; ten of these.
    EXPECT_NEAR(json["parameters"][0]["value"].get<double>(), 2, 0.02);
    EXPECT_NEAR(json["parameters"][1]["value"].get<double>(), 0.7, 0.01);
  }
  EXPECT_EQ(run_fracfit({"fit", data, "--model", "power-law", "--weight", "repeats"}).code, 2);
}

TEST_F(FitStatistics, FoldsAddTheErrorOfPredictions) {
  const auto json = successful({"identify", data, "--component", "both", "--models", "power-law,gain", "--folds", "5"});
  ASSERT_EQ(json["ranking"].size(), 2U);
  ASSERT_EQ(json["ranking"][0]["name"], "power-law");
  // The right model predicts to the noise, 1 %, within its sampling error of 1/sqrt(404) and a little extrapolation.
  EXPECT_NEAR(json["ranking"][0]["prediction_rms"].get<double>(), 0.01, 0.002);
  EXPECT_GT(json["ranking"][1]["prediction_rms"].get<double>(), 0.3);
}

// A long ranking is shortened for the eye, but no candidate may vanish from it without a word.
TEST_F(FitStatistics, TheTableOfARankingNamesEveryCandidate) {
  const std::string models =
      "power-law,gain,lag,integrator,differentiator,r-rc,zarc,zener,oscillator,lag-delay,cole-cole,r-l-cpe";
  const auto json = successful({"identify", data, "--component", "both", "--models", models});
  const auto table =
      run_fracfit({"identify", data, "--component", "both", "--models", models, "--format", "table"}).output;
  const auto named_beneath = table.find("These miss the data too");
  ASSERT_NE(named_beneath, std::string::npos);
  EXPECT_LT(table.find("integer-order"), named_beneath);  // the best rival keeps its row
  for (const auto& candidate : json["ranking"]) {
    const std::string name = candidate["name"];
    EXPECT_TRUE(table.find("  " + name + " ") < named_beneath ||
                table.find(name + " ", named_beneath) != std::string::npos)
        << name;
  }
}

// Roots of s^2 - 0.4 s + 4 are 0.2 +- sqrt(3.96) i, and 1/(2 s + 1) has its pole at -0.5.  tanh is no ratio of sums of
// powers, and nothing is said of its poles.
TEST_F(FitStatistics, UnstableModelsAreCalledSo) {
  const auto fitted = [this](const std::string& formula, const std::string& model) {
    const std::string path = folder.path("exact.csv");
    EXPECT_EQ(run_fracfit({"evaluate", "--model", formula, "--omega", "0.1:10:40log", "--out", path}).code, 0);
    const Json json = successful({"fit", path, "--component", "both", "--model", model, "--format", "json"});
    const auto table = run_fracfit({"fit", path, "--component", "both", "--model", model, "--format", "table"});
    return std::pair{json["stability"], table.output};
  };
  const auto [unstable, says] = fitted("3/(s^2 - 0.4 s + 4)", "b/(s^2 - d s + c)");
  EXPECT_EQ(unstable, "unstable");
  EXPECT_NE(says.find("unstable: poles at s = 0.2 +- 1.99i rad/s"), std::string::npos) << says;
  const auto [stable, says_nothing] = fitted("3/(2 s + 1)", "K/(T s + 1)");
  EXPECT_EQ(stable, "stable");
  EXPECT_EQ(says_nothing.find("unstable"), std::string::npos) << says_nothing;
  EXPECT_TRUE(fitted("tanh(sqrt(3 s))/sqrt(3 s)", "K tanh(sqrt(T s))/sqrt(T s)").first.is_null());
}

// A constant leaves half of a power of .7 over two decades, 50 times the noise; the power itself leaves the noise.
TEST_F(FitStatistics, TheTableSaysThatAModelMissesTheData) {
  const auto table_of = [&](const char* model) {
    return run_fracfit(fit({"--model", model, "--format", "table"})).output;
  };
  const std::string missing = table_of("gain"), following = table_of("K s^a");
  EXPECT_NE(missing.find("the model misses the data: its residuals are "), std::string::npos) << missing;
  EXPECT_EQ(following.find("misses"), std::string::npos) << following;
}

// A circuit of passive elements, without noise: its name stands in JSON, and in the table in the place of its formula.
TEST_F(FitStatistics, AGrownCircuitIsNamed) {
  const std::string path = folder.path("circuit.csv");
  const std::string formula = "0.1 + 0.02 s + 2/(1 + (3 s)^0.7)";
  EXPECT_EQ(run_fracfit({"evaluate", "--model", formula, "--omega", "0.01:100:40log", "--out", path}).code, 0);
  const Json growth = successful({"fit", path, "--grow", "elements", "--format", "json"})["growth"];
  const Json& chosen = growth["fits"].at(growth["chosen"].get<std::size_t>());
  EXPECT_EQ(chosen["name"], "elements:R0+L0+(R1|CPE1)");
  EXPECT_EQ(chosen["model"], "R0 + L0 s + R1/(1 + (T1 s)^n1)");
  const auto table = run_fracfit({"fit", path, "--grow", "elements", "--format", "table"});
  EXPECT_NE(table.output.find("\n  R0+L0+(R1|CPE1) "), std::string::npos) << table.output;
}

TEST_F(FitStatistics, WrongUsageIsNamed) {
  const auto expect_refusal = [](const std::vector<std::string>& arguments, const std::string& part) {
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.output, "");
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect_refusal(fit({}), "either --model or --grow");
  expect_refusal(fit({"--model", "gain", "--grow", "arcs"}), "either --model or --grow");
  expect_refusal(fit({"--grow", "trees"}), "powers, denominator, arcs, rational, commensurate, terms or elements");
  expect_refusal(fit({"--grow", "terms", "--fix", "R0=1"}), "have no meaning with --grow terms");
  expect_refusal(fit({"--grow", "elements", "--bound", "R0=1:2"}), "have no meaning with --grow elements");
  expect_refusal(fit({"--grow", "arcs", "--fix", "K=1"}), "K");
  expect_refusal(fit({"--model", "gain", "--bootstrap", "19"}), "--bootstrap '19'");
  expect_refusal({"identify", data, "--folds", "1"}, "--folds '1'");
  expect_refusal({"identify", data, "--folds", "102"}, "101 points");
}

}  // namespace
