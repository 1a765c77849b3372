// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using nlohmann::json;

// An arc of 100 at 10 ms with a resistance before it, rounded to four digits.
std::string spectrum() {
  std::string text = "omega_rad_s,re_ohm,im_ohm\n";
  for (int i = 0; i <= 60; ++i) {
    const double omega = 0.1 * std::pow(10, i / 10.0);
    const auto value = 10.0 + 100.0 / (1.0 + std::pow(std::complex<double>(0, 0.01 * omega), 0.8));
    char line[96];
    std::snprintf(line, sizeof line, "%.9g,%.4g,%.4g\n", omega, value.real(), value.imag());
    text += line;
  }
  return text;
}

json only(const json& rows, const std::string& source, const std::string& kind) {
  json found = json::array();
  for (const auto& row : rows)
    if (row.at("source") == source && row.at("kind") == kind) found.push_back(row);
  return found;
}

// The whole area of the arc is 100; sin(0.8 pi)/(0.8 pi) (1e-3)^0.8 of it, less than 0.1 %, lies on each side of the
// band.
TEST(DrtCommand, DataAndAFitShowTheSameArc) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", spectrum()), fit = folder.path("fit.json"),
             picture = folder.path("times.svg");
  const auto fitted = run_fracfit({"fit", data, "--model", "R0 + R/(1 + (T s)^a)", "--format", "json", "--out", fit});
  ASSERT_EQ(fitted.code, 0) << fitted.error;
  const auto result =
      run_fracfit({"drt", data, "--fit", fit, "--tau", "1e-5:10:121log", "--format", "json", "--picture", picture});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto found = json::parse(result.output);
  EXPECT_NEAR(found.at("constant").get<double>(), 10, 0.5);
  for (const char* key : {"inductance", "elastance", "smoothness", "model"}) EXPECT_TRUE(found.contains(key)) << key;
  // Four digits: at most half of the last, 5e-4 of either part, and less on average.
  EXPECT_LT(found.at("fit_misfit").get<double>(), 5e-4);
  EXPECT_GT(found.at("fit_misfit").get<double>(), 1e-5);
  const auto exact = only(found.at("rows"), "fit", "density");
  ASSERT_EQ(exact.size(), 121U);
  for (const auto& row : exact) {
    // K. S. Cole, R. H. Cole (1941), eq. 15; parameters from four digits of 61 points.
    const double tau = row.at("tau_s").get<double>(), order = 0.8 * std::numbers::pi;
    const double density =
        100 * std::sin(order) / (2 * std::numbers::pi * (std::cosh(0.8 * std::log(tau / 0.01)) + std::cos(order)));
    EXPECT_NEAR(row.at("value").get<double>(), density, 0.1) << tau;
    EXPECT_LE(row.at("lower"), row.at("value"));
    EXPECT_GE(row.at("upper"), row.at("value"));
  }
  for (const char* source : {"data", "fit"}) {
    const auto peaks = only(found.at("rows"), source, "peak");
    ASSERT_EQ(peaks.size(), 1U) << source;
    EXPECT_NEAR(std::log10(peaks[0].at("tau_s").get<double>()), -2, 0.05) << source;
    EXPECT_NEAR(peaks[0].at("value").get<double>(), 100, 2) << source;
    EXPECT_LT(peaks[0].at("lower"), peaks[0].at("upper")) << source;
    EXPECT_LT(peaks[0].at("tau_lower"), peaks[0].at("tau_upper")) << source;
  }
  const std::string drawn = content_of(picture);
  EXPECT_NE(drawn.find("</svg>"), std::string::npos);
  EXPECT_NE(drawn.find("data, range"), std::string::npos);
  EXPECT_NE(drawn.find("fit, range"), std::string::npos);
  const auto csv = run_fracfit({"drt", data, "--format", "csv"});
  EXPECT_NE(csv.output.find("source,kind,tau_s,tau_lower,tau_upper,value,lower,upper\n"), std::string::npos);
  EXPECT_EQ(run_fracfit({"drt", data, "--format", "table"}).code, 0);
}

