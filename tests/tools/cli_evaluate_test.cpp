// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

// Rows of numbers below the names of a CSV result.
std::vector<std::vector<double>> rows_of(const std::string& csv, std::string& names) {
  std::vector<std::vector<double>> rows;
  for (const auto& line : lines_of(csv)) {
    if (line.starts_with('#')) continue;
    if (names.empty()) {
      names = line;
      continue;
    }
    std::istringstream fields(line);
    auto& row = rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) row.push_back(std::stod(field));
  }
  return rows;
}

TEST(Evaluate, GivesALagAndItsDerivativesInClosedForm) {
  const auto result = run_fracfit(
      {"evaluate", "K/(T s + 1)", "--fix", "K=3", "--fix", "T=0.25", "--omega", "0.1:1000:9log", "--derivatives"});
  ASSERT_EQ(result.code, 0) << result.error;
  std::string names;
  const auto rows = rows_of(result.output, names);
  EXPECT_EQ(names, "omega_rad_s,re,im,d_re_d_K,d_im_d_K,d_re_d_T,d_im_d_T");
  ASSERT_EQ(rows.size(), 9U);
  for (const auto& row : rows) {
    const std::complex<double> s(0, row[0]), lag = 1.0 / (0.25 * s + 1.0);
    const std::complex<double> expected[] = {3.0 * lag, lag, -3.0 * s * lag * lag};
    // Some ten roundings of complex numbers.
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LE(std::abs(std::complex<double>(row[1 + 2 * k], row[2 + 2 * k]) - expected[k]),
                1e-14 * std::abs(expected[k]));
  }
}

// The band of a gain is the interval of the gain, at every frequency.
TEST(Evaluate, BandOfAGainIsItsInterval) {
  const TemporaryFolder folder;
  std::string data = "omega_rad_s,re,im\n";
  for (int i = 1; i <= 12; ++i) data += std::to_string(i) + "," + std::to_string(2 + 0.02 * std::sin(7 * i)) + ",0\n";
  const auto fit = folder.path("fit.json");
  ASSERT_EQ(run_fracfit({"fit", folder.write("data.csv", data), "--model", "gain", "--component", "real", "--weight",
                         "absolute", "--out", fit})
                .code,
            0);
  const auto parameter = nlohmann::json::parse(content_of(fit)).at("parameters").at(0);
  ASSERT_EQ(parameter.at("interval"), "curvature");
  const auto result = run_fracfit({"evaluate", "--fit", fit, "--omega", "0.5,50"});
  ASSERT_EQ(result.code, 0) << result.error;
  std::string names;
  const auto rows = rows_of(result.output, names);
  EXPECT_EQ(names, "omega_rad_s,re,im,re_ci95_lower,re_ci95_upper,im_ci95_lower,im_ci95_upper");
  ASSERT_EQ(rows.size(), 2U);
  for (const auto& row : rows) {
    EXPECT_DOUBLE_EQ(row[1], parameter.at("value").get<double>());
    EXPECT_NEAR(row[3], parameter.at("ci95").at(0).get<double>(), 1e-12);
    EXPECT_NEAR(row[4], parameter.at("ci95").at(1).get<double>(), 1e-12);
    EXPECT_EQ(row[5], 0);
    EXPECT_EQ(row[6], 0);
  }
}

// The band of a lag where it is flat is the interval of its gain; the offset of the record is none of its parameters.
TEST(Evaluate, TakesAFitOverTime) {
  const TemporaryFolder folder;
  std::string data = "time_s,input,output\n";
  for (int i = 0; i < 60; ++i) {
    const double t = 0.1 * i;
    data += std::to_string(t) + ",1," + std::to_string(2 - 2 * std::exp(-t) + 0.02 * std::sin(7 * i)) + "\n";
  }
  const auto fit = folder.path("fit.json");
  ASSERT_EQ(run_fracfit({"fit", folder.write("step.csv", data), "--model", "lag", "--trend", "--out", fit}).code, 0);
  const auto gain = nlohmann::json::parse(content_of(fit)).at("parameters").at(0);
  ASSERT_EQ(gain.at("interval"), "curvature");
  const auto result = run_fracfit({"evaluate", "--fit", fit, "--omega", "1e-9"});
  ASSERT_EQ(result.code, 0) << result.error;
  std::string names;
  const auto row = rows_of(result.output, names).at(0);
  EXPECT_NEAR(row[1], gain.at("value").get<double>(), 1e-12);
  EXPECT_NEAR(row[3], gain.at("ci95").at(0).get<double>(), 1e-12);
  EXPECT_NEAR(row[4], gain.at("ci95").at(1).get<double>(), 1e-12);
}

TEST(Evaluate, WrongUsageAndFilesThatAreNoFitAreNamed) {
  const TemporaryFolder folder;
  const auto expect = [](const std::vector<std::string>& arguments, int code, const std::string& part) {
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, code) << result.error;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect({"evaluate", "K/(T s + 1)", "--fix", "K=3", "--omega", "1"}, 2, "--fix T=VALUE is missing");
  expect({"evaluate", "K/(T s + 1)", "--fix", "K=3", "--fix", "T=1", "--fix", "L=1", "--omega", "1"}, 2, "L");
  expect({"evaluate", "1/s", "--omega", "0,1"}, 2, "--omega");
  expect({"evaluate", "--omega", "1"}, 2, "--model");
  expect({"evaluate", "--fit", folder.write("no.json", "[1]"), "--omega", "1"}, 3, "no.json: is no JSON object");
  expect({"evaluate", "--fit", folder.write("half.json", "{\"model\":\"1/s\"}"), "--omega", "1"}, 3, "'residuals'");
}

// Rows are written one by one, and no machine writes a million of them in 10 ms.
TEST(Evaluate, EndsAtItsTimeLimitWhileItWritesRows) {
  const auto result = run_fracfit({"evaluate", "1/(s + 1)", "--omega", "1:10:1000000", "--time-limit", "0.01"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.error.find("--time-limit 0.01: the time is over"), std::string::npos) << result.error;
  EXPECT_EQ(result.output, "");
}

}  // namespace
