// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* no_noise = "These data carry no noise: what counts is how many parameters buy which error.";

/// Lines are broken to the width of a page.
std::string in_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

void expect_no_word_of_chance(const std::string& output) {
  EXPECT_NE(in_one_line(output).find(no_noise), std::string::npos) << output;
  for (const char* hidden : {"95 %", "standard error", "+-", "AICc", "odds", "chance", "white noise", "not identified"})
    EXPECT_EQ(in_one_line(output).find(hidden), std::string::npos) << hidden << "\n" << output;
}

class EconomyOutput : public testing::Test {
 protected:
  /// The paper's scene from 19.1 to 35 rad/s, where the masses meet twice a period.
  [[nodiscard]] std::string simulated(const std::string& force = "40") const {
    std::string file = folder.path("two" + force + ".csv");
    const auto result = run_fracfit({"simulate", "--force", force, "--clearance", "0.3", "--restitution", "0.6",
                                     "--omega", "19.1:35:160", "--out", file});
    EXPECT_EQ(result.code, 0) << result.error;
    return file;
  }
  TemporaryFolder folder;
};

const Json* curve_of(const Json& economy, const std::string& name) {
  for (const Json& curve : economy["curves"]) {
    if (curve["name"] == name) return &curve;
  }
  return nullptr;
}

// Figures known to the digits that are written: K1/s^3 + K2 s leaves 0.173 % of the imaginary part, K s^a 1.63 %.
TEST_F(EconomyOutput, OfComputedDataStandsBesideTheVerdict) {
  const auto result = run_fracfit({"identify", simulated(), "--component", "imaginary", "--models", "power-law,lag"});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  for (const char* key : {"verdict", "evidence", "log10_odds", "ranking"}) EXPECT_TRUE(json.contains(key)) << key;
  const Json& economy = json["economy"];
  ASSERT_TRUE(economy.is_object());
  for (const char* key : {"evidence", "log10_odds", "fractional", "integer"}) EXPECT_TRUE(json[key].is_null()) << key;
  EXPECT_NE(json["verdict_sentence"].get<std::string>().find(economy["sentence"].get<std::string>()), std::string::npos)
      << json["verdict_sentence"];
  EXPECT_EQ(economy["verdict"], "integer-cheaper");
  EXPECT_EQ(economy["component"], "imaginary");
  const Json *const whole = curve_of(economy, "integer-powers-of-s"), *const real = curve_of(economy, "real-powers"),
                    *const given = curve_of(economy, "static-backlash");
  ASSERT_TRUE(whole && real && given);
  EXPECT_EQ((*whole)["needs"], Json({2, 3, 4}));
  EXPECT_EQ((*whole)["points"][1]["parameters"], 2);
  EXPECT_NEAR((*whole)["points"][1]["error"].get<double>(), 0.00173, 5e-6);
  EXPECT_EQ((*whole)["points"][1]["proven"], true);
  EXPECT_NEAR((*real)["points"][0]["error"].get<double>(), 0.0163, 5e-5);
  EXPECT_EQ((*given)["class"], "given");
  EXPECT_EQ((*given)["needs"], Json({nullptr, nullptr, nullptr}));
}

TEST_F(EconomyOutput, TakesThePlaceOfEvidenceInTheTable) {
  const auto result = run_fracfit(
      {"identify", simulated(), "--component", "imaginary", "--models", "power-law,lag", "--format", "table"});
  ASSERT_EQ(result.code, 0) << result.error;
  for (const char* shown : {"parameters needed", "whole powers of s", "economy: integer-cheaper."}) {
    EXPECT_NE(result.output.find(shown), std::string::npos) << shown << "\n" << result.output;
  }
  expect_no_word_of_chance(result.output);
  for (const char* hidden : {"Akaike", "verdict:"}) {
    EXPECT_EQ(result.output.find(hidden), std::string::npos) << hidden << "\n" << result.output;
  }
}

std::string rows_of(double noise, bool with_zero) {
  std::ostringstream rows;
  rows.precision(17);
  rows << "omega_rad_s,re,im\n";
  for (int i = 0; i < 30; ++i) {
    const double omega = std::pow(10, i / 20.0), scatter = 1 + noise * std::sin(37.0 * i * i);
    // 2 s^2 has no imaginary part; 3 s^1 no real one.
    rows << omega << ',' << -2 * omega * omega * scatter << ',' << (with_zero && i == 0 ? 0 : 3 * omega * scatter)
         << '\n';
  }
  return rows.str();
}

