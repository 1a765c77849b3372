// SPDX-License-Identifier: BSD-3-Clause
// What other programs rely on: subcommands, columns, JSON keys, exit codes, and that outputs can be made again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

const std::vector<std::string> scene{"simulate", "--force", "40", "--clearance", "0.3", "--restitution", "0.6"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::string successful(const std::vector<std::string>& arguments) {
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, 0) << result.error;
  return result.output;
}

Json successful_json(const std::vector<std::string>& arguments) {
  return Json::parse(successful(arguments));
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  bool header = true;
  for (const auto& line : lines_of(csv)) {
    if (line.starts_with('#')) continue;
    if (!std::exchange(header, false)) rows.push_back(fields_of(line));
  }
  return rows;
}

std::string entry_of(const std::string& csv, const std::string& key) {
  for (const auto& line : lines_of(csv))
    if (line.starts_with("# " + key + ": ")) return line.substr(key.size() + 4);
  return {};
}

/// Samples of a formula as a file: 41 points from 0.1 to 10 rad/s.
template <typename Model>
std::string sampled(const Model& model, const std::string& header = "") {
  std::ostringstream stream;
  stream.precision(17);
  stream << header << "omega_rad_s,re,im\n";
  for (int i = 0; i <= 40; ++i) {
    const double omega = std::pow(10.0, -1 + i / 20.0);
    const std::complex<double> value = model(std::complex<double>(0, omega));
    stream << omega << ',' << value.real() << ',' << value.imag() << '\n';
  }
  return stream.str();
}

std::string power_law_data() {
  return sampled([](std::complex<double> s) { return 2.0 * std::pow(s, 0.7); });
}

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

void expect_keys(const Json& object, const std::vector<std::string>& keys) {
  for (const auto& key : keys) EXPECT_TRUE(object.contains(key)) << key << " is missing";
}

/// Times differ from run to run; nothing else may.
Json without_seconds(Json json) {
  json.erase("seconds");
  if (json.contains("ranking"))
    for (auto& candidate : json["ranking"]) candidate.erase("seconds");
  return json;
}

TEST(CommandLine, VersionAndHelp) {
  EXPECT_TRUE(successful({"--version"}).starts_with("fracfit "));
  for (const char* subcommand : {"simulate", "fit", "identify", "jump-law", "report"}) {
    const auto help = successful({subcommand, "--help"});
    const auto examples = help.find("Examples:\n  fracfit " + std::string(subcommand));
    EXPECT_NE(examples, std::string::npos) << help;
    EXPECT_NE(successful({"--help"}).find(subcommand), std::string::npos);
  }
}

TEST(Simulate, ColumnsAndHeaderAreThoseOfTheContract) {
  const auto csv = successful(with(scene, {"--omega", "5:35:20log"}));
  EXPECT_NE(csv.find("\nomega_rad_s,re_m_per_n,im_m_per_n,regime,period,impacts_per_period,uncertainty_m_per_n,"
                     "third_harmonic_ratio\n"),
            std::string::npos);
  for (const char* key : {"fracfit", "command", "force_n", "clearance_m", "restitution", "mass1_kg", "mass2_kg",
                          "output", "model", "protocol", "tolerance"})
    EXPECT_NE(entry_of(csv, key), "") << key;
  EXPECT_EQ(rows_of(csv).size(), 20U);
}

TEST(Simulate, JoinedMassesMoveAsOne) {
  const auto rows = rows_of(successful({"simulate", "--force", "40", "--clearance", "0", "--restitution", "0.6",
                                        "--mass1", "2", "--mass2", "3", "--omega", "1,10"}));
  ASSERT_EQ(rows.size(), 2U);
  for (const auto& row : rows) {
    const double omega = std::stod(row[0]);
    // Closed form -1/((M1 + M2) w^2), a few roundings.
    EXPECT_NEAR(std::stod(row[1]) * -5 * omega * omega, 1, 1e-15);
    EXPECT_EQ(std::stod(row[2]), 0);
    EXPECT_EQ(row[3], "rigid");
  }
}

TEST(Simulate, TheStaticCurveVanishesWhereThePlayIsNotCrossed) {
  // X = F/((M1 + M2) w^2) <= Delta/2 from w = sqrt(2 F/(Delta (M1 + M2))) = 11.547 rad/s upwards.
  const auto rows = rows_of(
      successful({"simulate", "--force", "40", "--clearance", "0.3", "--motion", "static", "--omega", "11.5,11.6"}));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_NE(std::stod(rows[0][2]), 0);
  EXPECT_EQ(std::stod(rows[1][1]), 0);
  EXPECT_EQ(std::stod(rows[1][2]), 0);
  EXPECT_EQ(rows[0][3], "static");
}

TEST(Simulate, JsonHoldsTheNumbersOfTheCsv) {
  const auto rows = rows_of(successful(with(scene, {"--omega", "5,20"})));
  const auto json = successful_json(with(scene, {"--omega", "5,20", "--format", "json"}));
  expect_keys(json, {"fracfit", "command", "scene", "points"});
  ASSERT_EQ(json["points"].size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(json["points"][i]["omega_rad_s"].get<double>(), std::stod(rows[i][0]));
    EXPECT_EQ(json["points"][i]["re_m_per_n"].get<double>(), std::stod(rows[i][1]));
    EXPECT_EQ(json["points"][i]["im_m_per_n"].get<double>(), std::stod(rows[i][2]));
    EXPECT_EQ(json["points"][i]["regime"], rows[i][3]);
  }
  // 5 rad/s is deep in the range of complete chatter: infinitely many impacts, which JSON cannot say.
  EXPECT_EQ(rows[0][3], "chatter");
  EXPECT_EQ(rows[0][5], "inf");
  EXPECT_TRUE(json["points"][0]["impacts_per_period"].is_null());
}

