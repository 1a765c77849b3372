// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> approximate(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"approximate"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

Json approximated(const std::vector<std::string>& more) {
  const auto result = run_fracfit(approximate(more));
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_EQ(result.error, "");
  return Json::parse(result.output);
}

// Largest |H/(j omega)^order - 1| of what the output says, in plain double: good to 1e-14 with tens of factors.
double error_of(const Json& json) {
  const double lower = json["band"]["lower"];
  const double upper = json["band"]["upper"];
  const double order = json["order"];
  double largest = 0;
  for (int i = 0; i <= 20'000; ++i) {
    const double omega = lower * std::pow(upper / lower, i / 20'000.0);
    const std::complex<double> s(0, omega);
    std::complex<double> value = json["gain"].get<double>() * std::pow(s, json["integer_order"].get<int>());
    for (std::size_t k = 0; k < json["poles"].size(); ++k)
      value *= (s - json["zeros"][k].get<double>()) / (s - json["poles"][k].get<double>());
    const auto exact = std::polar(std::pow(omega, order), order * std::numbers::pi / 2);
    largest = std::max(largest, std::abs(value / exact - 1.0));
  }
  return largest;
}

TEST(Approximate, JsonHoldsTheContractAndTheStatedErrorIsTrue) {
  for (const char* order : {"0.5", "-0.5", "1.3"}) {
    const auto json = approximated({"--order", order, "--band", "1e-3:1e3", "--tolerance", "1e-6"});
    for (const char* key : {"fracfit", "command", "order", "band", "method", "zeros", "poles", "gain",
                            "max_relative_error", "limit_poles", "parallel", "status"})
      EXPECT_TRUE(json.contains(key)) << key;
    EXPECT_EQ(json["method"], "ladder");
    EXPECT_EQ(json["status"], "met");
    EXPECT_LE(json["max_relative_error"].get<double>(), 1e-6);
    EXPECT_NEAR(error_of(json) / json["max_relative_error"].get<double>(), 1, 0.02);
    EXPECT_LE(json["poles"].size(), json["limit_poles"].get<std::size_t>() + 1);
    EXPECT_EQ(json["poles"].size(), json["zeros"].size());
  }
}

TEST(Approximate, AmplificationTradesAccuracyAtTheEdge) {
  const std::vector<std::string> quarter{"--order", "0.5",           "--band", "1:1570",         "--tolerance",
                                         "1e-3",    "--sample-time", "1e-3",   "--amplification"};
  double last = 1;
  for (const char* bound : {"1.5", "3", "6"}) {
    std::vector<std::string> arguments = quarter;
    arguments.emplace_back(bound);
    const auto json = Json::parse(run_fracfit(approximate(arguments)).output);
    EXPECT_LE(json["digital"]["most_amplification_beyond_band"].get<double>(), 1.05 * std::stod(bound));
    const double error = json["digital"]["max_relative_error"];
    EXPECT_LT(error, last);
    last = error;
  }
}

// Response of taps and parallel sections as the output states them, in z-form.
std::complex<double> sampled_response(const Json& json, double omega) {
  const double step = json["sample_time"];
  const std::complex<double> delta = std::polar(1.0, omega * step) - 1.0;
  const Json& digital = json["digital"];
  const bool of_states = digital["parallel"]["output"] == "state";
  std::complex<double> value = digital["parallel"]["direct"].get<double>();
  for (const Json& section : digital["parallel"]["sections"])
    value += section["weight"].get<double>() * (of_states ? 1.0 : delta) / (delta + section["rate"].get<double>());
  std::complex<double> taps = 0, past = 1;
  for (const Json& tap : digital["taps"]) {
    taps += tap.get<double>() * past;
    past /= 1.0 + delta;
  }
  value *= taps;
  for (int i = 0; i < digital["differences"].get<int>(); ++i) value *= delta / (1.0 + delta) / step;
  for (int i = 0; i < digital["integrators"].get<int>(); ++i) value *= step * (0.5 + 1.0 / delta);
  return value;
}

TEST(Approximate, SampleTimeGivesSectionsThatDoWhatTheyState) {
  for (const char* order : {"0.5", "-0.5", "1.3", "-1.3"}) {
    for (const char* method : {"direct", "tustin", "al-alaoui"}) {
      const auto result = run_fracfit(approximate({"--order", order, "--band", "0.1:300", "--tolerance", "1e-2",
                                                   "--sample-time", "1e-3", "--discretisation", method}));
      const auto json = Json::parse(result.output);
      EXPECT_EQ(result.code, json["status"] == "met" ? 0 : 1) << result.error;
      EXPECT_EQ(json["digital"]["discretisation"], method);
      EXPECT_FALSE(json["sections"].empty());
      const double q = json["order"];
      double largest = 0;
      for (int i = 0; i <= 2000; ++i) {
        const double omega = 0.1 * std::pow(3000.0, i / 2000.0);
        const auto exact = std::polar(std::pow(omega, q), q * std::numbers::pi / 2);
        largest = std::max(largest, std::abs(sampled_response(json, omega) / exact - 1.0));
      }
      EXPECT_NEAR(largest / json["digital"]["max_relative_error"].get<double>(), 1, 0.02) << order << " " << method;
      if (method == std::string("direct")) {
        EXPECT_EQ(json["digital"]["status"], "met");
        EXPECT_LE(largest, 1e-2);
      }
    }
  }
}

TEST(Approximate, ARecursionThatMissesTheToleranceIsNoUsableResult) {
  for (const char* method : {"direct", "tustin", "al-alaoui", "grunwald-letnikov"}) {
    for (const char* format : {"json", "csv"}) {
      const auto result =
          run_fracfit(approximate({"--order", "0.5", "--band", "0.1:300", "--tolerance", "1e-4", "--sample-time",
                                   "1e-3", "--discretisation", method, "--format", format}));
      const bool met = method == std::string("direct");
      EXPECT_EQ(result.code, met ? 0 : 1) << method;
      EXPECT_EQ(result.error.find("Tolerance 0.0001 is not attainable by " + std::string(method)) == std::string::npos,
                met)
          << result.error;
      const std::string status = met ? "met" : "missed";
      if (format == std::string("csv")) {
        EXPECT_NE(result.output.find("\n# status: " + status + "\n"), std::string::npos) << result.output;
        continue;
      }
      const auto json = Json::parse(result.output);
      EXPECT_EQ(json["status"], status);
      EXPECT_EQ(json["digital"]["max_relative_error"].get<double>() <= 1e-4, met);
      EXPECT_LE(json["max_relative_error"].get<double>(), 1e-4);
    }
  }
}

// At half the sampling frequency z = -1, so that each section is known in closed form.
TEST(Approximate, TheGainBeyondTheBandOfAFallingPowerIsOverThatAtItsEdge) {
  const std::vector<std::string> asked{"--band",        "0.1:300", "--poles",          "6",
                                       "--sample-time", "1e-3",    "--discretisation", "tustin"};
  for (const double order : {0.5, -0.5}) {
    std::vector<std::string> all{"--order=" + std::to_string(order)};
    all.insert(all.end(), asked.begin(), asked.end());
    const Json digital = Json::parse(run_fracfit(approximate(all)).output).at("digital");
    const Json& parallel = digital.at("parallel");
    double gain = parallel.at("direct");
    for (const Json& section : parallel.at("sections")) {
      const double over = section.at("weight").get<double>() / (section.at("rate").get<double>() - 2);
      gain += parallel.at("output") == "state" ? over : -2 * over;
    }
    const double reference = std::pow(order < 0 ? 300 : 3.14159265 / 1e-3, order);
    const double most = digital.at("most_amplification_beyond_band");
    EXPECT_LE(std::abs(gain), most * reference * (1 + 1e-8)) << order;
    all.insert(all.end(), {"--format", "table"});
    const std::string table = run_fracfit(approximate(all)).output;
    EXPECT_EQ(table.find(" at the upper edge\n") != std::string::npos, order < 0) << table;
  }
}

TEST(Approximate, SampleTimeInTableAndCsvAndTaps) {
  const std::vector<std::string> asked{"--order", "0.5", "--band", "0.1:300", "--poles", "6", "--sample-time", "1e-3"};
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> all = asked;
    all.insert(all.end(), more.begin(), more.end());
    return run_fracfit(approximate(all));
  };
  EXPECT_NE(with({"--format", "table"}).output.find("every 0.001 s, direct"), std::string::npos);
  EXPECT_NE(with({"--format", "csv"}).output.find("\n# parallel_rates: "), std::string::npos);
  const auto taps = with({"--discretisation", "grunwald-letnikov", "--taps", "50"});
  EXPECT_EQ(Json::parse(taps.output)["digital"]["taps"].size(), 51);
}

