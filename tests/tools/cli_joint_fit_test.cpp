// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;

/// Power laws K s^0.7 with K = 2, 3, 4 as three files, or as one file with the gain in a column.
struct PowerLaws {
  TemporaryFolder folder;
  std::vector<std::string> files;
  std::string one_file;
  PowerLaws() {
    std::ostringstream together;
    together.precision(17);
    together << "gain,omega_rad_s,re,im\n";
    for (int gain = 2; gain <= 4; ++gain) {
      std::ostringstream text;
      text.precision(17);
      text << "omega_rad_s,re,im\n";
      for (int i = 0; i <= 20; ++i) {
        const double omega = std::pow(10.0, -1 + i / 10.0);
        const std::complex<double> value = static_cast<double>(gain) * std::pow(std::complex<double>(0, omega), 0.7);
        text << omega << ',' << value.real() << ',' << value.imag() << '\n';
        together << gain << ',' << omega << ',' << value.real() << ',' << value.imag() << '\n';
      }
      files.push_back(folder.write("gain" + std::to_string(gain) + ".csv", text.str()));
    }
    one_file = folder.write("all.csv", together.str());
  }
  [[nodiscard]] ProgramResult joint(std::vector<std::string> data, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"joint-fit"};
    arguments.insert(arguments.end(), data.begin(), data.end());
    arguments.insert(arguments.end(), {"--model", "K s^a", "--component", "both"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_fracfit(arguments);
  }
};

// K = gain, told by the column: K0 = 1 and p = 1, as closely as the search ends.
TEST(JointFitCommand, AParameterFollowsALaw) {
  const PowerLaws data;
  const auto result = data.joint({data.one_file}, {"--by", "gain", "--shared", "a", "--law", "K = K0 gain^p"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  ASSERT_EQ(json["shared"].size(), 3U);
  EXPECT_EQ(json["shared"][1]["name"], "K0");
  EXPECT_NEAR(json["shared"][1]["value"].get<double>(), 1, 1e-7);
  EXPECT_EQ(json["shared"][2]["name"], "p");
  EXPECT_NEAR(json["shared"][2]["value"].get<double>(), 1, 1e-7);
  EXPECT_NEAR(json["curves"][2]["parameters"][0]["value"].get<double>(), 4, 1e-6);
  const auto table =
      data.joint({data.one_file}, {"--by", "gain", "--shared", "a", "--law", "K = K0 gain^p", "--format", "table"});
  EXPECT_NE(table.output.find("laws       K = K0 gain^p"), std::string::npos) << table.output;
  const auto unknown = data.joint({data.one_file}, {"--by", "gain", "--shared", "a", "--law", "K = K0 load^p"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.error.find("known of the curves"), std::string::npos) << unknown.error;
}

// The values that made the data, to what 17 digits and the tolerance of the search leave.
void expect_power_laws(const ProgramResult& result) {
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  EXPECT_EQ(json["model"], "K s^a");
  EXPECT_EQ(json["termination"], "converged");
  ASSERT_EQ(json["shared"].size(), 1U);
  EXPECT_EQ(json["shared"][0]["name"], "a");
  EXPECT_NEAR(json["shared"][0]["value"].get<double>(), 0.7, 1e-8);
  ASSERT_EQ(json["curves"].size(), 3U);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(json["curves"][c]["parameters"][0]["name"], "K");
    EXPECT_NEAR(json["curves"][c]["parameters"][0]["value"].get<double>(), 2 + static_cast<double>(c), 1e-7);
    EXPECT_EQ(json["curves"][c]["points"], 21);
  }
}

TEST(CliJointFit, FitsFilesAndTheCurvesOfOneFileAlike) {
  const PowerLaws data;
  expect_power_laws(data.joint(data.files, {"--shared", "a"}));
  expect_power_laws(data.joint(data.files, {"--each", "K"}));
  expect_power_laws(data.joint({data.one_file}, {"--by", "gain", "--each", "K"}));
}

TEST(CliJointFit, TableAndCsvNameSharedAndOwnParameters) {
  const PowerLaws data;
  const auto table = data.joint(data.files, {"--shared", "a", "--format", "table"});
  ASSERT_EQ(table.code, 0) << table.error;
  for (const char* part : {"shared", "gain3.csv", "alone", "converged"})
    EXPECT_NE(table.output.find(part), std::string::npos) << part << "\n" << table.output;
  const auto csv = data.joint(data.files, {"--shared", "a", "--format", "csv"});
  ASSERT_EQ(csv.code, 0) << csv.error;
  EXPECT_NE(csv.output.find("\ncurve,name,value,standard_error,ci95_lower,ci95_upper,identified,at_bound,shared\n"),
            std::string::npos)
      << csv.output;
}

// 1/(2 pi K) of each gain, in JSON and as a row of each curve.
TEST(CliJointFit, DerivesQuantitiesOfEachCurve) {
  const PowerLaws data;
  const auto result = data.joint(data.files, {"--shared", "a", "--derive", "g = 1/(2 pi K)"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected = 1 / (2 * std::numbers::pi * (2 + static_cast<double>(c)));
    EXPECT_EQ(json["curves"][c]["derived"][0]["name"], "g");
    EXPECT_NEAR(json["curves"][c]["derived"][0]["value"].get<double>(), expected, 1e-7);
  }
  const auto single =
      run_fracfit({"fit", data.files[0], "--model", "K s^a", "--component", "both", "--derive", "g=K^2"});
  ASSERT_EQ(single.code, 0) << single.error;
  const auto fit = Json::parse(single.output);
  ASSERT_EQ(fit["derived"].size(), 1U);
  EXPECT_NEAR(fit["derived"][0]["value"].get<double>(), 4, 1e-6);
  const auto wrong = run_fracfit({"fit", data.files[0], "--model", "K s^a", "--derive", "g=M"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.error.find("--derive"), std::string::npos) << wrong.error;
}

// A law of known quantities alone leaves nothing of it to be fitted.
TEST(JointFitCommand, ALawMayHoldNoParameter) {
  const PowerLaws data;
  const auto result = data.joint({data.one_file}, {"--by", "gain", "--shared", "a", "--law", "K = gain"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  ASSERT_EQ(json["shared"].size(), 1U);
  EXPECT_NEAR(json["shared"][0]["value"].get<double>(), 0.7, 1e-7);
}

TEST(CliJointFit, WrongUsageIsNamed) {
  const PowerLaws data;
  const auto expect = [&](const std::vector<std::string>& more, const std::string& part) {
    const auto result = data.joint(data.files, more);
    EXPECT_EQ(result.code, 2) << result.error;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect({}, "--shared");
  expect({"--shared", "a", "--each", "K"}, "--each");
  expect({"--shared", "b"}, "b");
  expect({"--each", "K,a"}, "batch");
  expect({"--shared", "a", "--fix", "a=0.7"}, "fixed");
  expect({"--shared", "a", "--loss", "huber"}, "--loss");
  EXPECT_EQ(data.joint({data.folder.path("none.csv")}, {"--shared", "a"}).code, 3);
}

}  // namespace
