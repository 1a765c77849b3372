// SPDX-License-Identifier: BSD-3-Clause
// Results against their description: what `fracfit describe` says is what JSON holds, no more and no less.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;

Json successful(const std::vector<std::string>& arguments) {
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, 0) << result.error;
  return Json::parse(result.output);
}

/// Kinds by key, of each result.
std::map<std::string, std::map<std::string, std::string>> described() {
  std::map<std::string, std::map<std::string, std::string>> results;
  const Json all = successful({"describe", "--format", "json"});
  for (const auto& row : all["rows"])
    EXPECT_TRUE(results[row["result"]].emplace(row["key"], row["kind"]).second) << row;
  return results;
}

bool is_of_kind(const Json& value, const std::string& kind) {
  if (kind == "flag") return value.is_boolean();
  if (kind == "count") return value.is_number_integer();
  if (kind == "text") return value.is_string();
  if (kind == "number") return value.is_number() || value.is_null();
  if (kind.starts_with("list") || kind == "complex number") return value.is_array();
  return kind.starts_with("pair") || kind.ends_with("or nothing") || value.is_object();
}

/// @param elsewhere  described keys that this object has not
/// @param around     keys of the object that are no numbers of the result
void expect_is(const Json& object, const std::map<std::string, std::string>& description,
               const std::set<std::string>& elsewhere = {}, const std::set<std::string>& around = {}) {
  for (const auto& [key, kind] : description) {
    EXPECT_NE(object.contains(key), elsewhere.contains(key)) << key;
    if (object.contains(key)) {
      EXPECT_TRUE(is_of_kind(object[key], kind)) << key << " is no " << kind << ": " << object[key];
    }
  }
  for (const auto& [key, value] : object.items()) EXPECT_TRUE(description.contains(key) || around.contains(key)) << key;
}

const std::string examples = FRACFIT_SOURCE_DIR "/data/examples/";

TEST(Describe, HasTheNumbersOfAFit) {
  auto results = described();
  const Json fit = successful({"fit", examples + "cell.csv", "--model", "zarc", "--prior", "R0=0.02+-50%", "--derive",
                               "f1 = (R1 Q1)^(-1/n1)/(2 pi)", "--format", "json"});
  // The correlation stands for the covariance; input before a record is of fits over time.
  expect_is(fit, results["fit"], {"covariance", "earlier_input"},
            {"fracfit", "command", "data", "options", "assumptions", "validity", "stability", "correlation",
             "lack_of_fit", "whiteness", "derived"});
  for (const auto& parameter : fit["parameters"]) expect_is(parameter, results["parameter"], {}, {"unit"});
  expect_is(fit["priors"].at(0), results["prior"]);
  expect_is(fit["derived"].at(0), results["derived"]);
  expect_is(fit["lack_of_fit"], results["lack-of-fit"]);
}

TEST(Describe, HasTheNumbersOfARanking) {
  auto results = described();
  const Json ranking = successful({"identify", examples + "cell.csv", "--models", "zarc,two-rc", "--format", "json"});
  expect_is(ranking, results["identification"], {},
            {"fracfit", "command", "data", "options", "assumptions", "set_aside", "validity", "chosen", "stability",
             "fractional", "integer", "differ_most", "next_measurement", "distribution", "economy"});
  auto candidate = results["candidate"];
  candidate.merge(results["fit"]);
  for (const auto& each : ranking["ranking"])
    expect_is(each, candidate, {"fit", "covariance", "earlier_input", "outliers", "priors"});
  expect_is(ranking["fractional"], results["finalist"], {}, {"name"});
}

TEST(Describe, HasTheNumbersOfAScene) {
  auto results = described();
  const Json scene = successful({"identify-scene", examples + "f40.csv", "--fix", "mass1=1", "--format", "json"});
  expect_is(scene, results["scene"], {}, {"fracfit", "command", "data", "options"});
  expect_is(scene["parameters"].at(0), results["scene-estimate"]);
  expect_is(scene["points"].at(0), results["scene-point"]);
}

TEST(Describe, HasTheNumbersOfAnEconomy) {
  auto results = described();
  TemporaryFolder folder;
  const std::string file = folder.path("exact.csv");
  ASSERT_EQ(run_fracfit({"evaluate", "1/(0.5 s^0.7 + 1)", "--omega", "0.1:100:20log", "--out", file}).code, 0);
  const Json economy = successful({"identify", file, "--models", "fractional-lag,lag", "--format", "json"})["economy"];
  expect_is(economy, results["economy"]);
  expect_is(economy["curves"].at(0), results["economy-curve"]);
  expect_is(economy["curves"].at(0)["points"].at(0), results["economy-point"]);
}

TEST(Describe, HasTheNumbersOfALimitCycle) {
  auto results = described();
  const Json loop = successful({"limit-cycles", "--controller", "1 + s^0.5 + 0.3/s^0.6", "--restitution", "0.6",
                                "--starts", "0", "--format", "json"});
  const Json& cycle = loop["cycles"].at(0);
  expect_is(cycle, results["limit-cycle"], {}, {"describing_function"});
  expect_is(cycle["harmonics"].at(0), results["cycle-harmonic"]);
  expect_is(loop["predictions"].at(0), results["predicted-cycle"]);
}

TEST(Describe, SaysUnitAndMeaningOfEach) {
  const std::set<std::string> units{"",    "1",   "s",         "kg",    "m",        "m/N",        "N",
                                    "m/s", "N s", "parameter", "rad/s", "residual", "residual^2", "value"};
  const auto results = described();
  const std::regex reference("see ([a-z-]+)");
  const Json all = successful({"describe", "--format", "json"});
  ASSERT_GT(all["rows"].size(), 100U);
  for (const auto& row : all["rows"]) {
    const std::string meaning = row["meaning"];
    EXPECT_TRUE(units.contains(row["unit"])) << row;
    EXPECT_FALSE(meaning.empty() || meaning.ends_with(".")) << row;
    std::smatch found;
    if (std::regex_search(meaning, found, reference)) {
      EXPECT_TRUE(results.contains(found[1])) << row;
    }
  }
  EXPECT_EQ(run_fracfit({"describe", "fits"}).code, 2);
}

}  // namespace