TEST(Approximate, CommandInTheOutputMakesItAgain) {
  const auto once = run_fracfit(approximate({"--order", "0.4", "--band", "0.1:50", "--poles", "4"}));
  const auto again = run_fracfit(
      approximate({"--order", "0.4", "--band", "0.1:50", "--poles", "4", "--method", "ladder", "--threads", "2"}));
  EXPECT_EQ(once.output, again.output);
  EXPECT_EQ(Json::parse(once.output)["command"],
            "fracfit approximate --order 0.4 --band 0.1:50 --poles 4 --method ladder");
}

TEST(Approximate, EveryMethodRuns) {
  for (const char* method :
       {"ladder", "oustaloup", "oustaloup-widened", "refined-oustaloup", "matsuda", "carlson", "cfe", "charef"}) {
    const auto json = approximated({"--order", "0.5", "--band", "0.1:10", "--poles", "4", "--method", method});
    EXPECT_EQ(json["method"], method);
    EXPECT_EQ(json["status"], "as-asked");
    EXPECT_EQ(json["poles"].size(), 4);
    EXPECT_NEAR(error_of(json) / json["max_relative_error"].get<double>(), 1, 0.02) << method;
  }
}

TEST(Approximate, PairsAreListedOnce) {
  const auto json = approximated({"--order", "0.2", "--band", "0.1:10", "--poles", "7", "--method", "carlson"});
  EXPECT_EQ(json["poles"].size() + 2 * json["pole_pairs"].size(), 7);
  EXPECT_EQ(json["parallel"]["pair_residues"].size(), json["pole_pairs"].size());
}