TEST(Simulate, TheForcedMassMovesWithItsReaction) {
  // Passivity: Im N1 = -(M2/M1) Im N2.
  const auto x1 = rows_of(successful(with(scene, {"--mass1", "2", "--omega", "5,25", "--body", "x1"})));
  const auto x2 = rows_of(successful(with(scene, {"--mass1", "2", "--omega", "5,25", "--body", "x2"})));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(std::stod(x1[i][2]) / std::stod(x2[i][2]), -0.5, 1e-9);
}

TEST(Simulate, TheCommandInTheFileMakesTheSameFile) {
  const TemporaryFolder folder;
  const auto path = folder.path("curve.csv");
  successful(with(scene, {"--omega", "5:35:9log", "--out", path, "--threads", "2", "--quiet"}));
  const auto command = entry_of(content_of(path), "command");
  std::vector<std::string> words;
  std::istringstream stream(command);
  for (std::string word; stream >> word;) words.push_back(word);
  ASSERT_EQ(words.front(), "fracfit");
  words.erase(words.begin());
  EXPECT_EQ(successful(words), content_of(path));
}

TEST(Threads, DoNotChangeAByte) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", power_law_data());
  for (const auto& arguments : {with(scene, {"--omega", "5:35:60log"}), std::vector<std::string>{"jump-law"}})
    EXPECT_EQ(successful(with(arguments, {"--threads", "1"})), successful(with(arguments, {"--threads", "2"})));
  for (const auto& arguments : {std::vector<std::string>{"fit", data, "--model", "power-law"},
                                std::vector<std::string>{"identify", data, "--models", "power-law,lag,gain"}})
    EXPECT_EQ(without_seconds(successful_json(with(arguments, {"--threads", "1"}))),
              without_seconds(successful_json(with(arguments, {"--threads", "2"}))));
}

TEST(Fit, JsonHasTheKeysOfTheContractAndTheTrueParameters) {
  const TemporaryFolder folder;
  const auto json = successful_json({"fit", folder.write("data.csv", power_law_data()), "--model", "power-law"});
  expect_keys(json, {"fracfit", "command", "model", "parameters", "cost", "rms", "aicc", "bic", "termination", "starts",
                     "seconds"});
  EXPECT_EQ(json["termination"], "converged");
  ASSERT_EQ(json["parameters"].size(), 2U);
  for (const auto& parameter : json["parameters"]) {
    expect_keys(parameter, {"name", "value", "standard_error", "ci95", "identified"});
    EXPECT_EQ(parameter["ci95"].size(), 2U);
    EXPECT_TRUE(parameter["identified"].get<bool>());
  }
  // The data are exact to 17 digits; Ceres stops at a relative change of the cost near 1e-12, so parameters hold 1e-6.
  EXPECT_NEAR(json["parameters"][0]["value"].get<double>(), 2, 2e-6);
  EXPECT_NEAR(json["parameters"][1]["value"].get<double>(), 0.7, 1e-6);
}

TEST(Fit, AFormulaOfItsOwnIsFittedToBothParts) {
  const TemporaryFolder folder;
  const auto data =
      folder.write("data.csv", sampled([](std::complex<double> s) { return 3.0 / (0.5 * std::pow(s, 0.8) + 1.0); }));
  const auto json = successful_json({"fit", data, "--model", "K/(T s^a + 1)", "--component", "both"});
  EXPECT_EQ(json["model"], "K/(T s^a + 1)");
  EXPECT_NEAR(json["parameters"][0]["value"].get<double>(), 3, 3e-6);
  EXPECT_NEAR(json["parameters"][1]["value"].get<double>(), 0.5, 1e-6);
  EXPECT_NEAR(json["parameters"][2]["value"].get<double>(), 0.8, 1e-6);
  EXPECT_EQ(json["residuals"], 82);
}

TEST(Fit, FixedAndBoundedParameters) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", power_law_data());
  const auto fixed = successful_json({"fit", data, "--model", "power-law", "--fix", "a=0.7"});
  EXPECT_TRUE(fixed["parameters"][1]["fixed"].get<bool>());
  EXPECT_EQ(fixed["parameters"][1]["value"], 0.7);
  EXPECT_EQ(fixed["free_parameters"], 1);
  // The preset limits its order to (0, 1]; a value takes the place of those limits, not of the user's.
  const auto preset = successful_json({"fit", data, "--model", "cole-cole", "--component", "both", "--fix", "a=0.7"});
  EXPECT_TRUE(preset["parameters"][2]["fixed"].get<bool>());
  EXPECT_EQ(preset["parameters"][2]["value"], 0.7);
  EXPECT_EQ(run_fracfit({"fit", data, "--model", "cole-cole", "--bound", "a=0.1:0.9", "--fix", "a=0.7"}).code, 2);
  const auto bounded = successful_json({"fit", data, "--model", "power-law", "--bound", "a=:0.5"});
  EXPECT_TRUE(bounded["parameters"][1]["at_bound"].get<bool>());
  EXPECT_NEAR(bounded["parameters"][1]["value"].get<double>(), 0.5, 1e-9);
  EXPECT_TRUE(bounded["parameters"][1]["standard_error"].is_null());
}

