// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::json;

struct Table {
  std::string head;
  std::vector<double> time, output;
};

Table response_to(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "respond");
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, 0) << result.error;
  Table table;
  std::istringstream lines(result.output);
  std::string line;
  while (std::getline(lines, line) && line != "time_s,output") table.head += line + "\n";
  while (std::getline(lines, line)) {
    std::size_t comma = 0;
    table.time.push_back(std::stod(line, &comma));
    table.output.push_back(std::stod(line.substr(comma + 1)));
  }
  return table;
}

void expect_failure(const std::vector<std::string>& arguments, int code, const std::string& part) {
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, code) << part;
  EXPECT_EQ(result.output, "");
  EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
}

const std::string furnace = "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)";

}  // namespace

TEST(Respond, MethodsAgreeWithTheKnownValues) {
  const Table exact = response_to({"--model", furnace, "--time", "1,5,20,30"});
  const double known[] = {0.423976252450147, 0.585082992742685, 0.991079096205464, 1.014164778110849};
  ASSERT_EQ(exact.output.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(exact.output[i], known[i], 2e-15);
  EXPECT_NE(exact.head.find("# method: reference\n"), std::string::npos) << exact.head;
  EXPECT_NE(exact.head.find("# fracfit: "), std::string::npos);
  EXPECT_NE(exact.head.find("# error_estimate: "), std::string::npos);

  const Table fast = response_to({"--model", furnace, "--time", "0:30:3001", "--tolerance", "1e-10"});
  EXPECT_NE(fast.head.find("# method: exponential-sum\n"), std::string::npos) << fast.head;
  ASSERT_EQ(fast.output.size(), 3001u);
  EXPECT_EQ(fast.output[0], 0);
  // The largest value is about 1.7.
  EXPECT_NEAR(fast.output[100], known[0], 2e-10);
  EXPECT_NEAR(fast.output[2000], known[2], 2e-10);
  // First order in the step of 0.01 s.
  const Table slow = response_to({"--model", furnace, "--time", "0:30:3001", "--method", "grunwald-letnikov"});
  EXPECT_NEAR(slow.output[2000], known[2], 0.02);
  EXPECT_NE(slow.output[2000], fast.output[2000]);
}

TEST(Respond, EveryMethodGivesTheSameAndSaysItsError) {
  for (const char* method : {"auto", "reference", "exponential-sum", "grunwald-letnikov", "bdf2", "ladder"}) {
    const Table table = response_to({"--model", furnace, "--time", "0:30:3001", "--method", method, "--quiet"});
    const std::string name = std::string(method) == "auto" ? "exponential-sum" : method;
    EXPECT_NE(table.head.find("# method: " + name + "\n"), std::string::npos) << table.head;
    const std::size_t at = table.head.find("# error_estimate: ");
    ASSERT_NE(at, std::string::npos);
    const double estimate = std::stod(table.head.substr(at + 18));
    // The estimate is the largest of some twenty differences; between them the error may be somewhat larger.
    EXPECT_LE(std::abs(table.output[2000] - 0.991079096205464), 3 * estimate + 1e-15) << method;
    EXPECT_LT(estimate, 0.05) << method;
  }
}

TEST(Respond, UnevenInstantsAndSamples) {
  const TemporaryFolder folder;
  const auto file = folder.write("steps.csv", "time_s,input\n0,1\n0.5,3\n1.7,-1\n");
  const Table table = response_to({"--model", "exp(-0.1 s)/(s+1)", "--input", file, "--time", "0.2,0.65,3"});
  const auto lag = [](double t) { return t > 0 ? -std::expm1(-t) : 0; };
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = table.time[i] - 0.1;
    EXPECT_NEAR(table.output[i], lag(t) + 2 * lag(t - 0.5) - 4 * lag(t - 1.7), 1e-9);
  }
  const Table same = response_to({"--model", "1/(s+1)", "--input", file});
  ASSERT_EQ(same.time.size(), 3u);
  EXPECT_NEAR(same.output[2], lag(1.7) + 2 * lag(1.2), 1e-9);
}

TEST(Respond, OtherInputs) {
  // 1/(s + 1): e^-t, t - 1 + e^-t, (e^-t - cos t + sin t)/2.
  const double e = std::exp(-2.0);
  EXPECT_NEAR(response_to({"--model", "1/(s+1)", "--input", "impulse", "--time", "2"}).output[0], e, 1e-14);
  EXPECT_NEAR(response_to({"--model", "1/(s+1)", "--input", "ramp", "--time", "2"}).output[0], 1 + e, 1e-14);
  EXPECT_NEAR(response_to({"--model", "1/(s+1)", "--input", "sine", "--omega", "1", "--time", "2"}).output[0],
              (e - std::cos(2.0) + std::sin(2.0)) / 2, 1e-14);
}

