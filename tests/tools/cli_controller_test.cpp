// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;
using Complex = std::complex<double>;

const std::vector<std::string> pid{"controller", "--kp", "2",   "--ki",          "3",    "--kd",   "0.05",   "--lambda",
                                   "0.8",        "--mu", "0.6", "--sample-time", "1e-3", "--band", "0.1:300"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

Json json_of(const std::vector<std::string>& arguments) {
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, 0) << result.error;
  return Json::parse(result.output);
}

Complex sections_response(const Json& part, const Json& sections, Complex delta) {
  Complex value = part["direct"].get<double>();
  for (const Json& section : sections)
    value += section["weight"].get<double>() * (part["output"] == "state" ? 1.0 : delta) /
             (delta + section["rate"].get<double>());
  Complex taps = 0, past = 1;
  for (const Json& tap : part["taps"]) {
    taps += tap.get<double>() * past;
    past /= 1.0 + delta;
  }
  return taps * value;
}

TEST(Controller, SectionsOfTheJsonMakeTheController) {
  const Json json = json_of(with(pid, {"--tolerance", "1e-4", "--swing", "1"}));
  EXPECT_EQ(json["kind"], "fractional-pid");
  EXPECT_EQ(json["note"].get<std::string>().find("above the tolerance"), std::string::npos) << json["note"];
  EXPECT_LE(json["integral"]["max_relative_error"].get<double>(), 1e-4);
  for (const double omega : {0.1, 1.0, 10.0, 50.0}) {
    const Complex s(0, omega);
    const Complex delta = std::polar(1.0, omega * 1e-3) - 1.0;
    const Complex value =
        2.0 +
        3.0 * sections_response(json["integral"], json["sections"]["integral"], delta) * 1e-3 * (0.5 + 1.0 / delta) +
        0.05 * sections_response(json["derivative"], json["sections"]["derivative"], delta);
    const Complex exact = 2.0 + 3.0 * std::pow(s, -0.8) + 0.05 * std::pow(s, 0.6);
    // Filters within 1e-4, the trapezoidal rule (omega T)^2/12 = 2e-4 at 50 rad/s.
    EXPECT_LT(std::abs(value / exact - 1.0), 3e-4) << omega;
  }
}

TEST(Controller, CommandInTheOutputMakesItAgain) {
  const Json json = json_of(with(pid, {"--poles", "5", "--min", "-1", "--max", "2"}));
  EXPECT_GE(json["sections"]["integral"].size(), 5);
  EXPECT_EQ(json["minimum"], -1);
  const std::string command = json["command"];
  std::vector<std::string> words;
  std::string word;
  for (const char c : command + " ") {
    if (c != ' ') {
      word += c;
    } else {
      words.push_back(word);
      word.clear();
    }
  }
  words.erase(words.begin());
  EXPECT_EQ(json_of(words), json);
}