TEST(Fit, PointsCanBeChosenAndWeighted) {
  const TemporaryFolder folder;
  // One point is far off: it is left out as an outlier, and where it is kept a condition or a tiny weight removes its
  // influence.
  auto text = power_law_data();
  std::string weighted;
  bool header = true;
  for (const auto& line : lines_of(text)) weighted += line + (std::exchange(header, false) ? ",trust\n" : ",1\n");
  const auto data = folder.write("data.csv", weighted + "20,0.01,0.01,1e-30\n");
  const auto order = [&](const std::vector<std::string>& more) {
    return successful_json(with({"fit", data, "--model", "power-law", "--quiet"}, more))["parameters"][1]["value"]
        .get<double>();
  };
  EXPECT_NEAR(order({}), 0.7, 1e-6);
  EXPECT_GT(std::abs(order({"--outliers", "keep"}) - 0.7), 0.01);
  EXPECT_NEAR(order({"--outliers", "keep", "--where", "omega<15"}), 0.7, 1e-6);
  EXPECT_NEAR(order({"--outliers", "keep", "--where", "magnitude>0.1", "--where", "re>0"}), 0.7, 1e-6);
  EXPECT_NEAR(order({"--outliers", "keep", "--weight", "trust"}), 0.7, 1e-6);
}

TEST(Fit, RealisationsGiveTheOrderTheyApproximate) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", power_law_data());
  const auto order = [&](const std::vector<std::string>& more) {
    const auto json = successful_json(with({"fit", data, "--model", "power-law", "--component", "both"}, more));
    return json["parameters"][1]["value"].get<double>();
  };
  // Two decades of data in the middle of a band of eight: the recursive approximation is within a few per mille there.
  EXPECT_NEAR(order({"--realisation", "oustaloup", "--band", "1e-4:1e4", "--poles", "12"}), 0.7, 0.01);
  // ((1 - e^{-j w h})/h)^a bends by a w h/2 <= 0.7 * 10 * 1e-3/2 = 3.5e-3 rad at the upper end.
  EXPECT_NEAR(order({"--realisation", "grunwald-letnikov", "--sample-time", "1e-3"}), 0.7, 0.01);
}

TEST(Fit, SameSeedSameResult) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", power_law_data());
  const std::vector<std::string> arguments{
      "fit", data, "--model", "K1 s^a1 + K2 s^a2", "--seed", "18446744073709551615"};
  const auto json = successful_json(arguments);
  EXPECT_EQ(json["options"]["seed"].get<std::uint64_t>(), 18446744073709551615U);
  EXPECT_EQ(without_seconds(json), without_seconds(successful_json(arguments)));
}

TEST(Fit, StandardInputIsRead) {
  ProgramSetting setting;
  setting.input = power_law_data();
  const auto result = run_fracfit({"fit", "-", "--model", "power-law"}, setting);
  EXPECT_EQ(result.code, 0) << result.error;
}

TEST(Fit, CsvAndTable) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", power_law_data());
  const auto csv = successful({"fit", data, "--model", "power-law", "--format", "csv"});
  EXPECT_NE(csv.find("\nname,value,standard_error,ci95_lower,ci95_upper,identified,at_bound,fixed,unit,lower_limit,"
                     "upper_limit\nK,"),
            std::string::npos)
      << csv;
  const auto table = successful({"fit", data, "--model", "power-law", "--bound", "a=:0.5", "--format", "table"});
  EXPECT_NE(table.find("at its bound"), std::string::npos) << table;
}

TEST(Fit, PeopleGetATableAndPipesGetJson) {
  const TemporaryFolder folder;
  const std::vector<std::string> arguments{"fit", folder.write("data.csv", power_law_data()), "--model", "power-law"};
  if (!has_terminals()) GTEST_SKIP() << "no pseudo-terminals here";
  ProgramSetting terminal;
  terminal.terminal_output = true;
  const auto shown = run_fracfit(arguments, terminal);
  EXPECT_EQ(shown.code, 0);
  EXPECT_NE(shown.output.find("\n  parameter "), std::string::npos) << shown.output;
  EXPECT_TRUE(successful(arguments).starts_with("{"));
}

TEST(Fit, LithiumCellIsFittedToItsKnownBest) {
  const std::string file = FRACFIT_SOURCE_DIR "/../shared/cases-ident/impedancepy_exampleData.csv";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  const auto json =
      successful_json({"fit", file, "--where", "im<0", "--component", "both", "--bound", "n1=:1", "--bound", "n2=:1",
                       "--bound", "n3=:1", "--model", "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2) + 1/(Q3 s^n3)"});
  EXPECT_EQ(json["data"]["points"], 57);
  EXPECT_LE(json["cost"].get<double>(), 5.4432e-3);
}

TEST(Identify, RanksAndGivesAVerdict) {
  const TemporaryFolder folder;
  const auto json = successful_json({"identify", folder.write("data.csv", power_law_data())});
  expect_keys(json, {"fracfit", "command", "ranking", "chosen", "verdict", "evidence", "verdict_sentence"});
  double share = 0;
  for (const auto& candidate : json["ranking"]) {
    expect_keys(candidate, {"name", "class", "model", "parameters", "cost", "rms", "aicc", "bic", "delta_aicc",
                            "akaike_weight", "termination", "starts", "seconds"});
    if (candidate["akaike_weight"].is_number()) share += candidate["akaike_weight"].get<double>();
  }
  EXPECT_NEAR(share, 1, 1e-12);
  EXPECT_EQ(json["chosen"], "power-law");
  EXPECT_EQ(json["verdict"], "supported");
}

TEST(Identify, APointIsLeftOutWhereAGivenCurveIsTheBest) {
  // Without clearance the two masses move as one: N = -1/((M1 + M2) omega^2).
  std::string rows = "omega_rad_s,re,im\n";
  for (int i = 0; i < 30; ++i) {
    const double omega = std::pow(10, i / 20.0);
    const std::complex<double> ripple(1 + 0.01 * std::sin(37.0 * i * i), 0.01 * std::cos(53.0 * i * i));
    const auto value = -1 / (2 * omega * omega) * ripple * (i == 14 ? 1.5 : 1.0);
    rows += std::to_string(omega) + "," + std::to_string(value.real()) + "," + std::to_string(value.imag()) + "\n";
  }
  const TemporaryFolder folder;
  const auto json = successful_json({"identify", folder.write("rigid.csv", rows), "--component", "both", "--models",
                                     "lag", "--mass1", "1", "--mass2", "1", "--force", "1", "--clearance", "1e-12"});
  EXPECT_EQ(json["chosen"], "static-backlash");
  EXPECT_EQ(json["data"]["left_out"].size(), 1U) << json["data"];
}