TEST(Respond, FilesOfSamples) {
  const TemporaryFolder folder;
  std::string text = "time_s,input\n";
  for (int n = 0; n <= 400; ++n) text += std::to_string(0.01 * n) + "," + std::to_string(0.03 * n) + "\n";
  const Table table =
      response_to({"--model", "1/(s+1)", "--input", folder.write("ramp.csv", text), "--hold", "first-order"});
  ASSERT_EQ(table.output.size(), 401u);
  for (const std::size_t n : {0u, 1u, 100u, 400u}) {
    const double t = 0.01 * static_cast<double>(n);
    // Six decimals in the file.
    EXPECT_NEAR(table.output[n], 3 * (t + std::expm1(-t)), 1e-6);
  }
}

TEST(Respond, AnInfiniteValueAtTheStartLeavesTheOtherRows) {
  // The impulse response of 1/(s^0.5 + 1) is E_{1/2,1/2}(-t^0.5)/t^0.5 = 1/sqrt(pi t) - e^t erfc(sqrt t).
  const auto some = run_fracfit({"respond", "--model", "1/(s^0.5+1)", "--input", "impulse", "--time", "0,1"});
  EXPECT_EQ(some.code, 0) << some.error;
  EXPECT_NE(some.output.find("\n0,inf\n1,"), std::string::npos) << some.output;
  EXPECT_NE(some.error.find("the output at 0 s is infinite: the impulse response begins as t^-0.5"), std::string::npos)
      << some.error;
  const double value = std::stod(some.output.substr(some.output.rfind(',') + 1));
  EXPECT_NEAR(value, 1 / std::sqrt(std::acos(-1.0)) - std::exp(1.0) * std::erfc(1.0), 1e-14);
  const auto only = run_fracfit({"respond", "--model", "1/(s^0.5+1)", "--input", "impulse", "--time", "0"});
  EXPECT_EQ(only.code, 1) << only.error;
  EXPECT_NE(only.error.find("no value is finite"), std::string::npos) << only.error;
}

TEST(Respond, WhatIsWrongIsNamed) {
  const TemporaryFolder folder;
  expect_failure({"respond", "--time", "1"}, 2, "--model");
  expect_failure({"respond", "--model", "1/(s+1)"}, 2, "--time");
  expect_failure({"respond", "--model", "1/(s+", "--time", "1"}, 2, "1/(s+");
  expect_failure({"respond", "--model", "1/(s+1)", "--time", "-1,2"}, 2, "time[0] = -1");
  expect_failure({"respond", "--model", "1/(s+1)", "--input", "sine", "--time", "1"}, 2, "--omega");
  expect_failure({"respond", "--model", "1/(s+1)", "--time", "1,2,4", "--method", "bdf2"}, 2, "0, T, 2 T");
  expect_failure({"respond", "--model", "1/(s+1)", "--time", "1", "--method", "best"}, 2, "expected auto, reference");
  expect_failure({"respond", "--model", "1/(s+1)", "--time", "1", "--tolerance", "0.5"}, 2, "tolerance = 0.5");
  expect_failure({"respond", "--model", "1/(s+1)", "--input", folder.path("none.csv")}, 3, "none.csv");
  const auto backwards = folder.write("backwards.csv", "time_s,input\n0,1\n1,1\n0.5,1\n");
  expect_failure({"respond", "--model", "1/(s+1)", "--input", backwards}, 3, "a time after 1");
  const auto broken = folder.write("broken.csv", "time_s,input\n0,1\n1,nan\n");
  expect_failure({"respond", "--model", "1/(s+1)", "--input", broken}, 3, "broken.csv:3:3");
  const auto unnamed = folder.write("unnamed.csv", "time_s,x\n0,1\n1,1\n");
  expect_failure({"respond", "--model", "1/(s+1)", "--input", unnamed}, 3, "expected input or u");
}

TEST(Analyse, ReportsTheFurnace) {
  const auto result = run_fracfit({"analyse", "--model", furnace});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  EXPECT_EQ(json["stability"], "stable");
  ASSERT_EQ(json["poles"].size(), 1u);
  EXPECT_NEAR(json["poles"][0]["re"].get<double>(), -0.10841680291289, 1e-13);
  EXPECT_NEAR(json["h2_norm"].get<double>(), 1.5345842681944, 2e-13);
  EXPECT_NEAR(json["h_infinity_norm"]["gain"].get<double>(), 4.6208373031928, 1e-13);
  EXPECT_NEAR(json["commensurate_order"].get<double>(), 0.1, 1e-15);
  EXPECT_EQ(json["sheet_roots"].size(), 11u);
  const auto table = run_fracfit({"analyse", "--model", furnace, "--format", "table"});
  EXPECT_NE(table.output.find("stability: stable"), std::string::npos) << table.output;
}

