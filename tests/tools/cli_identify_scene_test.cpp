// SPDX-License-Identifier: BSD-3-Clause
// identify-scene from the files that simulate writes.
#include <gtest/gtest.h>

#include <cctype>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;

// The two-impact band of restitution 0.6 in clearance 0.3 at mass2 = 1: 1.75 to 3.3 times sqrt(F/0.3).
std::string simulated(const TemporaryFolder& folder, const std::string& force, const std::string& omega,
                      const std::vector<std::string>& more = {}) {
  const std::string file = folder.path("f" + force + ".csv");
  std::vector<std::string> arguments{"simulate", "--force", force, "--clearance", "0.3", "--restitution",
                                     "0.6",      "--mass1", "2",   "--mass2",     "1",   "--omega",
                                     omega,      "--out",   file};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, 0) << result.error;
  return file;
}

class IdentifyScene : public ::testing::Test {
 protected:
  TemporaryFolder folder;
  std::string weak = simulated(folder, "10", "10.2:19:25log");
  std::string strong = simulated(folder, "50", "22.8:42.5:25log");
};

TEST_F(IdentifyScene, FindsTheSceneOfSimulatedFiles) {
  const auto result = run_fracfit({"identify-scene", weak, strong, "--fix", "m1=2", "--format", "json"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  const std::vector<std::pair<std::string, double>> truth{
      {"mass1", 2}, {"mass2", 1}, {"clearance", 0.3}, {"restitution", 0.6}};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(json["parameters"][i]["name"], truth[i].first);
    // The files hold every digit; the estimate is asked to 1e-6.
    EXPECT_NEAR(json["parameters"][i]["value"], truth[i].second, 1e-6 * truth[i].second);
    EXPECT_EQ(json["parameters"][i]["identified"], true);
  }
  EXPECT_EQ(json["data"][1]["force_n"], 50);
  EXPECT_EQ(json["points_used"], 50);
  EXPECT_EQ(json["points"].size(), 50u);
}

TEST_F(IdentifyScene, ForcesOfTheCommandLineGoBeforeThoseOfTheFiles) {
  // Twice the force means twice the clearance times mass2.
  const auto result =
      run_fracfit({"identify-scene", weak, strong, "--force", "20,100", "--fix", "m1=2", "--format", "json"});
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NEAR(Json::parse(result.output)["combinations"][1]["value"], 0.6, 1e-6);
}

// The same points with names that say nothing.
TEST_F(IdentifyScene, TakesColumnsAndASweepByChoice) {
  const auto bare = [&](const std::string& file) {
    const auto plain = run_fracfit({"convert", file, "--format", "csv"});
    EXPECT_EQ(plain.code, 0) << plain.error;
    std::istringstream rows(plain.output);
    std::string text = "a,b,c\n", row;
    while (std::getline(rows, row))
      if (!row.empty() && (std::isdigit(static_cast<unsigned char>(row[0])) != 0)) text += row + "\n";
    return text;
  };
  std::vector<std::string> files;
  for (const auto& file : {weak, strong})
    files.push_back(folder.write("bare" + std::to_string(files.size()), bare(file)));
  const auto result = run_fracfit({"identify-scene", files[0], files[1], "--columns", "omega=1,re=2,im=3", "--force",
                                   "10,50", "--fix", "m1=2", "--format", "json"});
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NEAR(Json::parse(result.output)["parameters"][2]["value"], 0.3, 0.3e-6);
  const auto refused = run_fracfit({"identify-scene", weak, strong, "--select", "3", "--fix", "m1=2"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.error.find("--select"), std::string::npos) << refused.error;
}

TEST_F(IdentifyScene, ColumnThatTellsTheForcesIsUsed) {
  const auto result =
      run_fracfit({"identify-scene", simulated(folder, "10,50", "22.8:42.5:12log"), "--fix", "mass1=2"});
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.error.find("columns not used"), std::string::npos) << result.error;
  EXPECT_EQ(result.error.find("force_n"), std::string::npos) << result.error;
}

// Friction of the load, where the driven body has none; the mass of a body without a formula keeps its name.
TEST_F(IdentifyScene, FindsFrictionOfAReceptance) {
  const std::vector<std::string> friction{"--load-receptance", "1/(2 s^2 + 0.7 s)"};
  const auto file = folder.path("friction.csv");
  std::vector<std::string> arguments{"simulate", "--force", "50", "--clearance", "0.3", "--restitution", "0.6"};
  for (const char* each : {"--omega", "23:40:12", "--out", file.c_str()}) arguments.emplace_back(each);
  arguments.insert(arguments.end(), friction.begin(), friction.end());
  ASSERT_EQ(run_fracfit(arguments).code, 0);
  const auto result = run_fracfit(
      {"identify-scene", file, "--load-receptance", "1/(2 s^2 + b s)", "--fix", "mass2=1", "--format", "json"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  const std::vector<std::pair<std::string, double>> truth{
      {"b", 0.7}, {"mass2", 1}, {"clearance", 0.3}, {"restitution", 0.6}};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(json["parameters"][i]["name"], truth[i].first);
    EXPECT_NEAR(json["parameters"][i]["value"], truth[i].second, 1e-8);
  }
  const auto refused = run_fracfit({"identify-scene", file, "--load-receptance", "1/(2 s^2 + b s)", "--compare"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.error.find("--compare"), std::string::npos) << refused.error;
}

TEST_F(IdentifyScene, SaysWhatIsNotIdentified) {
  const auto result = run_fracfit({"identify-scene", weak, strong, "--format", "table"});
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.output.find("not identified"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("The data leave"), std::string::npos) << result.output;
}

TEST_F(IdentifyScene, TakesTheMassFromTheFiles) {
  const auto file = simulated(folder, "30", "18:33:25log", {"--body", "x2"});
  const auto result = run_fracfit({"identify-scene", file, "--format", "json"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  EXPECT_EQ(json["options"]["output"], "x2");
  EXPECT_NEAR(json["parameters"][0]["value"], 2, 1e-5);
  EXPECT_EQ(run_fracfit({"identify-scene", file, weak}).code, 2);
}

TEST_F(IdentifyScene, SaysThatValuesWithoutAUnitAreTakenAsMetresPerNewton) {
  for (const std::string columns : {"re,im", "magnitude_db,phase_deg"}) {
    const std::string rows = "omega_rad_s," + columns + "\n11,1,1\n12,1,1\n13,1,1\n14,1,1\n";
    const auto result = run_fracfit({"identify-scene", folder.write("plain.csv", rows), "--force", "10", "--contact", "hard"});
    EXPECT_NE(result.error.find("taken as m/N"), std::string::npos) << result.error;
  }
  const auto told = run_fracfit({"identify-scene", weak, "--fix", "m1=2", "--contact", "hard"});
  EXPECT_EQ(told.error.find("taken as"), std::string::npos) << told.error;
}

// Dry friction of 5 % and 2 % of the lower force, exact data; the library's test tells what is left of the values.
TEST_F(IdentifyScene, FindsDryFriction) {
  std::vector<std::string> files;
  for (const std::string force : {"10", "40"}) {
    files.push_back(folder.path("rubbing" + force + ".csv"));
    const auto result = run_fracfit({"simulate",
                                     "--force",
                                     force,
                                     "--clearance",
                                     "0.3",
                                     "--contact-frequency",
                                     "600",
                                     "--contact-restitution",
                                     "0.6",
                                     "--friction1",
                                     "0.5",
                                     "--friction2",
                                     "0.2",
                                     "--mass1",
                                     "1.5",
                                     "--mass2",
                                     "0.8",
                                     "--omega",
                                     force == "10" ? "11:16:7" : "22:32:7",
                                     "--out",
                                     files.back()});
    ASSERT_EQ(result.code, 0) << result.error;
  }
  const std::vector<std::string> command{"identify-scene", files[0], files[1], "--fix", "mass1=1.5"};
  const auto with = [&](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_fracfit(arguments);
  };
  const auto json = Json::parse(with(command, {"--friction", "auto", "--format", "json"}).output);
  EXPECT_EQ(json["options"]["friction"], "auto");
  EXPECT_EQ(json["friction_verdict"], "present");
  ASSERT_EQ(json["friction"].size(), 2u);
  EXPECT_EQ(json["friction"][0]["name"], "friction1");
  EXPECT_EQ(json["friction"][1]["unit"], "N");
  EXPECT_NEAR(json["friction"][0]["value"], 0.5, 1e-4);
  EXPECT_NEAR(json["friction"][1]["value"], 0.2, 1e-4);
  EXPECT_NEAR(json["parameters"][3]["value"], 0.6, 1e-4);
  const auto refused = [&](const std::vector<std::string>& more, const std::string& what) {
    const auto result = with(command, more);
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find(what), std::string::npos) << result.error;
  };
  refused({"--friction", "dry"}, "estimate");
  refused({"--fix", "friction1=0.5"}, "friction1");
  refused({"--friction", "auto", "--fix", "friction1=-1"}, "friction1");
  refused({"--friction", "auto", "--load-receptance", "1/(m1 s^2)"}, "--friction");
}

// Contacts of restitution 0.5 that ring at 12 and 5 times the frequency of the forces.
TEST_F(IdentifyScene, FindsTheTimeOfContacts) {
  std::vector<std::string> files;
  for (const std::string force : {"10", "50"}) {
    files.push_back(folder.path("soft" + force + ".csv"));
    const auto result = run_fracfit({"simulate", "--force", force, "--clearance", "0.3", "--contact-frequency", "150",
                                     "--contact-restitution", "0.5", "--mass1", "2", "--mass2", "1", "--omega",
                                     force == "10" ? "10.5:15:12" : "23.5:33.5:12", "--out", files.back()});
    ASSERT_EQ(result.code, 0) << result.error;
  }
  const auto json_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"identify-scene", files[0], files[1], "--fix", "mass1=2", "--format", "json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Json::parse(run_fracfit(arguments).output);
  };
  const auto json = json_of({});
  EXPECT_EQ(json["options"]["contact"], "auto");
  EXPECT_EQ(json["contact_verdict"], "compliant");
  // simulate says what it made of the frequency and the restitution; the files hold every digit, the estimate is asked
  // to 1e-5 of them.
  std::ostringstream file;
  file << std::ifstream(files[0]).rdbuf();
  const auto said = [&](const std::string& key) {
    const std::string line = "# " + key + ": ";
    return std::stod(file.str().substr(file.str().find(line) + line.size()));
  };
  const std::vector<std::pair<std::string, double>> truth{{"contact_time", said("contact_time_s")},
                                                          {"contact_stiffness", said("contact_stiffness_n_m")},
                                                          {"contact_damping", said("contact_damping_n_s_m")},
                                                          {"contact_restitution", 0.5}};
  EXPECT_NEAR(truth[1].second, 2.0 / 3 * 150 * 150, 1e-9);
  ASSERT_EQ(json["contact"].size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(json["contact"][i]["name"], truth[i].first);
    EXPECT_NEAR(json["contact"][i]["value"], truth[i].second, 1e-5 * truth[i].second) << truth[i].first;
    EXPECT_EQ(json["contact"][i]["identified"], true);
  }
  EXPECT_NEAR(json["parameters"][2]["value"], 0.3, 0.3e-5);
  // Taken for hard ones, exact data leave residuals.
  const auto hard = json_of({"--contact", "hard"});
  EXPECT_TRUE(hard["contact"].empty());
  EXPECT_EQ(hard["contact_verdict"], "hard");
  EXPECT_GT(hard["rms"], 1e3 * json["rms"].get<double>());
  const auto table = run_fracfit({"identify-scene", files[0], files[1], "--fix", "mass1=2", "--format", "table"});
  EXPECT_NE(table.output.find("contact_stiffness"), std::string::npos) << table.output;
  const auto refused = run_fracfit({"identify-scene", files[0], "--contact", "soft"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.error.find("auto"), std::string::npos) << refused.error;
  EXPECT_EQ(run_fracfit({"identify-scene", files[0], "--contact", "hard", "--fix", "contact_time=0.01"}).code, 2);
  EXPECT_EQ(run_fracfit({"identify-scene", files[0], "--contact", "auto", "--load-receptance", "1/(m1 s^2)"}).code, 2);
}

TEST_F(IdentifyScene, RefusesWrongInput) {
  const auto expect_failure = [](std::vector<std::string> arguments, int code, const std::string& part) {
    arguments.insert(arguments.begin(), "identify-scene");
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, code) << result.error;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect_failure({}, 2, "DATA");
  expect_failure({folder.path("none.csv")}, 3, "none.csv");
  expect_failure({weak, strong, "--force", "1,2,3"}, 2, "--force names 3");
  expect_failure({weak, "--force", "-1"}, 2, "--force is -1");
  expect_failure({weak, "--fix", "mass3=1"}, 2, "mass3");
  expect_failure({weak, "--fix", "mass1"}, 2, "NAME=VALUE");
  expect_failure({weak, "--fix", "restitution=2"}, 2, "restitution");
  expect_failure({weak, "--component", "phase"}, 2, "phase");
  expect_failure({weak, "--weight", "given"}, 3, "sigma");
  expect_failure({folder.write("plain.csv", "omega_rad_s,re,im\n1,1,1\n2,1,1\n3,1,1\n")}, 2, "--force");
  for (const std::string unit : {"ohm", "mm/N"}) {
    const std::string rows = "omega (rad/s),re (" + unit + "),im (" + unit + ")\n1,1,1\n2,1,1\n3,1,1\n";
    expect_failure({folder.write("unit.csv", rows), "--force", "10"}, 3, "'" + unit + "'");
  }
  expect_failure({folder.write("bad.csv", "# force_n: strong\nomega_rad_s,re,im\n1,1,1\n2,1,1\n")}, 3, "force_n");
}

}  // namespace
