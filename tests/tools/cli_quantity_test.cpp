// SPDX-License-Identifier: BSD-3-Clause
// N and -1/N, wherever one of them is written, read and fitted.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;
using Complex = std::complex<double>;
using Row = std::map<std::string, std::string>;

const std::vector<std::string> scene{"--force", "40", "--clearance", "0.3", "--restitution", "0.6"};
// M1 + M2 = 2 kg: Im(-1/N) = (pi/4) (0.4/1.6) 2 omega^2 in the band of two impacts.
constexpr double band_coefficient = std::numbers::pi / 8;

std::vector<std::string> command(const std::string& name, const std::vector<std::string>& more,
                                 const std::vector<std::string>& of_scene = scene) {
  std::vector<std::string> arguments{name};
  arguments.insert(arguments.end(), of_scene.begin(), of_scene.end());
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

ProgramResult successful(const std::vector<std::string>& arguments) {
  auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, 0) << result.error;
  return result;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

std::vector<Row> rows_of(const std::string& csv) {
  std::vector<Row> rows;
  std::vector<std::string> names;
  for (const auto& line : lines_of(csv)) {
    if (line.starts_with('#')) continue;
    const auto fields = fields_of(line);
    if (names.empty()) {
      names = fields;
      continue;
    }
    Row& row = rows.emplace_back();
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = i < fields.size() ? fields[i] : "";
  }
  return rows;
}

double number(const Row& row, const std::string& column) {
  return std::stod(row.at(column));
}
Complex value(const Row& row, const std::string& unit) {
  return {number(row, "re_" + unit), number(row, "im_" + unit)};
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool says(const ProgramResult& result, const std::string& text) {
  return result.error.find(text) != std::string::npos;
}

double parameter(const Json& fit, const std::string& name) {
  for (const auto& each : fit["parameters"])
    if (each["name"] == name) return each["value"].get<double>();
  ADD_FAILURE() << "no parameter " << name;
  return std::numeric_limits<double>::quiet_NaN();
}

TEST(QuantityOption, WritesMinusOneOverNWithItsUncertainty) {
  for (const std::string motion : {"dynamic", "static"}) {
    const auto of_scene = motion == "static" ? std::vector<std::string>{"--force", "40", "--clearance", "0.3"} : scene;
    const auto n = rows_of(successful(command("simulate", {"--omega", "5,8,11", "--motion", motion}, of_scene)).output);
    const auto text =
        successful(
            command("simulate", {"--omega", "5,8,11", "--motion", motion, "--quantity", "minus-inverse"}, of_scene))
            .output;
    EXPECT_NE(text.find("\n# quantity: minus-inverse\n"), std::string::npos);
    const auto inverse = rows_of(text);
    ASSERT_EQ(inverse.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const Complex of_n = value(n[i], "m_per_n");
      // Numbers are written so that they read back; what is left is a quotient.
      EXPECT_LT(std::abs(value(inverse[i], "n_per_m") * of_n + 1.0), 1e-15);
      EXPECT_EQ(n[i].at("regime"), inverse[i].at("regime"));
      // sqrt(40/0.3) rad/s is the unit of frequency, 2 omega^2 that of -1/N.
      const double omega = number(n[i], "omega_rad_s");
      EXPECT_NEAR(number(inverse[i], "frequency_ratio"), omega / std::sqrt(40 / 0.3), 1e-15);
      EXPECT_NEAR(number(inverse[i], "loss_factor"), value(inverse[i], "n_per_m").imag() / (2 * omega * omega), 1e-14);
      if (motion == "static") continue;
      EXPECT_NEAR(number(inverse[i], "uncertainty_n_per_m") / (number(n[i], "uncertainty_m_per_n") / std::norm(of_n)),
                  1, 1e-14);
    }
  }
}

TEST(QuantityOption, WithoutItNothingChanges) {
  const auto plain = successful(command("simulate", {"--omega", "5,20"})).output;
  EXPECT_EQ(plain.find("quantity"), std::string::npos);
  EXPECT_EQ(plain.find("loss_factor"), std::string::npos);
  // Asked for by name, N has the same rows.
  const auto asked = successful(command("simulate", {"--omega", "5,20", "--quantity", "n"})).output;
  EXPECT_EQ(plain.substr(plain.find("\nomega")), asked.substr(asked.find("\nomega")));
}

// x1 stands still above 2 sqrt(F/(M2 Delta)) = 23.1 rad/s where a motion starts between the walls.
TEST(QuantityOption, PointsWithoutMotionHaveNoneAndFitsLeaveThemOut) {
  const std::vector<std::string> grid{"--omega",         "20:26:4",    "--protocol",
                                      "mid-gap-at-rest", "--quantity", "minus-inverse"};
  const auto result = successful(command("simulate", grid));
  EXPECT_TRUE(says(result, "2 of 4 points have no -1/N, as N is 0 there")) << result.error;
  const auto rows = rows_of(result.output);
  ASSERT_EQ(rows.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    for (const char* column : {"re_n_per_m", "im_n_per_m", "uncertainty_n_per_m", "loss_factor"})
      EXPECT_EQ(rows[i].at(column) == "nan", i >= 2) << column;
  }
  const TemporaryFolder folder;
  const auto fit =
      run_fracfit({"fit", folder.write("curve.csv", result.output), "--model", "K s", "--component", "imaginary"});
  EXPECT_TRUE(says(fit, "2 points without -1/N left out, as N is 0 there")) << fit.error;
  EXPECT_EQ(Json::parse(fit.output)["data"]["points"], 2);
  auto json_grid = grid;
  json_grid.insert(json_grid.end(), {"--format", "json"});
  const auto json = Json::parse(successful(command("simulate", json_grid)).output);
  EXPECT_EQ(json["scene"]["quantity"], "minus-inverse");
  EXPECT_TRUE(json["points"][1]["re_n_per_m"].is_number());
  EXPECT_TRUE(json["points"][3]["re_n_per_m"].is_null());
  // Of x2 the mass moves all the same; the loss factor is one of x1.
  auto other = grid;
  other.insert(other.end(), {"--body", "x2"});
  const auto of_x2 = rows_of(successful(command("simulate", other)).output);
  EXPECT_NE(of_x2.back().at("re_n_per_m"), "nan");
  EXPECT_FALSE(of_x2.front().contains("loss_factor"));
  const auto none = run_fracfit(command("simulate", {"--omega", "50,60", "--quantity", "minus-inverse"}));
  EXPECT_EQ(none.code, 1);
  EXPECT_TRUE(says(none, "2 of 2 points have no -1/N")) << none.error;
}

TEST(QuantityOption, AMapInFilesIsThatOfStandardOutput) {
  const std::vector<std::string> arguments{"map",        "--restitution",   "0.3,0.6",    "--omega",      "0.5:5:7",
                                           "--protocol", "mid-gap-at-rest", "--quantity", "minus-inverse"};
  const auto whole = successful(arguments).output;
  const auto rows = rows_of(whole);
  ASSERT_EQ(rows.size(), 14U);
  for (const Row& row : rows) {
    if (row.at("regime") == "free") continue;
    // All of scene and masses is 1: the loss factor is Im(-1/N)/(2 omega^2).
    EXPECT_NEAR(number(row, "loss_factor"), number(row, "im_n_per_m") / (2 * std::pow(number(row, "omega_rad_s"), 2)),
                1e-14);
  }
  const TemporaryFolder folder;
  auto to_file = arguments;
  to_file.insert(to_file.end(), {"--out", folder.path("map.csv")});
  const auto streamed = successful(to_file);
  EXPECT_TRUE(says(streamed, "10 of 14 points have no -1/N")) << streamed.error;
  EXPECT_EQ(text_of(folder.path("map.csv")), whole);
  // Shards join to the same rows.
  for (const std::string part : {"1", "2"}) {
    auto shard = arguments;
    shard.insert(shard.end(), {"--shard", part + "/2", "--out", folder.path(part + ".csv")});
    static_cast<void>(run_fracfit(shard));
  }
  successful({"merge", folder.path("1.csv"), folder.path("2.csv"), "--out", folder.path("joined.csv")});
  EXPECT_EQ(rows_of(text_of(folder.path("joined.csv"))), rows);
}

// Files of N and of -1/N, told by header or by unit, give one fit.
TEST(QuantityOption, AFitTakesEitherFile) {
  const TemporaryFolder folder;
  const std::vector<std::string> grid{"--omega", "19.1:35:40"};
  const auto n = folder.write("n.csv", successful(command("simulate", grid)).output);
  auto inverse_grid = grid;
  inverse_grid.insert(inverse_grid.end(), {"--quantity", "minus-inverse"});
  const auto text = successful(command("simulate", inverse_grid)).output;
  const auto inverse = folder.write("inverse.csv", text);
  // Without the header the unit N/m tells.
  const auto bare = folder.write("bare.csv", text.substr(text.find("\nomega_rad_s") + 1));
  const std::vector<std::string> model{"--model", "M s^2 + c", "--component", "real", "--weight", "relative"};
  const auto fit = [&](const std::string& file, const std::string& quantity) {
    std::vector<std::string> arguments{"fit", file};
    arguments.insert(arguments.end(), model.begin(), model.end());
    if (!quantity.empty()) arguments.insert(arguments.end(), {"--quantity", quantity});
    return Json::parse(successful(arguments).output);
  };
  const auto reference = fit(inverse, "");
  EXPECT_EQ(reference["data"]["value_unit"], "n_per_m");
  for (const auto& other : {fit(n, "minus-inverse"), fit(inverse, "minus-inverse"), fit(bare, "minus-inverse")}) {
    EXPECT_EQ(other["data"]["value_unit"], "n_per_m");
    // The same data but for a rounding of each.
    for (const char* name : {"M", "c"})
      EXPECT_NEAR(parameter(other, name) / parameter(reference, name), 1, 1e-9) << name;
  }
  const auto of_n = fit(n, ""), back = fit(inverse, "n");
  EXPECT_EQ(back["data"]["value_unit"], "m_per_n");
  EXPECT_EQ(back["data"]["header"]["quantity"], "n");
  EXPECT_NEAR(back["cost"].get<double>() / of_n["cost"].get<double>(), 1, 1e-9);
  const auto told = run_fracfit({"fit", n, "--quantity", "minus-inverse", "--model", "K s^a"});
  EXPECT_TRUE(says(told, "values are -1/N of N, which the file holds in m/N")) << told.error;
}

TEST(QuantityOption, ZerosInAFileAreLeftOutAndAWrongWordIsRefused) {
  const TemporaryFolder folder;
  const auto file =
      folder.write("zeros.csv", "omega_rad_s,re_m_per_n,im_m_per_n\n1,0,0\n2,-1,0.5\n3,-0.5,0.25\n4,0,0\n");
  const auto result = run_fracfit({"convert", file, "--quantity", "minus-inverse"});
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_TRUE(says(result, "2 points at which N is 0 left out, as -1/N is infinite there, the first at 1 rad/s"))
      << result.error;
  const auto rows = rows_of(result.output);
  ASSERT_EQ(rows.size(), 2U);
  // -1/(-1 + 0.5 j) = (1 + 0.5 j)/1.25
  EXPECT_LT(std::abs(value(rows[0], "n_per_m") - Complex(0.8, 0.4)), 1e-16);
  const auto all_zero = folder.write("all.csv", "omega_rad_s,re,im\n1,0,0\n2,0,0\n");
  const auto none = run_fracfit({"convert", all_zero, "--quantity", "minus-inverse"});
  EXPECT_EQ(none.code, 3);
  EXPECT_TRUE(says(none, "0 at each of its 2 points")) << none.error;
  const auto header = folder.write("header.csv", "# quantity: 1/n\nomega_rad_s,re,im\n1,1,0\n2,1,0\n");
  const auto refused = run_fracfit({"fit", header, "--model", "K"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_TRUE(says(refused, "quantity \"1/n\": expected one of n, minus-inverse")) << refused.error;
}

// The law of the two-impact band, by the model that says what it is.
TEST(ComponentPowerLaw, FindsTheLawOfTheTwoImpactBand) {
  const TemporaryFolder folder;
  const auto file = folder.write("n.csv", successful(command("simulate", {"--omega", "19.1:35:60"})).output);
  const std::vector<std::string> arguments{
      "fit", file, "--quantity", "minus-inverse", "--model", "component-power-law", "--component", "imaginary"};
  const auto json = Json::parse(successful(arguments).output);
  // Values of -1/N are rounded to some 1e-15 each.
  EXPECT_NEAR(parameter(json, "b"), 2, 1e-12);
  EXPECT_NEAR(parameter(json, "K") / band_coefficient, 1, 1e-11);
  EXPECT_TRUE(json["stability"].is_null());
  EXPECT_NE(json["law"].get<std::string>().find("Im = K omega^b"), std::string::npos);
  // K s^b has nothing of the imaginary part of s^2 and names the model that has.
  auto power = arguments;
  power[5] = "power-law";
  const auto message = Json::parse(successful(power).output)["message"].get<std::string>();
  EXPECT_NE(message.find("whose gain therefore says nothing: component-power-law"), std::string::npos) << message;
  auto table = arguments;
  table.insert(table.end(), {"--format", "table"});
  const auto shown = successful(table).output;
  EXPECT_NE(shown.find("law        Im = K omega^b"), std::string::npos) << shown;
  EXPECT_NE(shown.find("values of -1/N in N/m"), std::string::npos) << shown;
  // The formula is one that evaluates: its imaginary part is the law, its real part nothing.
  const auto fit = folder.write("fit.json", json.dump());
  const auto rows = rows_of(successful({"evaluate", "--fit", fit, "--omega", "20,30", "--format", "csv"}).output);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(std::stod(rows[1].at("re")), 0);
  EXPECT_NEAR(std::stod(rows[1].at("im")) / (band_coefficient * 900), 1, 1e-11);
}

// y = 3 omega^-0.7 (1 + noise), and a real part that has nothing to do with it.
TEST(ComponentPowerLaw, FitsOnePartWhateverTheOther) {
  std::ostringstream stream;
  stream.precision(17);
  stream << "omega_rad_s,re,im\n";
  for (int i = 0; i < 40; ++i) {
    const double omega = 0.1 * std::pow(1.2, i);
    stream << omega << ',' << 100 * std::cos(i) << ',' << -3 * std::pow(omega, -0.7) << '\n';
  }
  const TemporaryFolder folder;
  const auto file = folder.write("part.csv", stream.str());
  const auto fit = [&](const std::string& part) {
    return run_fracfit({"fit", file, "--model", "component-power-law", "--component", part, "--outliers", "keep"});
  };
  const auto json = Json::parse(fit("imaginary").output);
  // Exact data, whose last digit moves both by some roundings.
  EXPECT_NEAR(parameter(json, "b"), -0.7, 1e-12);
  EXPECT_NEAR(parameter(json, "K"), -3, 1e-11);
  const auto both = fit("both");
  EXPECT_EQ(both.code, 2);
  EXPECT_TRUE(says(both, "--component both: component-power-law is a power law of one part")) << both.error;
  const auto elsewhere = run_fracfit({"identify", file, "--models", "component-power-law,gain"});
  EXPECT_EQ(elsewhere.code, 2);
  EXPECT_TRUE(says(elsewhere, "is one of fracfit fit")) << elsewhere.error;
}

TEST(QuantityOption, IdentifyComparesWithTheStaticCurveOfTheSameQuantity) {
  const TemporaryFolder folder;
  // Static data: the candidate of the same quantity meets them exactly.
  const std::vector<std::string> of_scene{"--force", "40", "--clearance", "0.3"};
  const auto data = folder.write(
      "static.csv",
      successful(
          command("simulate", {"--motion", "static", "--omega", "5:11:30", "--quantity", "minus-inverse"}, of_scene))
          .output);
  const auto json = Json::parse(successful({"identify", data, "--models", "power-law,gain"}).output);
  double rms = 1;
  for (const auto& candidate : json["ranking"])
    if (candidate["name"] == "static-backlash") rms = candidate["rms"].get<double>();
  EXPECT_LT(rms, 1e-15);
  // Above 11.547 rad/s the play is not crossed.
  const auto above = folder.write("above.csv", successful(command("simulate", {"--omega", "8:14:30"})).output);
  const auto told = run_fracfit({"identify", above, "--models", "power-law,gain", "--quantity", "minus-inverse"});
  EXPECT_TRUE(says(told, "no static-backlash candidate")) << told.error;
}

TEST(QuantityOption, ASceneIsIdentifiedFromEitherFile) {
  const TemporaryFolder folder;
  const std::vector<std::string> grid{"--omega", "19.1:35:30"};
  auto inverse_grid = grid;
  inverse_grid.insert(inverse_grid.end(), {"--quantity", "minus-inverse"});
  const auto n = folder.write("n.csv", successful(command("simulate", grid)).output);
  const auto inverse = folder.write("inverse.csv", successful(command("simulate", inverse_grid)).output);
  const auto of = [&](const std::string& file) {
    return Json::parse(successful({"identify-scene", file, "--fix", "mass1=1", "--format", "json"}).output);
  };
  const auto one = of(n), other = of(inverse);
  for (std::size_t i = 0; i < one["parameters"].size(); ++i)
    // Exact data, of which each value is rounded twice more.
    EXPECT_NEAR(other["parameters"][i]["value"].get<double>(), one["parameters"][i]["value"].get<double>(), 1e-9);
}

}  // namespace