TEST(DrtCommand, SeveralFilesStandByTheirNames) {
  const TemporaryFolder folder;
  const auto one = folder.write("one.csv", spectrum()), two = folder.write("two.csv", spectrum()),
             broken = folder.write("broken.csv", "omega_rad_s,re_ohm,im_ohm\n1,2,oops\n"),
             modulus =
                 folder.write("modulus.csv", "omega_rad_s,re_Pa,im_Pa\n1,2,3\n2,3,4\n3,4,5\n4,4,5\n5,5,5\n6,5,5\n");
  const auto result = run_fracfit({"drt", one, broken, two, "--format", "json"});
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.error.find("broken.csv:2:"), std::string::npos) << result.error;
  const auto rows = json::parse(result.output).at("rows");
  const auto alone = json::parse(run_fracfit({"drt", one, "--format", "json"}).output);
  for (const char* kind : {"constant", "inductance", "elastance", "peak", "density"}) {
    auto expected = only(alone.at("rows"), "data", kind);
    for (const auto& source : {one, two}) {
      auto found = only(rows, source, kind);
      ASSERT_EQ(found.size(), expected.size()) << kind;
      ASSERT_FALSE(found.empty()) << kind;
      for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].at("value"), expected[i].at("value")) << kind;
    }
  }
  // The resistance before the arc, in its interval, which is far from 0: the data tell the one from the other.
  const auto constant = only(alone.at("rows"), "data", "constant")[0];
  EXPECT_LE(constant.at("lower").get<double>(), 10);
  EXPECT_GE(constant.at("upper").get<double>(), 10);
  EXPECT_GT(constant.at("lower").get<double>(), 5);
  EXPECT_EQ(alone.at("constant_lower"), constant.at("lower"));
  EXPECT_EQ(run_fracfit({"drt", broken, folder.path("none.csv")}).code, 3);
  EXPECT_NE(run_fracfit({"drt", one, modulus}).error.find("expected one unit"), std::string::npos);
  EXPECT_EQ(run_fracfit({"drt", one, two, "--fit", "f.json", "--tau", "1,2,3"}).code, 2);
}

template <class Response>
std::string table_of(const Response& response) {
  std::string text = "omega_rad_s,re,im\n";
  for (int i = 0; i <= 60; ++i) {
    const double omega = 0.1 * std::pow(10, i / 10.0);
    const std::complex<double> value = response(std::complex<double>(0, omega));
    char line[96];
    std::snprintf(line, sizeof line, "%.9g,%.6g,%.6g\n", omega, value.real(), value.imag());
    text += line;
  }
  return text;
}

/// Digits of the longest number in a text, without zeros before it.
std::size_t most_digits(const std::string& text) {
  std::size_t most = 0, digits = 0;
  bool in_exponent = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool is_digit = c >= '0' && c <= '9';
    if (c == 'e' && digits > 0) in_exponent = true;
    if (is_digit && !in_exponent && (c != '0' || digits > 0)) most = std::max(most, ++digits);
    if (!is_digit && c != '.' && c != 'e' && c != '-' && c != '+') digits = 0, in_exponent = false;
  }
  return most;
}

// On a terminal what is to be read first stands first, with the digits of its interval: of a peak of data some two.
TEST(DrtCommand, TheTableBeginsWithThePeaks) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", spectrum()), fit = folder.path("fit.json");
  ASSERT_EQ(run_fracfit({"fit", data, "--model", "R0 + R/(1 + (T s)^a)", "--format", "json", "--out", fit}).code, 0);
  const auto result = run_fracfit({"drt", data, "--fit", fit, "--tau", "1e-5:10:21log", "--format", "table"});
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_LE(most_digits(result.output), 6U) << result.output;
  std::vector<std::string> kinds;
  for (const auto& line : lines_of(result.output)) {
    std::istringstream words(line);
    std::string source, kind;
    words >> source >> kind;
    if (source != "data" && source != "fit") continue;
    if (kinds.empty()) {
      EXPECT_LE(most_digits(line), 4U) << line;
    }
    kinds.push_back(kind);
  }
  ASSERT_GT(kinds.size(), 100U);
  EXPECT_EQ(kinds[0], "peak");
  EXPECT_EQ(kinds[1], "peak") << "that of the fit";
  EXPECT_EQ(std::vector<std::string>(kinds.begin() + 2, kinds.begin() + 5),
            (std::vector<std::string>{"constant", "inductance", "elastance"}));
  EXPECT_EQ(std::count(kinds.begin() + 5, kinds.end(), "density"), static_cast<std::ptrdiff_t>(kinds.size()) - 5);
  EXPECT_NE(result.output.find("value_unit"), std::string::npos);
}

// 300000 half turns between the times asked for.
TEST(DrtCommand, LinesThatAreLeftOffAreSaid) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", table_of([](std::complex<double> s) {
                                   const auto root = std::sqrt(1000.0 * s);
                                   return 20.0 * std::tanh(root) / root;
                                 }));
  const auto fit = folder.path("fit.json");
  ASSERT_EQ(run_fracfit({"fit", data, "--model", "R tanh(sqrt(T s))/sqrt(T s)", "--start", "T=900", "--start", "R=19",
                         "--format", "json", "--out", fit})
                .code,
            0);
  const auto result = run_fracfit({"drt", "--fit", fit, "--tau", "1e-9:1e4:21log", "--format", "json"});
  const auto found = json::parse(result.output);
  EXPECT_GT(found.at("lines_left_off").get<double>(), 2e5);
  EXPECT_NE(result.error.find("left off"), std::string::npos) << result.error;
  EXPECT_LE(only(found.at("rows"), "fit", "line").size(), 1000U);
}

