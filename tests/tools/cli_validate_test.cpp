// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

// An arc with a resistance before it, 8 points per decade over five decades, rounded to four digits.
std::string spectrum(double drift) {
  std::string text = "frequency_hz,re_ohm,im_ohm\n";
  constexpr int last = 40;
  for (int i = 0; i <= last; ++i) {
    const double frequency = 0.1 * std::pow(10, i / 8.0);
    const std::complex<double> s(0, 2 * 3.14159265358979 * frequency);
    auto value = 10.0 + 100.0 / (1.0 + std::pow(0.01 * s, 0.8));
    value *= 1 + drift * (last - i) / last;
    char line[96];
    std::snprintf(line, sizeof line, "%.9g,%.4g,%.4g\n", frequency, value.real(), value.imag());
    text += line;
  }
  return text;
}

TEST(ValidateCommand, AFileThatCannotBeReadDoesNotKeepTheOthersFromBeingJudged) {
  const TemporaryFolder folder;
  const auto good = folder.write("good.csv", spectrum(0)), later = folder.write("later.csv", spectrum(0.1)),
             broken = folder.write("broken.csv", "frequency_hz,re_ohm,im_ohm\n1,2,oops\n");
  const auto result = run_fracfit({"validate", good, broken, later, "--format", "json"});
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.error.find("broken.csv:2:"), std::string::npos) << result.error;
  const auto rows = nlohmann::json::parse(result.output).at("rows");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].at("validity"), "valid");
  EXPECT_EQ(rows[1].at("validity"), "unreadable");
  EXPECT_EQ(rows[1].at("points"), 0);
  EXPECT_TRUE(rows[1].at("noise").is_null());
  EXPECT_NE(rows[1].at("summary").get<std::string>().find("oops"), std::string::npos);
  EXPECT_EQ(rows[2].at("validity"), "invalid");
  // What the others get is what they get alone.
  EXPECT_EQ(rows[0], nlohmann::json::parse(run_fracfit({"validate", good, "--format", "json"}).output).at("rows")[0]);

  EXPECT_NE(run_fracfit({"validate", broken, good, "--format", "table"}).output.find("broken.csv: unreadable"),
            std::string::npos);
  EXPECT_EQ(run_fracfit({"validate", broken}).code, 3);
  EXPECT_EQ(run_fracfit({"validate", broken, folder.path() + "/missing.csv"}).code, 3);
}

TEST(ValidateCommand, JudgesEveryCurveAndKeepsItsColumns) {
  const TemporaryFolder folder;
  const auto good = folder.write("good.csv", spectrum(0)), drifting = folder.write("drift.csv", spectrum(0.1));
  const auto result = run_fracfit({"validate", good, drifting, "--format", "json"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json.at("level"), 0.05);
  EXPECT_EQ(json.at("accuracy"), 1e-4);
  EXPECT_EQ(json.at("tolerance"), 0.01);
  const auto& rows = json.at("rows");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("file"), good);
  EXPECT_EQ(rows[0].at("validity"), "valid");
  EXPECT_EQ(rows[0].at("points"), 41);
  EXPECT_EQ(rows[1].at("validity"), "invalid");
  EXPECT_NEAR(rows[1].at("drift").get<double>(), 0.1, 0.05);
  for (const char* key : {"curve",
                          "decades",
                          "noise",
                          "noise_floor",
                          "noise_slope",
                          "correlation",
                          "drift_law",
                          "drift_deviation",
                          "detectable_drift",
                          "outliers_rad_s",
                          "mains_rad_s",
                          "real_poles",
                          "pole_pairs",
                          "p_neighbours",
                          "p_neighbourhoods",
                          "p_drift_even",
                          "p_drift_periods",
                          "p_outliers",
                          "p_mains_50",
                          "p_mains_60",
                          "p_step",
                          "step",
                          "step_deviation",
                          "step_below_rad_s",
                          "step_above_rad_s",
                          "largest_residual",
                          "dead_time_s",
                          "reversed_sign",
                          "departs",
                          "consistent_to",
                          "summary"})
    EXPECT_TRUE(rows[0].contains(key)) << key;
  const auto table = run_fracfit({"validate", good, "--format", "table"});
  EXPECT_NE(table.output.find("good.csv: valid: "), std::string::npos) << table.output;
}

// A drift of 10 % does not matter to whoever allows as much; that it is there is said all the same.
TEST(ValidateCommand, DeparturesWithinTheToleranceAreToldAndNoFault) {
  const TemporaryFolder folder;
  const auto data = folder.write("drift.csv", spectrum(0.1));
  const auto result = run_fracfit({"validate", data, "--tolerance", "0.2", "--format", "json"});
  const auto row = nlohmann::json::parse(result.output).at("rows")[0];
  EXPECT_EQ(row.at("validity"), "valid");
  EXPECT_EQ(row.at("departs"), 1);
  // The poles follow most of such a drift, and what they leave is less than it.
  EXPECT_GT(row.at("consistent_to").get<double>(), 0.001);
  EXPECT_LT(row.at("consistent_to").get<double>(), 0.15);
  EXPECT_NE(row.at("summary").get<std::string>().find("drift"), std::string::npos);
}