TEST(Analyse, ReportsALoop) {
  // e^-s/s: phase -pi at pi/2, gain 2/pi there; |L| = 1 at 1.
  const auto result = run_fracfit({"analyse", "--model", "exp(-1 s)/s"});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  EXPECT_EQ(json["stability"], "integrating");
  EXPECT_EQ(json["unity_feedback"]["stability"], "stable");
  EXPECT_NEAR(json["margins"]["gain_margin"].get<double>(), std::acos(-1.0) / 2, 1e-12);
  EXPECT_NEAR(json["margins"]["phase_margin_rad"].get<double>(), std::acos(-1.0) / 2 - 1, 1e-12);
  EXPECT_TRUE(json["h2_norm"].is_null());
}

TEST(Analyse, ReportsALoopOfAnUnstablePlant) {
  // K/(s - 1): closed loop K/(s - 1 + K).
  const auto closed_loop = [](const char* loop) {
    const auto result = run_fracfit({"analyse", "--model", loop});
    EXPECT_EQ(result.code, 0) << result.error;
    return Json::parse(result.output)["unity_feedback"]["stability"].get<std::string>();
  };
  EXPECT_EQ(closed_loop("1/(s - 1)"), "marginal");
  EXPECT_EQ(closed_loop("0.9999/(s - 1)"), "unstable");
  EXPECT_EQ(closed_loop("1.0001/(s - 1)"), "stable");
  const auto table = run_fracfit({"analyse", "--model", "2/(s - 1)", "--format", "table"}).output;
  EXPECT_NE(table.find("gain margin: factor inf up, 0.5 down"), std::string::npos) << table;
  EXPECT_EQ(table.find("unstable loop"), std::string::npos) << table;
  const auto unstable = run_fracfit({"analyse", "--model", "0.5/(s - 1)", "--format", "table"}).output;
  EXPECT_NE(unstable.find("those of an unstable loop"), std::string::npos) << unstable;
  EXPECT_NE(unstable.find("gain margin: factor 2 up, 0 down"), std::string::npos) << unstable;
  // L(0) = -1/4, L(inf) = -1/2, where JSON has no number for omega.
  const auto biproper = run_fracfit({"analyse", "--model", "-0.5 (s + 1)/(s + 2)"});
  const Json margins = Json::parse(biproper.output)["margins"];
  EXPECT_EQ(margins["gain_margin"], 2.0);
  ASSERT_EQ(margins["phase_crossovers"].size(), 2u);
  EXPECT_EQ(margins["phase_crossovers"][0]["omega"], 0.0);
  EXPECT_TRUE(margins["phase_crossovers"][1]["omega"].is_null());
}

// K e^{-s T}/s crosses 1 at K with the phase -pi/2 - K T; beyond K T = pi/2 the loop is unstable.
TEST(Analyse, SignsThePhaseMarginOfAnUnstableLoop) {
  for (const double gain : {2.0, 4.0}) {
    const std::string loop = std::to_string(gain) + "*exp(-0.5 s)/s";
    const Json margins = Json::parse(run_fracfit({"analyse", "--model", loop}).output).at("margins");
    EXPECT_NEAR(margins.at("phase_margin_rad"), std::numbers::pi / 2 - gain * 0.5, 1e-12) << loop;
    EXPECT_EQ(margins.at("phase_margin_rad"), margins.at("gain_crossovers")[0].at("phase_margin_rad")) << loop;
  }
  EXPECT_NE(run_fracfit({"analyse", "--model", "4*exp(-0.5 s)/s", "--format", "table"}).output.find("margin: -24.5"),
            std::string::npos);
}

TEST(Analyse, TellsSingleFromDoubleIntegrators) {
  for (const int order : {1, 2}) {
    const std::string model = "6/(s^" + std::to_string(order) + " (s + 3))";
    const Json origin = Json::parse(run_fracfit({"analyse", "--model", model}).output).at("towards_origin");
    EXPECT_DOUBLE_EQ(origin.at("gain"), 2);
    EXPECT_DOUBLE_EQ(origin.at("order"), -order);
    const std::string table = run_fracfit({"analyse", "--model", model, "--format", "table"}).output;
    EXPECT_NE(table.find("towards the origin it grows as 2 s^-" + std::to_string(order)), std::string::npos) << table;
  }
}