TEST(Identify, SimulatedFilesBringTheStaticCurveAlong) {
  const TemporaryFolder folder;
  const auto data = folder.path("curve.csv");
  successful(with(scene, {"--omega", "6:11:30log", "--out", data}));
  const auto result = run_fracfit({"identify", data, "--models", "power-law,differentiator"});
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.error.find("force_n = 40, clearance_m = 0.3"), std::string::npos) << result.error;
  const auto json = Json::parse(result.output);
  EXPECT_EQ(json["ranking"].size(), 3U);
  EXPECT_TRUE(std::any_of(json["ranking"].begin(), json["ranking"].end(), [](const Json& candidate) {
    return candidate["name"] == "static-backlash" && candidate["class"] == "fixed-curve" &&
           candidate["free_parameters"] == 0;
  }));
  EXPECT_NE(json["command"].get<std::string>().find("--clearance 0.3 --force 40"), std::string::npos);
  // Without the head nothing says that they were computed.
  std::istringstream whole(content_of(data));
  std::string rows;
  for (std::string line; std::getline(whole, line);) rows += line.starts_with('#') ? "" : line + "\n";
  const auto measured = folder.write("measured.csv", rows);
  const auto none = run_fracfit({"identify", measured, "--models", "differentiator", "--format", "table"});
  EXPECT_NE(none.output.find("of all, as none follows the data"), std::string::npos) << none.output;
}

TEST(Identify, TellsAndTakesAssumptions) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", power_law_data());
  const auto unset = successful_json({"identify", data, "--models", "power-law,lag-delay"});
  EXPECT_EQ(unset["assumptions"]["stable"], "unless the data speak against it");
  EXPECT_EQ(unset["assumptions"]["dead_time"], "if the data speak for it");
  EXPECT_EQ(unset["assumptions"]["passive"], false);
  EXPECT_TRUE(unset["notes"].is_array());
  EXPECT_TRUE(unset["set_aside"].is_null());
  const auto told = successful_json({"identify", data, "--models", "power-law,lag-delay", "--stable", "yes",
                                     "--dead-time", "no", "--passive", "--bound", "K=0:"});
  EXPECT_EQ(told["assumptions"]["stable"], "yes");
  EXPECT_EQ(told["assumptions"]["dead_time"], "no");
  EXPECT_EQ(told["assumptions"]["passive"], true);
  ASSERT_EQ(told["ranking"].size(), 1U);
  const auto gain = told["ranking"][0]["parameters"][0];
  EXPECT_EQ(gain["limits"][0], 0);
  EXPECT_EQ(gain["limits_given"], true);
  EXPECT_NE(told["command"].get<std::string>().find("--stable yes --dead-time no --passive"), std::string::npos)
      << told["command"];

  const auto word = run_fracfit({"identify", data, "--stable", "perhaps"});
  EXPECT_EQ(word.code, 2);
  EXPECT_NE(word.error.find("--stable"), std::string::npos) << word.error;
  const auto name = run_fracfit({"identify", data, "--models", "power-law", "--bound", "Z=0:1"});
  EXPECT_EQ(name.code, 2);
  EXPECT_NE(name.error.find("'Z'"), std::string::npos) << name.error;
  const auto formula = run_fracfit({"fit", data, "--model", "lag-delay", "--dead-time", "no"});
  EXPECT_EQ(formula.code, 2);
  EXPECT_NE(formula.error.find("dead time"), std::string::npos) << formula.error;
}

TEST(Identify, TheCommandInTheResultGivesTheSameResult) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", power_law_data());
  const auto first = successful_json({"identify", data, "--models", "power-law,gain"});
  EXPECT_EQ(first["command"], "fracfit identify " + data +
                                  " --models power-law,gain --component both --weight learned --loss none "
                                  "--realisation exact --seed 1 --outliers leave-out");
  const auto csv = successful({"identify", data, "--models", "power-law,gain", "--format", "csv"});
  EXPECT_EQ(first["command"], entry_of(csv, "command"));
  EXPECT_EQ(rows_of(csv).size(), 2U);
}

TEST(JumpLaw, ContactAtRestFollowsTheLimitFrequencyExactly) {
  // w_J = w_L = sqrt(2 F/(M2 Delta)) at every restitution, so a = sqrt(2/M2) Delta^-1/2 and b = 1/2 but for rounding.
  const auto json = successful_json({"jump-law", "--criterion", "contact-at-rest", "--mass2", "4"});
  expect_keys(json,
              {"fracfit", "command", "points", "laws", "a_of_clearance", "b_of_clearance", "published", "similarity"});
  EXPECT_EQ(json["points"].size(), 5U * 8U * 6U);
  for (const auto& point : json["points"]) {
    EXPECT_EQ(keys_of(point), (std::vector<std::string>{"force", "clearance", "restitution", "omega_jump", "force_n",
                                                        "clearance_m", "omega_jump_rad_s"}));
    const double limit = std::sqrt(2 * point["force"].get<double>() / (4 * point["clearance"].get<double>()));
    EXPECT_NEAR(point["omega_jump"].get<double>() / limit, 1, 1e-14);
  }
  EXPECT_EQ(json["laws"].size(), 8U);
  for (const auto& law : json["laws"]) {
    expect_keys(law, {"clearance", "a", "b", "a_ci95", "b_ci95", "r_squared"});
    EXPECT_NEAR(law["b"].get<double>(), 0.5, 1e-13);
    EXPECT_NEAR(law["a"].get<double>() * std::sqrt(law["clearance"].get<double>()), std::numbers::sqrt2 / 2, 1e-13);
  }
  EXPECT_NEAR(json["a_of_clearance"]["coefficient"].get<double>(), std::numbers::sqrt2 / 2, 1e-13);
  EXPECT_NEAR(json["a_of_clearance"]["exponent"].get<double>(), -0.5, 1e-13);
  EXPECT_EQ(json["published"]["a_of_clearance"]["coefficient"], 1.193);
  EXPECT_EQ(json["published"]["b_of_clearance"]["exponent"], 0.024);
  EXPECT_NEAR(json["similarity"]["difference_percent"]["a_coefficient"].get<double>(), 0, 1e-11);
  EXPECT_NEAR(json["published"]["difference_percent"]["a_exponent"].get<double>(), 100 * (0.5 / 0.564 - 1), 1e-10);
}