TEST(ValidateCommand, OfALongSweepSomePointsAreJudged) {
  const TemporaryFolder folder;
  std::string text = "omega_rad_s,re,im\n";
  for (int i = 0; i < 900; ++i) {
    const double omega = 0.01 * std::pow(10, i / 150.0);
    const std::complex<double> value = 1.0 + 3.0 / (1.0 + std::complex<double>(0, omega));
    char line[96];
    std::snprintf(line, sizeof line, "%.9g,%.4g,%.4g\n", omega, value.real(), value.imag());
    text += line;
  }
  const auto data = folder.write("long.csv", text);
  EXPECT_NE(run_fracfit({"validate", data, "--format", "table"}).output.find("by one point in 3"), std::string::npos);
  EXPECT_EQ(run_fracfit({"validate", data, "--all-points", "--format", "table"}).output.find("one point in"),
            std::string::npos);
}

TEST(ValidateCommand, FitAndIdentifySayTheSame) {
  const TemporaryFolder folder;
  const auto data = folder.write("drift.csv", spectrum(0.1));
  const auto alone = run_fracfit({"validate", data, "--format", "json"});
  const auto sentence = nlohmann::json::parse(alone.output).at("rows")[0].at("summary").get<std::string>();
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"fit", data, "--model", "zarc", "--component", "both"},
        std::vector<std::string>{"identify", data, "--models", "zarc,r-rc", "--component", "both"}}) {
    const auto result = run_fracfit(command);
    const auto validity = nlohmann::json::parse(result.output).at("validity");
    EXPECT_EQ(validity.at("verdict"), "invalid");
    EXPECT_EQ(validity.at("sentence"), sentence);
    auto people = command;
    people.insert(people.end(), {"--format", "table"});
    EXPECT_NE(run_fracfit(people).output.find("validity   " + sentence), std::string::npos);
  }
  // One part alone has no partner to be consistent with.
  const auto part = run_fracfit({"fit", data, "--model", "zarc", "--component", "imaginary"});
  EXPECT_FALSE(nlohmann::json::parse(part.output).contains("validity"));
}

// The sentence says what to write, and written so the file is valid.
TEST(ValidateCommand, SaysHowToReadAReversedSign) {
  const TemporaryFolder folder;
  for (const bool is_negative : {false, true}) {
    // The imaginary part stands in the third column with the other sign than its name says.
    std::string text = is_negative ? "frequency_hz,re_ohm,-im_ohm\n" : "frequency_hz,re_ohm,im_ohm\n";
    const std::string given = spectrum(0);
    for (std::size_t begin = given.find('\n') + 1; begin < given.size();) {
      const auto end = given.find('\n', begin);
      std::string line = given.substr(begin, end - begin + 1);
      if (!is_negative) line.erase(line.find(",-") + 1, 1);
      text += line;
      begin = end + 1;
    }
    const auto file = folder.write("reversed.csv", text);
    const std::string way = is_negative ? "f=1,re=2,im=3" : "f=1,re=2,-im=3";
    for (const auto& arguments : std::vector<std::vector<std::string>>{
             {"validate", file}, {"fit", file, "--model", "R0 + R1/(1 + (T s)^a)", "--component", "both"}}) {
      auto asked = arguments;
      asked.insert(asked.end(), {"--format", "table"});
      const auto told = run_fracfit(asked);
      EXPECT_NE(told.output.find("--columns " + way + " reads the other sign"), std::string::npos) << told.output;
    }
    const auto read = run_fracfit({"validate", file, "--columns", way, "--format", "table"});
    EXPECT_NE(read.output.find(": valid:"), std::string::npos) << read.output;
  }
}

TEST(ValidateCommand, DrawsTheResiduals) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", spectrum(0)), picture = folder.path("rest.svg");
  const auto result = run_fracfit({"validate", data, "--picture", picture});
  ASSERT_EQ(result.code, 0) << result.error;
  const std::string drawn = content_of(picture);
  EXPECT_NE(drawn.find("</svg>"), std::string::npos);
  EXPECT_NE(drawn.find("imaginary part"), std::string::npos);
}

TEST(ValidateCommand, WrongUsageAndTooLittleDataAreNamed) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", spectrum(0));
  EXPECT_EQ(run_fracfit({"validate"}).code, 2);
  EXPECT_EQ(run_fracfit({"validate", data, "--level", "1"}).code, 2);
  EXPECT_EQ(run_fracfit({"validate", data, "--accuracy", "1"}).code, 2);
  EXPECT_EQ(run_fracfit({"validate", data, "--tolerance", "-0.1"}).code, 2);
  EXPECT_EQ(run_fracfit({"validate", data, "--picture", folder.path("rest.pdf")}).code, 2);
  const auto onto_itself = run_fracfit({"validate", data, "--picture", data});
  EXPECT_EQ(onto_itself.code, 2) << onto_itself.error;
  EXPECT_EQ(run_fracfit({"validate", folder.path("none.csv")}).code, 3);
  const auto few = run_fracfit({"validate", folder.write("few.csv", "omega_rad_s,re,im\n1,1,0\n2,1,0\n")});
  EXPECT_EQ(few.code, 1);
  EXPECT_NE(few.output.find("undecided"), std::string::npos);
}

}  // namespace