TEST(Controller, CCodeCompilesByItselfAndRuns) {
  if (std::system("cc --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no C compiler";
  for (const char* precision : {"double", "float"}) {
    const TemporaryFolder folder;
    const std::string header = folder.path("pid.h");
    const auto result = run_fracfit(
        with(pid, {"--max", "2.5", "--min", "-2.5", "--name", "pid", "--precision", precision, "--out", header}));
    ASSERT_EQ(result.code, 0) << result.error;
    EXPECT_NE(content_of(header).find("fracfit controller --kp 2 --ki 3"), std::string::npos);
    folder.write(
        "main.c",
        "#include <stdio.h>\n#include \"pid.h\"\nint main(void)\n{\n  pid_state pid;\n  int n;\n  double y = 0;\n"
        "  pid_init(&pid);\n  for (n = 0; n < 200000; ++n) y += 1e-3 * ((double)pid_step(&pid, 1, (" +
            std::string(precision) +
            ")y) - y);\n  printf(\"%.3f\\n\", y);\n  pid_track(&pid, 1);\n  "
            "pid_reset(&pid);\n  return 0;\n}\n");
    const std::string run = folder.path("run");
    const std::string compile = "cc -std=c99 -Wall -Wextra -Werror -pedantic -o " + run + " " + folder.path("main.c") +
                                " && " + run + " >" + folder.path("printed");
    ASSERT_EQ(std::system(compile.c_str()), 0);
    // The integral brings the plant 1/(s + 1) to the set-point.
    EXPECT_EQ(content_of(folder.path("printed")), "1.000\n");
  }
}

TEST(Controller, TwoControllersOfOneNameDoNotCompileTogether) {
  if (std::system("cc --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no C compiler";
  const TemporaryFolder folder;
  for (const auto& [file, gain, name] :
       {std::tuple{"a.h", "2", "controller"}, {"b.h", "3", "controller"}, {"c.h", "3", "other"}})
    ASSERT_EQ(
        run_fracfit({"controller", "--kp", gain, "--sample-time", "1", "--name", name, "--out", folder.path(file)})
            .code,
        0);
  const auto compiles = [&](const std::string& first, const std::string& second) {
    folder.write("main.c", "#include \"" + first + "\"\n#include \"" + second + "\"\nint main(void) { return 0; }\n");
    const std::string compile = "cc -std=c99 -Wall -Wextra -Werror -pedantic -o " + folder.path("run") + " " +
                                folder.path("main.c") + " 2>" + folder.path("said");
    return std::system(compile.c_str()) == 0;
  };
  EXPECT_TRUE(compiles("a.h", "a.h")) << content_of(folder.path("said"));
  EXPECT_TRUE(compiles("a.h", "c.h")) << content_of(folder.path("said"));
  EXPECT_FALSE(compiles("a.h", "b.h"));
  EXPECT_NE(content_of(folder.path("said")).find("another controller with the name 'controller' is already included"),
            std::string::npos)
      << content_of(folder.path("said"));
}

TEST(Controller, ModelsBecomeFilters) {
  const Json plant = json_of({"controller", "--model", "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", "--sample-time", "0.01"});
  EXPECT_EQ(plant["kind"], "filter");
  // The poles of the principal sheet, to the fifteen digits known of them; others may stand in for a part of the cut.
  const Complex expected = 1.0 - std::exp(Complex(-0.10841680291289, -1.19699224474627) * 0.01);
  const auto& pairs = plant["pairs"];
  EXPECT_TRUE(std::any_of(pairs.begin(), pairs.end(), [&](const Json& pair) {
    const Complex rate(pair["rate"][0], std::abs(pair["rate"][1].get<double>()));
    return std::abs(rate - expected) < 1e-14;
  })) << pairs;
  const Json brief = json_of({"controller", "--model", "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", "--sample-time", "0.01",
                              "--tolerance", "1e-4", "--sample-count", "1e4"});
  EXPECT_LT(brief["sections"].size(), plant["sections"].size() / 2);
  const Json power = json_of({"controller", "--model", "2 s^0.5", "--sample-time", "1e-3", "--band", "0.1:300"});
  const Complex delta = std::polar(1.0, 0.01) - 1.0;
  EXPECT_LT(std::abs(sections_response(power, power["sections"], delta) / (2.0 * std::pow(Complex(0, 10), 0.5)) - 1.0),
            1e-3);
  const auto c = run_fracfit({"controller", "--model", "1/(s^0.5 + 1)", "--sample-time", "0.01", "--format", "c"});
  EXPECT_EQ(c.code, 0) << c.error;
  EXPECT_NE(c.output.find("static inline double filter_step(filter_state *s, double sample)"), std::string::npos);
}

TEST(Controller, BandOfAModelSavesStates) {
  const std::vector<std::string> furnace{
      "controller", "--model", "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", "--sample-time", "0.01", "--tolerance", "1e-4"};
  const Json all = json_of(furnace);
  const Json on_band = json_of(with(furnace, {"--band", "0.01:100"}));
  EXPECT_LT(3 * on_band["states"].get<int>(), all["states"].get<int>());
  EXPECT_LE(on_band["max_relative_error"].get<double>(), 1e-4);
  // An integrator leaves no filter for a band alone; the other one is written and the reason said.
  const auto integrating =
      run_fracfit({"controller", "--model", "1/(s^1.5 + s)", "--sample-time", "0.01", "--band", "0.01:100"});
  EXPECT_EQ(integrating.code, 0) << integrating.error;
  EXPECT_NE(integrating.error.find("A filter for all frequencies is written"), std::string::npos) << integrating.error;
  EXPECT_EQ(Json::parse(integrating.output)["integrators"], 1);
}

TEST(Controller, TableIsForPeopleAndNotesAreSaid) {
  const auto table = run_fracfit(with(pid, {"--format", "table"}));
  EXPECT_EQ(table.code, 0) << table.error;
  for (const char* part : {"2 + 3/s^0.8 + 0.05 s^0.6, every 0.001 s", "anti-windup back-calculation"})
    EXPECT_NE(table.output.find(part), std::string::npos) << part << " in:\n" << table.output;
  const auto cut =
      run_fracfit({"controller", "--ki", "3", "--lambda", "0.5", "--sample-time", "0.1", "--band", "0.1:1e4"});
  EXPECT_EQ(cut.code, 0);
  EXPECT_NE(cut.error.find("cut from 1e+04 to 15.7 rad/s"), std::string::npos) << cut.error;
}

// The backward rule of a lag errs by omega T/2 = 0.15 of its phase at 300 rad/s, far above the tolerance that the
// filters keep; without one the whole controller keeps it.
TEST(Controller, SaysWhereARuleMissesTheTolerance) {
  const auto missed = run_fracfit(with(pid, {"--derivative-filter", "0.01", "--format", "c"}));
  EXPECT_EQ(missed.code, 0);
  EXPECT_NE(missed.error.find("whole controller is off by 0.0267 at 300 rad/s"), std::string::npos) << missed.error;
  EXPECT_NE(missed.output.find("whole controller within 0.0267"), std::string::npos);
  const auto kept = run_fracfit(with(pid, {"--format", "c"}));
  EXPECT_EQ(kept.error.find("whole controller is off"), std::string::npos) << kept.error;
}

TEST(Controller, WrongUsageIsNamed) {
  const auto expect_refusal = [](const std::vector<std::string>& arguments, const std::string& part) {
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.output, "");
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect_refusal({"controller", "--kp", "1"}, "--sample-time is required");
  expect_refusal({"controller", "--sample-time", "1"}, "at least one of --kp");
  expect_refusal({"controller", "--ki", "1", "--lambda", "0.5", "--sample-time", "1"}, "--band is required");
  expect_refusal(with(pid, {"--tolerance", "1e-3", "--poles", "4"}), "not both");
  expect_refusal(with(pid, {"--max", "x"}), "--max 'x'");
  expect_refusal(with(pid, {"--max", "-1", "--min", "1"}), "limits = 1 to -1");
  expect_refusal(with(pid, {"--anti-windup", "clamp"}), "--anti-windup: 'clamp' is not allowed; expected none");
  expect_refusal(with(pid, {"--precision", "half", "--format", "c"}), "--precision: 'half' is not allowed");
  expect_refusal(with(pid, {"--name", "9", "--format", "c"}), "C name \"9\"");
  expect_refusal(with(pid, {"--name", "a b"}), "C name \"a b\"");
  expect_refusal({"controller", "--model", "1/(s + 1)", "--sample-time", "1", "--name", "1x"}, "C name \"1x\"");
  for (const char* format : {"json", "c"}) {
    // The root of s^0.5 = 1, and of s^2 - s + 1 = 0.
    expect_refusal({"controller", "--model", "1/(s^0.5 - 1)", "--sample-time", "0.01", "--format", format},
                   "the model is unstable, with a pole at 1 rad/s");
    expect_refusal({"controller", "--model", "1/(s^2 - s + 1)", "--sample-time", "0.01", "--format", format},
                   "the model is unstable, with poles at 0.5 +- 0.866");
  }
  expect_refusal(with(pid, {"--model", "1/s"}), "--kp has no meaning with --model");
  expect_refusal({"controller", "--kp", "1", "--lambda", "2", "--sample-time", "1"}, "lambda = 2");
  expect_refusal({"controller", "--ki", "1", "--lambda", "0.5", "--sample-time", "1", "--band", "5:9"},
                 "begins where sample time 1 s ends");
  for (const std::string option : {"--min", "--lambda", "--anti-windup", "--swing"})
    expect_refusal({"controller", "--model", "1/(s + 1)", "--sample-time", "1", option,
                    option == "--anti-windup" ? "none" : "0.5"},
                   option + " has no meaning with --model");
  expect_refusal(with(pid, {"--sample-count", "1e5"}), "--sample-count has no meaning without --model");
  expect_refusal({"controller", "--model", "s^0.5", "--sample-time", "1"}, "--band is required for a power");
  expect_refusal({"controller", "--model", "s + 1", "--sample-time", "1"}, "proper");
  expect_refusal({"controller", "--model", "s^0.5 + 1", "--sample-time", "1", "--band", "0.01:1"}, "grows as s^0.5");
  expect_refusal(
      {"controller", "--model", "1/(s^0.5 + 1)", "--sample-time", "1", "--band", "1:2", "--discretisation", "tustin"},
      "--discretisation belongs to a PID or to a power of s");
  expect_refusal({"controller", "--model", "1/(s^0.5 + 1)^0.3", "--sample-time", "1"},
                 "\"1/(s^0.5 + 1)^0.3\" is no ratio of sums of powers of s");
}

}  // namespace