TEST(JumpLaw, CsvHoldsThePointsAndTheTableTheLaws) {
  const std::vector<std::string> small{"jump-law", "--force",       "10,40", "--clearance",
                                       "0.1,0.4",  "--restitution", "0.6"};
  const auto csv = successful(with(small, {"--format", "csv"}));
  EXPECT_NE(csv.find("\nforce_n,clearance_m,restitution,omega_jump_rad_s\n"), std::string::npos);
  EXPECT_EQ(rows_of(csv).size(), 4U);
  EXPECT_NE(entry_of(csv, "criterion"), "");
  EXPECT_NE(successful(with(small, {"--format", "table"})).find("1.193 Delta^-0.564"), std::string::npos);
}

TEST(Report, OnAMeasuredFileWritesPageTablesAndNumbers) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", power_law_data());
  const auto result = run_fracfit({"report", data, "--out", folder.path("report")});
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.error.find("index.html"), std::string::npos) << result.error;
  EXPECT_EQ(result.output, "");
  EXPECT_GT(fs::file_size(folder.path("report/index.html")), 0U);
  EXPECT_TRUE(Json::accept(content_of(folder.path("report/results.json"))));
}

TEST(Report, WithoutGnuplotTheNumbersAreWrittenAll) {
  const TemporaryFolder folder;
  const auto data = folder.write("data.csv", power_law_data());
  ProgramSetting setting;
  setting.search_path = folder.path("empty");
  fs::create_directory(setting.search_path);
  const auto result = run_fracfit({"report", data, "--out", folder.path("report")}, setting);
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.error.find("gnuplot-nox"), std::string::npos) << result.error;
  EXPECT_GT(fs::file_size(folder.path("report/index.html")), 0U);
  EXPECT_TRUE(Json::accept(content_of(folder.path("report/results.json"))));
}

TEST(Contract, EveryExportIsASubcommandOfItsOwn) {
  const std::string help = successful({"--help"});
  for (const std::string target : {"arduino", "c99", "fmu", "spice"}) {
    EXPECT_NE(help.find("\n  export " + target + " "), std::string::npos) << target;
    EXPECT_NE(successful({"export", target, "--help"}).find("\n  fracfit export " + target + " "), std::string::npos);
  }
  for (const std::vector<std::string>& asked : {std::vector<std::string>{"export", "--help"}, {"help", "export"}}) {
    const std::string list = successful(asked);
    for (const std::string target : {"arduino", "c99", "fmu", "spice"})
      EXPECT_NE(list.find("\n  export " + target + " "), std::string::npos) << target;
  }
  // The old way to C stays.
  EXPECT_NE(successful({"controller", "--kp", "1", "--sample-time", "1", "--format", "c"}).find("controller_step("),
            std::string::npos);
}

std::vector<std::string> compliant(const std::string& command, const std::vector<std::string>& more = {}) {
  return with({command, "--force", "40", "--clearance", "0.3", "--omega", "20"}, more);
}

TEST(CompliantContacts, AreFollowedInLoopsToo) {
  // Held by both frictions together, 0.7 N over the 7 N/m of the controller.
  const std::string csv = successful(
      {"loop", "--controller", "7 + 2 s", "--body",      "x2",  "--contact-stiffness", "500", "--contact-damping",
       "5",    "--friction1",  "0.2",     "--friction2", "0.5", "--setpoint-step",     "3",   "--duration",
       "60",   "--every",      "30",      "--format",    "csv"});
  EXPECT_EQ(entry_of(csv, "contact_stiffness_n_m"), "500");
  EXPECT_EQ(entry_of(csv, "friction2_n"), "0.5");
  EXPECT_EQ(entry_of(csv, "end"), "duration");
  const double from = std::stod(entry_of(csv, "rest_from_m")), to = std::stod(entry_of(csv, "rest_to_m"));
  EXPECT_NEAR(from, 2.9, 1e-12);
  EXPECT_NEAR(to, 3.1, 1e-12);
  const auto rows = rows_of(csv);
  std::size_t contacts = 0;
  for (const auto& row : rows) {
    ASSERT_EQ(row.size(), 9U);
    contacts += row[6] == "contact";
    EXPECT_EQ(row[7] != "none", std::stod(row[8]) > 0 || row[6] == "contact") << row[0];
  }
  EXPECT_EQ(std::to_string(contacts), entry_of(csv, "contacts"));
  EXPECT_GT(contacts, 2U);
  // It has come to rest, within that range.
  EXPECT_EQ(rows.back()[2], "0");
  EXPECT_EQ(rows.back()[4], "0");
  EXPECT_GE(std::stod(rows.back()[3]), from);
  EXPECT_LE(std::stod(rows.back()[3]), to);
  // A record of it has the columns of a rig.
  const std::string record =
      successful({"loop", "--controller", "7 + 2 s", "--contact-stiffness", "500", "--contact-damping", "5",
                  "--velocity2", "1", "--duration", "1", "--every", "0.5", "--record", "--format", "csv"});
  EXPECT_NE(record.find("time_s,force_n,x1_m,x2_m"), std::string::npos);
}