// The modulus of a solid of 1 and 50 with an arc of 5 ms: the rising part has the area 50, but for 1e-3 beyond the
// band.
TEST(DrtCommand, TheKernelIsThatWhichFollowsTheData) {
  const TemporaryFolder folder;
  const auto data = folder.write("modulus.csv", table_of([](std::complex<double> s) {
                                   const auto arc = std::pow(0.005 * s, 0.75);
                                   return 1.0 + 50.0 * arc / (1.0 + arc);
                                 }));
  const auto result = run_fracfit({"drt", data, "--format", "json"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto found = json::parse(result.output);
  EXPECT_EQ(found.at("kernel"), "rising");
  EXPECT_LT(std::stod(found.at("misfit").dump()), 0.01);
  const auto peaks = only(found.at("rows"), "data", "peak");
  ASSERT_FALSE(peaks.empty());
  EXPECT_NEAR(std::log10(peaks[0].at("tau_s").get<double>()), std::log10(0.005), 0.05);
  EXPECT_NEAR(peaks[0].at("value").get<double>(), 50, 1);
  const auto wrong = run_fracfit({"drt", data, "--kernel", "falling", "--format", "json"});
  EXPECT_EQ(wrong.code, 1);
  EXPECT_NE(wrong.error.find("try the other --kernel"), std::string::npos) << wrong.error;

  const auto fit = folder.path("fit.json");
  ASSERT_EQ(run_fracfit({"fit", data, "--model", "E0 + E1 (T s)^a/(1 + (T s)^a)", "--component", "both", "--format",
                         "json", "--out", fit})
                .code,
            0);
  const auto exact = run_fracfit({"drt", "--fit", fit, "--tau", "1e-4:1:41log", "--format", "json"});
  EXPECT_EQ(exact.code, 0) << exact.error;
  EXPECT_EQ(json::parse(exact.output).at("kernel"), "rising");
  const auto negative =
      run_fracfit({"drt", "--fit", fit, "--tau", "1e-4:1:41log", "--kernel", "falling", "--format", "json"});
  EXPECT_EQ(negative.code, 1);
  EXPECT_NE(negative.error.find("negative"), std::string::npos) << negative.error;
}

// Complex poles, and an arc of the wrong sign: sums of relaxations of a positive area do neither.
TEST(DrtCommand, DataThatNoDistributionFollowsAreNamed) {
  const TemporaryFolder folder;
  const auto resonance = folder.write(
      "resonance.csv", table_of([](std::complex<double> s) { return 1.0 / (s * s / 900.0 + 0.3 * s / 30.0 + 1.0); }));
  const auto reversed = folder.write(
      "reversed.csv", table_of([](std::complex<double> s) { return 10.0 + 80.0 / (1.0 + std::pow(-0.02 * s, 0.85)); }));
  for (const auto& data : {resonance, reversed}) {
    const auto result = run_fracfit({"drt", data, "--format", "json"});
    EXPECT_EQ(result.code, 1) << data;
    EXPECT_NE(result.error.find("no distribution of relaxation times"), std::string::npos) << result.error;
    EXPECT_GT(std::stod(json::parse(result.output).at("misfit").dump()), 0.01);
  }
}

TEST(DrtCommand, WrongUsageAndUselessDataAreNamed) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", spectrum());
  EXPECT_EQ(run_fracfit({"drt"}).code, 2);
  EXPECT_EQ(run_fracfit({"drt", data, "--tau", "1:10:5log"}).code, 2);
  EXPECT_EQ(run_fracfit({"drt", data, "--kernel", "sideways"}).code, 2);
  EXPECT_EQ(run_fracfit({"drt", data, "--picture", folder.path("times.pdf")}).code, 2);
  EXPECT_EQ(run_fracfit({"drt", "--fit", folder.path("none.json")}).code, 2);
  EXPECT_EQ(run_fracfit({"drt", "--fit", folder.path("none.json"), "--tau", "1:10:5log"}).code, 3);
  EXPECT_EQ(run_fracfit({"drt", folder.path("none.csv")}).code, 3);
  const auto few = run_fracfit({"drt", folder.write("few.csv", "omega_rad_s,re,im\n1,1,0\n2,1,0\n")});
  EXPECT_NE(few.code, 0);
  EXPECT_NE(few.error.find("6 points"), std::string::npos) << few.error;
}

// Two spectra in one file: refused as one curve, and the way that the refusal names leads to the spectrum alone.
TEST(DrtCommand, TakesOneCurveOfSeveral) {
  const TemporaryFolder folder;
  std::string both = "temperature," + spectrum().substr(0, spectrum().find('\n') + 1);
  for (const char* temperature : {"280", "320"}) {
    std::istringstream lines(spectrum());
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) both += std::string(temperature) + ',' + line + '\n';
  }
  const auto alone = folder.write("alone.csv", spectrum()), several = folder.write("several.csv", both);
  const auto expected = run_fracfit({"drt", alone, "--format", "json"});
  const auto taken = run_fracfit({"drt", several, "--where", "temperature==320", "--format", "json"});
  ASSERT_EQ(taken.code, 0) << taken.error;
  EXPECT_EQ(json::parse(taken.output).at("rows"), json::parse(expected.output).at("rows"));
  for (const auto& wrong :
       std::vector<std::vector<std::string>>{{"drt", several, "--where", "omega<<4"}, {"drt", "--where", "omega<4"}})
    EXPECT_EQ(run_fracfit(wrong).code, 2);
}

}  // namespace
