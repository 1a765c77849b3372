// SPDX-License-Identifier: BSD-3-Clause
// What is wrong is named on standard error with the exit code of its kind; nothing crashes, hangs or is half-written.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

namespace fs = std::filesystem;

void expect_failure(const std::vector<std::string>& arguments, int code, const std::string& part) {
  std::string line;
  for (const auto& argument : arguments) line += argument + " ";
  SCOPED_TRACE(line);
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, code);
  EXPECT_TRUE(result.error.starts_with("fracfit: ") || result.error.find("\nfracfit: ") != std::string::npos)
      << result.error;
  EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  EXPECT_EQ(result.output, "");
}

struct Scene {
  std::string force = "40", clearance = "0.3", restitution = "0.6", mass1 = "1", mass2 = "1", omega = "5,10";
};

std::vector<std::string> simulate(const Scene& scene, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"simulate",      "--force",         scene.force, "--clearance", scene.clearance,
                                     "--restitution", scene.restitution, "--mass1",   scene.mass1,   "--mass2",
                                     scene.mass2,     "--omega",         scene.omega};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

constexpr const char* good_data = "omega_rad_s,re,im\n1,1,1\n2,1.4,1.4\n3,1.7,1.7\n4,2,2\n5,2.2,2.2\n6,2.4,2.4\n";

TEST(Usage, UnknownSubcommandsAndOptions) {
  expect_failure({}, 2, "no subcommand");
  expect_failure({"simulat"}, 2, "'simulat'");
  expect_failure({"simulate"}, 2, "--force is required");
  expect_failure(simulate({}, {"--frobnicate"}), 2, "--frobnicate");
  expect_failure(simulate({}, {"--format", "xml"}), 2, "xml");
  expect_failure(simulate({}, {"--threads", "-1"}), 2, "--threads");
  expect_failure(simulate({}, {"--threads", "many"}), 2, "--threads");
  expect_failure({"fit"}, 2, "DATA");
  expect_failure({"report"}, 2, "--out");
}

TEST(Usage, SlipsOfThePenAreRecognised) {
  expect_failure({"simulat"}, 2, "did you mean simulate?");
  expect_failure({"fti"}, 2, "did you mean fit?");
  expect_failure(simulate({}, {"--orbit-toleranec", "1e-8"}), 2,
                 "unknown option '--orbit-toleranec' (did you mean --orbit-tolerance?)");
  expect_failure(simulate({}, {"--protocoll=sweep-up"}), 2, "(did you mean --protocol?)");
  expect_failure(simulate({}, {"15"}), 2, "unexpected argument '15'");
  // Nothing is near.
  EXPECT_EQ(run_fracfit({"xyzzy"}).error.find("did you mean"), std::string::npos);
  EXPECT_EQ(run_fracfit(simulate({}, {"--frobnicate"})).error.find("did you mean"), std::string::npos);
}

TEST(Usage, AbsurdSizesAreRefusedBeforeMemoryRunsOut) {
  expect_failure(simulate({.omega = "1:2:1e9"}), 2, "between 2 and 10000000");
  expect_failure({"map", "--restitution", "0:1:1e4", "--omega", "1:2:1e4"}, 2, "at most 10000000");
  expect_failure({"basins", "--restitution", "0.6", "--omega", "1", "--position", "0:1:1e4", "--velocity", "0:1:1e4"},
                 2, "10000 (--position) times 10000 (--velocity)");
  expect_failure({"jump-law", "--force", "1:2:1e4", "--clearance", "1:2:1e4"}, 2, "at most 10000000");
}

TEST(Usage, NumbersOutOfRangeAreNamed) {
  for (const char* value : {"nan", "inf", "-inf", "1e999", "abc", "", "4,0", "40N"}) {
    expect_failure(simulate({.force = value}), 2, "--force");
    expect_failure(simulate({.clearance = value}), 2, "--clearance");
    expect_failure(simulate({.restitution = value}), 2, "--restitution");
    expect_failure(simulate({.mass1 = value}), 2, "--mass1");
    expect_failure(simulate({.mass2 = value}), 2, "--mass2");
  }
  expect_failure(simulate({.force = "0"}), 2, "force");
  expect_failure(simulate({.force = "-1"}), 2, "-1");
  expect_failure(simulate({.clearance = "-0.3"}), 2, "-0.3");
  expect_failure(simulate({.restitution = "-0.1"}), 2, "-0.1");
  expect_failure(simulate({.restitution = "1.1"}), 2, "1.1");
  expect_failure(simulate({.mass1 = "0"}), 2, "mass");
  expect_failure(simulate({.mass2 = "-2"}), 2, "-2");
  expect_failure(simulate({}, {"--orbit-tolerance", "0"}), 2, "tolerance");
  expect_failure(simulate({}, {"--orbit-tolerance", "nan"}), 2, "tolerance");
}