TEST(CompliantContacts, HaveLimitCycles) {
  const std::vector<std::string> command{"limit-cycles",
                                         "--controller",
                                         "1 + 0.3 s",
                                         "--contact-frequency",
                                         "200",
                                         "--contact-restitution",
                                         "0.6",
                                         "--friction1",
                                         "0.01",
                                         "--starts",
                                         "0"};
  const Json json = successful_json(with(command, {"--format", "json"}));
  EXPECT_EQ(json["scene"]["friction1_n"], 0.01);
  EXPECT_NEAR(json["rests"]["to"].get<double>(), 0.01, 1e-12);
  ASSERT_EQ(json["cycles"].size(), 1U);
  const Json& cycle = json["cycles"][0];
  // That of the restitution has 0.9425 rad/s; contacts and friction of some thousandths of its force move it little.
  EXPECT_NEAR(cycle["omega"].get<double>(), 0.9425, 0.02);
  EXPECT_EQ(cycle["impacts_per_period"], 2);
  EXPECT_EQ(cycle["symmetric"], true);
  for (const char* key : {"stable", "multiplier_modulus", "impulse", "impact_speed", "amplitude_x1", "amplitude_x2",
                          "amplitude_force", "harmonics", "describing_function", "sticks_per_period", "start", "error"})
    EXPECT_TRUE(cycle.contains(key)) << key;
  // The motion from its start is that of the force and stays the cycle: x2 - x1 is half of the clearance.
  EXPECT_NEAR(cycle["start"]["x2"].get<double>() - cycle["start"]["x1"].get<double>(), 0.5, 1e-12);
  const std::string csv = successful(with(command, {"--format", "csv"}));
  EXPECT_EQ(rows_of(csv).size(), 1U);
  EXPECT_EQ(rows_of(csv)[0].size(), 13U);
  EXPECT_NE(successful(with(command, {"--format", "table"})).find("Dry friction can hold x1 from -0.01 to 0.01 m"),
            std::string::npos);
}

TEST(CompliantContacts, AreGivenByStiffnessOrFrequencyAndToldInTheHeader) {
  // m = 1/2: k = m wc^2, c = 2 zeta m wc.
  const std::string by_stiffness = successful(
      compliant("simulate", {"--contact-stiffness", "80000", "--contact-damping", "100", "--format", "csv"}));
  EXPECT_EQ(entry_of(by_stiffness, "contact_frequency_rad_s"), "400");
  EXPECT_EQ(entry_of(by_stiffness, "contact_ratio"), "0.25");
  EXPECT_EQ(entry_of(by_stiffness, "restitution"), "");
  const std::string by_frequency =
      successful(compliant("simulate", {"--contact-frequency", "400", "--contact-ratio", "0.25", "--format", "csv"}));
  EXPECT_EQ(entry_of(by_frequency, "contact_stiffness_n_m"), "80000");
  EXPECT_EQ(entry_of(by_frequency, "contact_damping_n_s_m"), "100");
  EXPECT_EQ(rows_of(by_frequency), rows_of(by_stiffness));
  // e = exp(-2 zeta acos(zeta)/sqrt(1 - zeta^2)), and 2 acos(zeta)/(wc sqrt(1 - zeta^2)) long.
  const double root = std::sqrt(1 - 0.25 * 0.25);
  EXPECT_NEAR(std::stod(entry_of(by_frequency, "contact_restitution")), std::exp(-0.5 * std::acos(0.25) / root), 1e-14);
  EXPECT_NEAR(std::stod(entry_of(by_frequency, "contact_time_s")), 2 * std::acos(0.25) / root / 400, 1e-16);
  const std::string by_restitution =
      successful(compliant("simulate", {"--contact-frequency", "400", "--contact-restitution",
                                        entry_of(by_frequency, "contact_restitution"), "--format", "csv"}));
  EXPECT_NEAR(std::stod(entry_of(by_restitution, "contact_ratio")), 0.25, 1e-14);
}

TEST(CompliantContacts, StandInJsonAndHistory) {
  const std::vector<std::string> contact{"--contact-stiffness", "80000", "--contact-damping", "100",
                                         "--friction1",         "2"};
  const Json json = successful_json(with(compliant("simulate", contact), {"--format", "json"}));
  const Json& told = json["scene"];
  EXPECT_FALSE(told.contains("restitution"));
  EXPECT_EQ(told["contact_stiffness_n_m"], 80000);
  EXPECT_EQ(told["friction1_n"], 2);
  EXPECT_EQ(told["protocol"], "two-impact");
  const std::string history = successful(with(compliant("history", contact), {"--format", "csv"}));
  EXPECT_EQ(entry_of(history, "friction1_n"), "2");
  std::vector<std::string> events;
  for (const auto& row : rows_of(history)) {
    ASSERT_EQ(row.size(), 8u);
    events.push_back(row[5]);
    EXPECT_EQ(row[6] != "none", std::stod(row[7]) > 0 || row[5] == "contact") << row[0];
  }
  for (const char* event : {"sample", "contact", "separation", "parting"})
    EXPECT_NE(std::find(events.begin(), events.end(), event), events.end()) << event;
}