TEST(Analyse, ReportsASlowlyFallingLoopWithDeadTime) {
  const auto result = run_fracfit({"analyse", "--model", "exp(-s)/(s^0.2+1)"});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json margins = Json::parse(result.output)["margins"];
  // omega + arg(1 + (j omega)^0.2) = pi.
  const double pi = std::acos(-1.0);
  const auto lag = [&](double omega) { return 1.0 + std::polar(std::pow(omega, 0.2), 0.1 * pi); };
  double omega = 3;
  for (int i = 0; i < 60; ++i) omega = pi - std::arg(lag(omega));
  EXPECT_NEAR(margins["gain_margin"].get<double>(), std::abs(lag(omega)), 1e-12);
  EXPECT_TRUE(margins["phase_margin_rad"].is_null());
  EXPECT_TRUE(margins["gain_crossovers"].empty());
  EXPECT_NE(margins["remark"].get<std::string>().find("listed up to"), std::string::npos) << margins["remark"];
}

TEST(Analyse, ClosesALoop) {
  // K/s^1.5 under unity feedback: K/(s^1.5 + K), poles at K^(2/3) e^(+-120 deg i).
  const auto result = run_fracfit({"analyse", "--model", "8/s^1.5", "--feedback", "1"});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  EXPECT_EQ(json["model"], "8/(s^1.5 + 8)");
  EXPECT_NEAR(json["poles"][0]["re"].get<double>(), -2, 1e-13);
  // Margins are those of the loop: 8/s^1.5 has size 1 at 4 rad/s and an angle of -135 deg everywhere.
  EXPECT_NEAR(json["margins"]["phase_margin_rad"].get<double>(), std::numbers::pi / 4, 1e-9);
  EXPECT_NEAR(json["margins"]["gain_crossovers"][0]["omega"].get<double>(), 4, 1e-9);
  expect_failure({"analyse", "--model", "exp(-1 s)/s", "--feedback", "1"}, 2, "dead time of 1 s");
}

// gain (t - L), less gain^2 (t - 2 L)^2/2 and so on, of gain/s with the dead time L.
TEST(Respond, OfALoopWithDeadTimeIsItsPolynomials) {
  const Table closed = response_to({"--model", "exp(-2 s)*0.5/s", "--feedback", "1", "--time", "1,3,5,7"});
  const double exact[] = {0, 0.5, 1.5 - 1 / 8.0, 2.5 - 9 / 8.0 + 1 / 48.0};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(closed.output[i], exact[i], 1.5e-9);
  EXPECT_NE(closed.head.find("# feedback: 1\n# closed_loop: stable\n# method: closed-loop\n"), std::string::npos)
      << closed.head;
  // A disturbance in front of the plant 1/s: the same over the controller's gain.
  const Table load = response_to({"--model", "exp(-2 s)/s", "--feedback", "0.5", "--time", "1,3,5,7"});
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(load.output[i], 2 * exact[i], 3e-9);
  // gain L = 2 is beyond pi/2.
  const auto unstable = run_fracfit({"respond", "--model", "exp(-2 s)/s", "--feedback", "1", "--time", "1,3"});
  EXPECT_NE(unstable.output.find("# closed_loop: unstable\n"), std::string::npos) << unstable.output;
  // Without dead time the closed loop is a model like any other: 1 - e^-t.
  const Table plain = response_to({"--model", "1/s", "--feedback", "1", "--time", "1"});
  EXPECT_NEAR(plain.output[0], 1 - std::exp(-1.0), 1e-14);
}

TEST(Respond, OfALoopWithDeadTimeRefusesWhatHasNoMeaning) {
  expect_failure({"respond", "--model", "exp(-2 s)/s", "--feedback", "1", "--time", "1", "--method", "bdf2"}, 2,
                 "--method bdf2 has no meaning with --feedback");
  expect_failure({"respond", "--model", "exp(-2 s)*s", "--feedback", "1", "--time", "1"}, 2, "grows as omega^1");
}

TEST(Analyse, AFolderThatCannotBeMadeIsFoundOutFirst) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "x");
  for (const auto& path : {file, file + "/below"})
    expect_failure({"analyse", "--model", furnace, "--pictures", path}, 2,
                   "--pictures " + path + ": cannot be made a folder: ");
}

// The scripts are written whether gnuplot is there or not.
TEST(Analyse, DrawsItsDiagrams) {
  const TemporaryFolder folder;
  const auto result = run_fracfit(
      {"analyse", "--model", "exp(-0.2 s)/(s (s^0.7 + 1))", "--pictures", folder.path("pictures"), "--quiet"});
  for (const char* name : {"bode", "nyquist", "nichols", "step"}) {
    std::ifstream script(folder.path("pictures") + "/model-" + name + ".gp");
    EXPECT_TRUE(script.good()) << name;
    if (result.code != 0) continue;
    std::ifstream picture(folder.path("pictures") + "/model-" + name + ".png", std::ios::binary);
    char magic[4] = {};
    picture.read(magic, 4);
    EXPECT_EQ(std::string(magic + 1, 3), "PNG") << name;
  }
}