TEST(Approximate, CsvHasOneRowPerRoot) {
  const auto result = run_fracfit(
      approximate({"--order", "0.2", "--band", "0.1:10", "--poles", "7", "--method", "carlson", "--format", "csv"}));
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.output.find("\nroot,re_rad_s,im_rad_s,residue_re,residue_im\n"), std::string::npos);
  const auto count = [&](const std::string& part) {
    int found = 0;
    for (auto at = result.output.find(part); at != std::string::npos; at = result.output.find(part, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("\nzero,"), 7);
  EXPECT_EQ(count("\npole,"), 7);
}

TEST(Approximate, TableIsForPeople) {
  const auto result =
      run_fracfit(approximate({"--order", "1.5", "--band", "0.01:100", "--poles", "5", "--format", "table"}));
  EXPECT_EQ(result.code, 0) << result.error;
  for (const char* part : {"s^1.5 on 0.01 .. 100 rad/s, ladder", "pole, rad/s", "times s^1", "attainable limit"})
    EXPECT_NE(result.output.find(part), std::string::npos) << part << " in:\n" << result.output;
}

TEST(Approximate, ToleranceOutOfReachIsNoUsableResultButShowsTheBest) {
  const auto result = run_fracfit(approximate({"--order", "0.5", "--band", "1e-3:1e3", "--tolerance", "1e-17"}));
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.error.find("not attainable in double, best is"), std::string::npos) << result.error;
  EXPECT_EQ(Json::parse(result.output)["status"], "not-attainable");
  const auto quiet = run_fracfit(
      approximate({"--order", "0.5", "--band", "1:1e4", "--tolerance", "1e-3", "--method", "oustaloup", "--quiet"}));
  EXPECT_EQ(quiet.code, 1);
  // The sentence that says why there is no usable result is no remark that --quiet takes away.
  EXPECT_NE(quiet.error.find("not attainable by oustaloup"), std::string::npos) << quiet.error;
}

TEST(Approximate, WrongUsageIsNamed) {
  const auto expect_refusal = [](const std::vector<std::string>& more, const std::string& part) {
    const auto result = run_fracfit(approximate(more));
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.output, "");
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect_refusal({"--band", "1:2", "--poles", "3"}, "--order is required");
  expect_refusal({"--order", "0.5", "--poles", "3"}, "--band is required");
  expect_refusal({"--order", "half", "--band", "1:2", "--poles", "3"}, "--order 'half'");
  expect_refusal({"--order", "0.5", "--band", "1..2", "--poles", "3"}, "LOW:HIGH");
  expect_refusal({"--order", "0.5", "--band", "2:1", "--poles", "3"}, "band = 2 to 1");
  expect_refusal({"--order", "0.5", "--band", "1:nan", "--poles", "3"}, "--band 'nan'");
  expect_refusal({"--order", "0.5", "--band", "1:9"}, "either --tolerance or --poles");
  expect_refusal({"--order", "0.5", "--band", "1:9", "--poles", "3", "--tolerance", "0.1"},
                 "either --tolerance or --poles");
  expect_refusal({"--order", "0.5", "--band", "1:9", "--tolerance", "0"}, "tolerance = 0");
  expect_refusal({"--order", "0.5", "--band", "1:9", "--poles", "0"}, "--poles '0'");
  expect_refusal({"--order", "0.5", "--band", "1:9", "--poles", "99999999999"}, "allowed are 1 to 200");
  expect_refusal({"--order", "0.5", "--band", "1:9", "--poles", "3", "--method", "spline"}, "spline");
  expect_refusal({"--order", "0.5", "--band", "1:9", "--poles", "3", "--sample-time", "0"}, "--sample-time = 0 s");
  expect_refusal({"--order", "0.5", "--band", "1:9", "--poles", "3", "--sample-time", "x"}, "--sample-time 'x'");
  expect_refusal({"--order", "0.5", "--band", "1:9", "--poles", "3", "--sample-time", "1"}, "pi/(2 T) = 1.57");
  expect_refusal({"--order", "0.5", "--band", "1:9", "--poles", "3", "--sample-time", "0.1", "--discretisation", "zoh"},
                 "zoh");
}

}  // namespace