TEST(CompliantContacts, TakeSeveralForcesAndClearances) {
  const std::vector<std::string> scenes{"simulate", "--force",           "20,40", "--clearance",
                                        "0.2,0.3",  "--omega",           "18,20", "--contact-stiffness",
                                        "80000",    "--contact-damping", "100"};
  const std::string csv = successful(with(scenes, {"--format", "csv"}));
  EXPECT_NE(csv.find("\nforce_n,clearance_m,omega_rad_s,re_m_per_n"), std::string::npos) << csv;
  EXPECT_EQ(entry_of(csv, "contact_ratio"), "0.25");
  const auto rows = rows_of(csv);
  ASSERT_EQ(rows.size(), 8u);
  const auto one = rows_of(successful({"simulate", "--force", "40", "--clearance", "0.3", "--omega", "18,20",
                                       "--contact-stiffness", "80000", "--contact-damping", "100", "--format", "csv"}));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(std::vector<std::string>(rows[6 + i].begin() + 2, rows[6 + i].end()), one[i]);
    EXPECT_EQ(rows[6 + i][0], "40");
    EXPECT_EQ(rows[6 + i][1], "0.3");
  }
  const Json json = successful_json(with(scenes, {"--format", "json"}));
  ASSERT_EQ(json["sweeps"].size(), 4u);
  EXPECT_EQ(json["sweeps"][1]["scene"]["clearance_m"], 0.3);
  EXPECT_EQ(json["sweeps"][1]["scene"]["contact_damping_n_s_m"], 100);
}

// Each row of a map is that of simulate for the one contact, whichever pair of options gives it.
TEST(CompliantContacts, MakeAMapOfWhatSimulateGives) {
  const std::vector<std::string> both{"--friction1", "1", "--format", "csv", "--quiet"};
  const std::vector<std::vector<std::string>> pairs{
      {"--contact-stiffness", "20000,80000", "--contact-damping", "50,100"},
      {"--contact-frequency", "200,400", "--contact-ratio", "0.125,0.25"},
      {"--contact-frequency", "200,400", "--contact-restitution", "0.5,0.7"}};
  for (const auto& pair : pairs) {
    const std::string table = successful(with(
        with({"map", "--force", "40", "--clearance", "0.3", "--omega", "18,20", "--mean-tolerance", "0"}, pair), both));
    EXPECT_EQ(entry_of(table, "friction1_n"), "1");
    EXPECT_EQ(entry_of(table, "protocol"), "two-impact");
    const auto rows = rows_of(table);
    ASSERT_EQ(rows.size(), 8u);
    const auto first = [&](std::size_t i) { return pair[1].substr(i * (pair[1].find(',') + 1), pair[1].find(',')); };
    const auto second = [&](std::size_t i) {
      return i == 0 ? pair[3].substr(0, pair[3].find(',')) : pair[3].substr(pair[3].find(',') + 1);
    };
    for (std::size_t i = 0; i < 4; ++i) {
      const auto one = rows_of(successful(
          with(compliant("simulate", {pair[0], first(i / 2), pair[2], second(i % 2), "--diagnostics"}), both)));
      EXPECT_EQ(rows[2 * i + 1][0], first(i / 2));
      EXPECT_EQ(rows[2 * i + 1][1], second(i % 2));
      // A frequency alone begins elsewhere than one of a curve, and so ends within what the last step leaves.
      ASSERT_EQ(one.size(), 1u);
      EXPECT_EQ(rows[2 * i + 1][2], one[0][0]);
      for (const std::size_t part : {1u, 2u})
        EXPECT_NEAR(std::stod(rows[2 * i + 1][2 + part]), std::stod(one[0][part]), 1e-12 * 1e-3);
      EXPECT_EQ(rows[2 * i + 1][5], one[0][3]);
    }
  }
  // Several contacts in simulate stand beside forces and clearances; with one restitution each tells its own.
  const Json json =
      successful_json(with({"simulate", "--force", "40", "--clearance", "0.3", "--omega", "18,20"},
                           {"--contact-stiffness", "20000,80000", "--contact-damping", "50", "--format", "json"}));
  ASSERT_EQ(json["sweeps"].size(), 2u);
  EXPECT_EQ(json["sweeps"][0]["scene"]["contact_stiffness_n_m"], 20000);
  EXPECT_EQ(json["sweeps"][1]["scene"]["contact_stiffness_n_m"], 80000);
}