// K s^a misses Im N by 1.6 %, smoothly: an error of the model, of which no chance is told.  JSON keeps its numbers and
// says what they are worth.
TEST_F(EconomyOutput, FitsOfComputedDataSpeakOfNoChance) {
  const std::vector<std::string> fit{"fit", simulated(), "--component", "imaginary", "--model", "power-law"};
  std::vector<std::string> table = fit;
  table.insert(table.end(), {"--format", "table", "--derive", "f = K^a"});
  const auto result = run_fracfit(table);
  ASSERT_EQ(result.code, 0) << result.error;
  expect_no_word_of_chance(result.output);
  const Json json = Json::parse(run_fracfit(fit).output);
  EXPECT_EQ(json["without_noise"], true);
  EXPECT_TRUE(json["parameters"][0]["standard_error"].is_number());
  EXPECT_EQ(json["message"].get<std::string>().find("white noise"), std::string::npos) << json["message"];

  const auto joint = run_fracfit({"joint-fit", simulated(), simulated("45"), "--component", "imaginary", "--model",
                                  "power-law", "--shared", "a", "--format", "table"});
  ASSERT_EQ(joint.code, 0) << joint.error;
  expect_no_word_of_chance(joint.output);
}

// From 5 to 19 rad/s the motion is long or chaotic, and residuals of K s^a leave neither of its parameters an interval
// within half its value, which would be a fault of a measurement.
TEST_F(EconomyOutput, NoParameterOfComputedDataIsCalledUnidentified) {
  const std::string file = folder.path("between.csv");
  ASSERT_EQ(run_fracfit({"simulate", "--force", "40", "--clearance", "0.3", "--restitution", "0.6", "--omega",
                         "5:19:80", "--out", file})
                .code,
            0);
  const auto result = run_fracfit({"fit", file, "--component", "imaginary", "--model", "power-law"});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  for (const Json& each : json["parameters"]) EXPECT_EQ(each["identified"], false);
  EXPECT_EQ(result.error.find("identified"), std::string::npos) << result.error;
}

TEST_F(EconomyOutput, FitsKnowDataWithoutNoiseByTheirResidualsToo) {
  const auto output = [&](double noise) {
    return run_fracfit({"fit", folder.write("data.csv", rows_of(noise, false)), "--model", "K1 s + K2 s^2", "--format",
                        "table"})
        .output;
  };
  expect_no_word_of_chance(output(0));
  EXPECT_NE(output(0.01).find("95 % interval"), std::string::npos);
  EXPECT_EQ(output(0.01).find("no noise"), std::string::npos);
}

// Its points are computed, whatever the criterion.
TEST_F(EconomyOutput, LawsOfTheJumpHaveNoIntervals) {
  const auto result = run_fracfit({"jump-law", "--restitution", "0.6", "--format", "table"});
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.output.find("Delta^-0.5,  b = 0.5 Delta^0\n"), std::string::npos) << result.output;
  EXPECT_EQ(result.output.find("95 %"), std::string::npos) << result.output;
}

// Told without a header by residuals at rounding; noise of a per cent is evidence for `verdict` alone.
TEST_F(EconomyOutput, IsToldOfExactDataAndNotOfNoisyOnes) {
  const std::vector<std::string> models{"--component", "both", "--models", "K1 s + K2 s^2,lag"};
  const auto economy = [&](const std::string& file) {
    std::vector<std::string> arguments{"identify", file};
    arguments.insert(arguments.end(), models.begin(), models.end());
    const auto result = run_fracfit(arguments);
    return Json::parse(result.output)["economy"];
  };
  EXPECT_TRUE(economy(folder.write("noisy.csv", rows_of(0.01, false))).is_null());
  const Json exact = economy(folder.write("exact.csv", rows_of(0, false)));
  ASSERT_TRUE(exact.is_object());
  EXPECT_EQ((*curve_of(exact, "integer-powers-of-s"))["needs"], Json({2, 2, 2}));
  EXPECT_NE(exact["sentence"].get<std::string>().find("3 s + 2 s^2"), std::string::npos) << exact["sentence"];
}

// Where the imaginary part is 0 it has no relative error: it is said, and the ranking stands.
TEST_F(EconomyOutput, SaysWhereNoRelativeErrorExists) {
  const std::string file = folder.write("real.csv", "# command: fracfit simulate --force 1\n" + rows_of(0, true));
  const auto result = run_fracfit({"identify", file, "--component", "imaginary", "--weight", "absolute", "--outliers",
                                   "keep", "--models", "power-law,gain"});
  EXPECT_NE(result.error.find("imaginary part at omega = 1 rad/s is 0, where no relative error exists"),
            std::string::npos)
      << result.error;
  EXPECT_TRUE(Json::parse(result.output)["economy"].is_null());
}

}  // namespace