TEST(Usage, FrequencyGridsMustRiseAndBePositive) {
  expect_failure(simulate({.omega = ""}), 2, "--omega");
  expect_failure(simulate({.omega = "0,5"}), 2, "omega");
  expect_failure(simulate({.omega = "0:5:10"}), 2, "omega");
  expect_failure(simulate({.omega = "-5"}), 2, "omega");
  expect_failure(simulate({.omega = "5,4"}), 2, "omega");
  expect_failure(simulate({.omega = "5,5"}), 2, "omega");
  expect_failure(simulate({.omega = "5:35:0"}), 2, "count");
  expect_failure(simulate({.omega = "35:5:10"}), 2, "less than");
  expect_failure(simulate({.omega = "0:5:10log"}), 2, "> 0");
  expect_failure(simulate({.omega = "5:inf:10"}), 2, "finite");
}

TEST(Usage, SpellingsAreCheckedAgainstTheAllowedOnes) {
  expect_failure(simulate({}, {"--protocol", "sideways"}), 2, "sweep-up");
  expect_failure(simulate({}, {"--body", "x3"}), 2, "x1");
  expect_failure(simulate({}, {"--motion", "quantum"}), 2, "static");
  expect_failure(simulate({}, {"--motion", "static", "--protocol", "sweep-up"}), 2, "no meaning");
  expect_failure(simulate({}, {"--motion", "static", "--body", "x2"}), 2, "x1");
  expect_failure({"simulate", "--force", "1", "--clearance", "1", "--omega", "1"}, 2, "--restitution");
  expect_failure({"jump-law", "--criterion", "guess"}, 2, "two-impact-loss");
  expect_failure({"jump-law", "--force", ""}, 2, "--force");
  expect_failure({"jump-law", "--force", "10"}, 2, "force");
  expect_failure({"jump-law", "--clearance", "0.1,-1"}, 2, "clearance");
  expect_failure({"jump-law", "--restitution", "2"}, 2, "restitution");
  expect_failure({"jump-law", "--mass2", "0"}, 2, "mass");
}