TEST(CompliantContacts, RefuseWhatDoesNotGoTogether) {
  const auto refusal = [](const std::vector<std::string>& arguments) {
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 2);
    return result.error;
  };
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  for (const char* command : {"simulate", "history", "map"}) {
    const auto with_options = [&](const std::vector<std::string>& more) { return refusal(compliant(command, more)); };
    expect(with_options({}), "--restitution is missing, or --contact-stiffness or --contact-frequency instead");
    expect(with_options({"--restitution", "0.6", "--contact-stiffness", "1", "--contact-damping", "1"}),
           "give either --restitution, --contact-stiffness or --contact-frequency, not both");
    expect(with_options({"--contact-stiffness", "1"}), "--contact-stiffness needs --contact-damping");
    expect(with_options({"--contact-frequency", "1"}),
           "--contact-frequency needs --contact-ratio or --contact-restitution");
    expect(with_options({"--restitution", "0.6", "--friction1", "1"}), "--friction1 has no meaning with --restitution");
    expect(with_options({"--contact-frequency", "1", "--contact-restitution", "0"}), "--contact-restitution is 0");
    expect(with_options({"--contact-stiffness", "-1", "--contact-damping", "1"}), "--contact-stiffness is -1");
    expect(with_options({"--contact-stiffness", "1", "--contact-damping", "1", "--friction2", "-1"}),
           "friction2 is -1");
  }
  expect(refusal(compliant("simulate",
                           {"--contact-stiffness", "1", "--contact-damping", "1", "--orbit-tolerance", "1e-6"})),
         "--orbit-tolerance has no meaning with --contact-stiffness");
  expect(refusal(compliant("simulate", {"--motion", "static", "--friction1", "1"})), "--friction1 has no meaning");
  expect(refusal(compliant("map", {"--contact-stiffness", "1", "--contact-damping", "1", "--orbit-tolerance", "1e-6"})),
         "--orbit-tolerance has no meaning with --contact-stiffness");
  expect(refusal(compliant("history", {"--contact-stiffness", "1,2", "--contact-damping", "1"})),
         "--contact-stiffness");
  const std::vector<std::string> loop{"loop", "--controller",      "1 + s", "--contact-stiffness",
                                      "100",  "--contact-damping", "1"};
  expect(refusal(with(loop, {"--whole-memory"})), "--whole-memory has no meaning with --contact-stiffness");
  expect(refusal(with(loop, {"--restitution", "0.5"})), "--restitution");
  expect(refusal({"loop", "--controller", "1 + s"}), "--restitution is missing, or --contact-stiffness");
  expect(refusal({"loop", "--controller", "exp(-0.1 s) (1 + s)", "--contact-stiffness", "100", "--contact-damping", "1",
                  "--velocity2", "1"}),
         "dead time of 0.1 s");
  const std::vector<std::string> pushed{"--disturbance1", "0.1", "--sample-time", "0.01", "--duration", "1"};
  EXPECT_EQ(run_fracfit(with(loop, pushed)).code, 0);
  expect(refusal(with({"loop", "--controller", "1 + s", "--restitution", "0.5"}, pushed)),
         "no constant force on body 1");
  const std::vector<std::string> cycles{"limit-cycles", "--controller",      "1 + s", "--contact-stiffness",
                                        "100",          "--contact-damping", "1"};
  expect(refusal(with(cycles, {"--branches"})), "--branches has no meaning with --contact-stiffness");
  expect(refusal(with(cycles, {"--over", "restitution=0.2,0.4"})), "give contact-restitution");
  // The contact is not given by its frequency.
  expect(refusal(with(cycles, {"--over", "contact-frequency=10,20"})), "contact-frequency");
  expect(refusal({"basins", "--omega", "1", "--friction1", "1", "--restitution", "0.5"}),
         "--friction1 has no meaning with --restitution");
  expect(refusal({"tune", "--model", "1/(s + 1)", "--crossover", "1", "--contact-stiffness", "1", "--contact-damping",
                  "1"}),
         "--contact-stiffness has no meaning without --clearance");
  expect(refusal({"tune", "--clearance", "0.1", "--crossover", "1"}),
         "--restitution is missing, or --contact-stiffness or --contact-frequency instead");
  expect(refusal({"export", "fmu", "--contact-stiffness", "1"}), "export fmu does not take --contact-stiffness");
  expect(refusal({"orbits", "--from", "1", "--to", "2"}), "--restitution is missing, or --contact-stiffness");
  expect(refusal({"orbits", "--parameter", "restitution", "--omega", "2", "--from", "0.1", "--to", "0.9",
                  "--contact-stiffness", "100", "--contact-damping", "1"}),
         "must be omega, force, clearance or contact-frequency");
  expect(refusal({"orbits", "--parameter", "contact-frequency", "--omega", "2", "--from", "10", "--to", "20",
                  "--restitution", "0.5"}),
         "contacts with a restitution take no time");
}

// The band and the points are those of the JSON; of 60 s each of three points settles for two cycles, and has a third
// of what is left in whole cycles.
TEST(Contract, StepsOfASineWhereIdentifyAsksForThem) {
  const TemporaryFolder folder;
  const auto asks = folder.write(
      "asks.json",
      R"({"verdict": "undecided", "next_measurement": {"lower": 10, "upper": 40, "points": 3, "accuracy": 0.01, "relative_accuracy": 0.02, "expected_evidence": 12}})");
  const auto csv =
      successful({"multisine", "--next-measurement", asks, "--total-time", "60", "--settling", "2", "--peak", "3"});
  EXPECT_EQ(entry_of(csv, "relative_accuracy"), "0.02");
  const auto rows = rows_of(csv);
  ASSERT_EQ(rows.size(), 3U);
  double settling = 0;
  for (const double omega : {10.0, 20.0, 40.0}) settling += 2 * 2 * std::numbers::pi / omega;
  for (std::size_t i = 0; i < 3; ++i) {
    const double omega = 10 * std::pow(2, i);
    EXPECT_NEAR(std::stod(rows[i][0]), omega, 1e-12 * omega);
    EXPECT_EQ(rows[i][1], "3");
    EXPECT_EQ(rows[i][2], "2");
    EXPECT_EQ(std::stod(rows[i][3]), std::floor((60 - settling) / 3 * omega / (2 * std::numbers::pi)));
  }
  const auto refused = [](const std::vector<std::string>& arguments, int code, const std::string& words) {
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, code);
    EXPECT_NE(result.error.find(words), std::string::npos) << result.error;
  };
  refused({"multisine", "--next-measurement", asks, "--total-time", "5"}, 2, "--total-time is 5 s");
  refused({"multisine", "--next-measurement", asks}, 2, "needs --total-time");
  refused({"multisine", "--band", "1:20", "--sample-time", "0.1"}, 2, "--band needs --period");
  refused({"multisine", "--next-measurement", asks, "--total-time", "60", "--format", "c"}, 2, "--format c");
  const auto decided = folder.write("decided.json", R"({"verdict": "supported", "next_measurement": null})");
  refused({"multisine", "--next-measurement", decided, "--total-time", "60"}, 3, "its verdict is supported");
}

}  // namespace