class FitFailure : public ::testing::Test {
 protected:
  void expect(const std::vector<std::string>& more, int code, const std::string& part,
              const std::string& content = good_data) {
    std::vector<std::string> arguments{"fit", folder.write("data.csv", content)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_failure(arguments, code, part);
  }
  TemporaryFolder folder;
};

TEST_F(FitFailure, FormulasThatDoNotParseGetACaret) {
  const auto result = run_fracfit({"fit", folder.write("data.csv", good_data), "--model", "K/(T s^a + "});
  EXPECT_EQ(result.code, 2);
  const auto formula = result.error.find("\nK/(T s^a + ");
  ASSERT_NE(formula, std::string::npos) << result.error;
  EXPECT_NE(result.error.find("\n", formula + 1), std::string::npos);
  EXPECT_NE(result.error.find('^', result.error.find('\n', formula + 1)), std::string::npos) << result.error;
  expect({"--model", "power_law"}, 2, "presets");
  expect({"--model", ""}, 2, "--model '': the value is empty");
}

TEST_F(FitFailure, OptionsAreChecked) {
  expect({"--model", "power-law", "--component", "phases"}, 2, "imaginary");
  expect({"--model", "power-law", "--loss", "l1"}, 2, "huber");
  expect({"--model", "power-law", "--weight", "heavy"}, 2, "'heavy' is no column");
  expect({"--model", "power-law", "--seed", "-1"}, 2, "--seed");
  expect({"--model", "power-law", "--where", "im"}, 2, "--where");
  expect({"--model", "power-law", "--fix", "a"}, 2, "NAME=VALUE");
  expect({"--model", "power-law", "--fix", "a=x"}, 2, "finite number");
  expect({"--model", "power-law", "--fix", "b=1"}, 2, "b");
  expect({"--model", "power-law", "--bound", "a=1"}, 2, "LOW:HIGH");
  expect({"--model", "power-law", "--bound", "a=x:1"}, 2, "'x'");
  expect({"--model", "power-law", "--bound", "a=1:0"}, 2, "a");
  expect({"--model", "power-law", "--start", "a=nan"}, 2, "finite number");
}

TEST_F(FitFailure, RealisationsNeedTheirOwnOptionsOnly) {
  expect({"--model", "power-law", "--realisation", "ladder"}, 2, "needs --band");
  expect({"--model", "power-law", "--realisation", "magic"}, 2, "expected exact");
  expect({"--model", "power-law", "--realisation", "oustaloup"}, 2, "needs --band");
  expect({"--model", "power-law", "--realisation", "oustaloup", "--band", "1", "--poles", "3"}, 2, "LOW:HIGH");
  expect({"--model", "power-law", "--realisation", "oustaloup", "--band", "2:1", "--poles", "3"}, 2, "band");
  expect({"--model", "power-law", "--realisation", "oustaloup", "--band", "1:2", "--poles", "0"}, 2, "--poles");
  expect({"--model", "power-law", "--realisation", "oustaloup", "--band", "1:2", "--poles", "99999999999"}, 2,
         "--poles");
  expect({"--model", "power-law", "--realisation", "grunwald-letnikov"}, 2, "needs --sample-time");
  expect({"--model", "power-law", "--realisation", "grunwald-letnikov", "--sample-time", "0"}, 2, "sample");
  // The highest frequency, 6 rad/s, lies above pi/T.
  expect({"--model", "power-law", "--realisation", "grunwald-letnikov", "--sample-time", "1"}, 2, "omega");
  expect({"--model", "power-law", "--band", "1:2"}, 2, "no meaning");
}

TEST_F(FitFailure, BadFilesAreNamedWithPlace) {
  const std::vector<std::string> model{"--model", "power-law"};
  expect(model, 3, "data.csv: is empty", "");
  expect(model, 3, "data.csv:1: found a header row but no data rows", "f_Hz,re,im\n");
  expect(model, 3, "data.csv:2:3: found 'abc'", "f_Hz,re,im\n1,abc,3\n");
  expect(model, 3, "data.csv:3:5: found 'nan'", "f_Hz,re,im\n1,2,3\n2,1,nan\n");
  expect(model, 3, "data.csv:1:1: no frequency column", "a,b,c\n1,2,3\n");
  expect(model, 3, "data.csv:1:1: column 'f_rpm': unknown unit 'rpm'", "f_rpm,re,im\n1,2,3\n");
  expect(model, 3, "data.csv:2:4: found 2 fields", "f_Hz,re,im\n1,2\n");
  expect({"--model", "power-law", "--where", "re>10"}, 3, "none of the 6 points");
  expect({"--model", "power-law", "--weight", "given"}, 3, "no column sigma or weight");
  expect_failure({"fit", folder.path("absent.csv"), "--model", "power-law"}, 3, "absent.csv: cannot be read");
  expect_failure({"fit", folder.path(), "--model", "power-law"}, 3, "is a folder");
  expect_failure({"identify", folder.path("absent.csv")}, 3, "absent.csv: cannot be read");
}

TEST_F(FitFailure, TooFewPointsAreSaidSo) {
  expect({"--model", "K/(T s^a + 1)"}, 2, "2 residuals cannot determine 3 free parameters", "f_Hz,re,im\n1,2,3\n");
}

TEST_F(FitFailure, StaticBacklashNeedsBothNumbers) {
  const auto data = folder.write("data.csv", good_data);
  expect_failure({"identify", data, "--force", "40"}, 2, "--clearance");
  expect_failure({"identify", folder.write("point.csv", "omega_rad_s,re,im\n1,1,1\n"), "--models", "zarc"}, 1,
                 "no candidate could be fitted");
  expect_failure({"identify", data, "--clearance", "0.3"}, 2, "--force");
  // The header that `response` writes has the force alone, which nobody asks for.
  const auto of_response = folder.write("response.csv", std::string("# force_n: 40\n") + good_data);
  const auto ranked = run_fracfit({"identify", of_response, "--models", "power-law,lag"});
  EXPECT_EQ(ranked.code, 0) << ranked.error;
  EXPECT_EQ(ranked.output.find("static-backlash"), std::string::npos) << ranked.output;
  expect_failure({"identify", data, "--mass1", "1"}, 2, "no meaning");
  expect_failure({"identify", data, "--models", "power-law,,gain"}, 2, "entry 2 is empty");
  expect_failure({"identify", data, "--models", ""}, 2, "--models '': the value is empty");
  expect_failure({"identify", data, "--models", "power-law,nonsense"}, 2, "presets");
}

// As a variable that is not set leaves them: without a word another result would be computed.
TEST(Usage, NoOptionTakesAnEmptyValue) {
  const TemporaryFolder folder;
  const auto data = folder.write("curve.csv", good_data);
  const std::vector<std::string> loop{"loop", "--controller", "1 + s", "--restitution", "0.6", "--velocity2", "1"};
  for (const char* name : {"--load-receptance", "--setpoint-file", "--body", "--every", "--out"}) {
    auto arguments = loop;
    arguments.insert(arguments.end(), {name, ""});
    expect_failure(arguments, 2, std::string(name) + " '': the value is empty");
  }
  for (const char* name : {"--select", "--columns", "--where", "--fix", "--shard"}) {
    const char* const command = std::string(name) == "--shard" ? "batch" : "fit";
    expect_failure({command, data, "--model", "gain", name, ""}, 2, std::string(name) + " '': the value is empty");
  }
  expect_failure({"convert", ""}, 2, "the value is empty");
}

TEST(Usage, NoOptionIsTakenForAValue) {
  const TemporaryFolder folder;
  const auto data = folder.write("curve.csv", good_data);
  for (const char* next : {"--fix", "--quiet", "--component"}) {
    expect_failure({"fit", data, "--model", "gain", "--out", next}, 2,
                   std::string("--out lacks its value: ") + next + " is an option");
    EXPECT_FALSE(fs::exists(next));
  }
}

TEST(Usage, InputsWithoutEndAreRefused) {
  if (!fs::exists("/dev/zero")) GTEST_SKIP() << "no /dev/zero here";
  expect_failure({"fit", "/dev/zero", "--model", "gain"}, 3, "/dev/zero: is a device that does not end");
  expect_failure({"evaluate", "--fit", "/dev/zero", "--omega", "1"}, 3, "/dev/zero: is a device that does not end");
}

// A name of a file may hold what commands the terminal.
TEST(Usage, ControlCharactersOfNamesDoNotReachTheTerminal) {
  const auto result = run_fracfit({"convert", "\x1b[2Jname"});
  EXPECT_EQ(result.code, 3);
  EXPECT_EQ(result.error, "fracfit: ?[2Jname: cannot be read: No such file or directory\n");
}

TEST(Output, UnwritableFilesAreRefusedAndNothingIsLeft) {
  const TemporaryFolder folder;
  expect_failure(simulate({}, {"--out", folder.path("absent/curve.csv")}), 2, "absent/curve.csv cannot be written");
  expect_failure(simulate({}, {"--out", folder.path()}), 2, "is a folder");
  expect_failure(simulate({.force = "-1"}, {"--out", folder.path("curve.csv")}), 2, "-1");
  expect_failure({"fit", folder.path("absent.csv"), "--model", "K s", "--out", folder.path("fit.json")}, 3,
                 "absent.csv");
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(Output, AFullDiskIsNoResult) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  expect_failure(simulate({}, {"--out", "/dev/full"}), 1, "No space left");
}

TEST(Output, AnEarlierResultSurvivesAFailedRun) {
  const TemporaryFolder folder;
  const auto path = folder.write("curve.csv", "earlier");
  expect_failure(simulate({.restitution = "7"}, {"--out", path}), 2, "7");
  EXPECT_EQ(content_of(path), "earlier");
}

TEST(Report, UnwritableFoldersAndBadFilesAreRefused) {
  const TemporaryFolder folder;
  folder.write("file", "");
  expect_failure({"report", "--out", folder.path("file/report")}, 2, "file");
  expect_failure({"report", folder.path("absent.csv"), "--out", folder.path("report")}, 3, "absent.csv");
  expect_failure({"report", "--scene", folder.path("absent.json"), "--out", folder.path("report")}, 3, "absent.json");
  expect_failure({"report", folder.path("a"), "--scene", folder.path("b"), "--out", folder.path("report")}, 2,
                 "--scene");
  EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace
