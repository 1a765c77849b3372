// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

std::vector<std::string> orbits(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"orbits", "--restitution", "0.6"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(Orbits, WritesBranchesWithStabilityAndBifurcations) {
  const auto result = run_fracfit(orbits({"--from", "1.3", "--to", "2.5", "--format", "json"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["scene"]["restitution"], 0.6);
  bool breaking = false;
  bool doubling = false;
  bool stable = false;
  bool unstable = false;
  for (const auto& branch : json["branches"]) {
    for (const auto& orbit : branch["orbits"]) {
      (orbit["stable"].get<bool>() ? stable : unstable) = true;
      // Losses take energy from the force: Im N1 > 0.
      EXPECT_GT(orbit["im_m_per_n"].get<double>(), 0);
      EXPECT_EQ(orbit["impacts"].size(),
                std::lround(branch["impacts_per_period"].get<double>() * branch["period"].get<int>()));
    }
    if (branch["period"] != 1 || branch["impacts_per_period"] != 2) continue;
    for (const auto& point : branch["bifurcations"]) {
      // gamma = 1/omega^2 of the pitchfork, tabled to ten digits, and of the period doubling.
      const double gamma = std::pow(point["omega_rad_s"].get<double>(), -2);
      breaking = breaking || (point["kind"] == "symmetry-breaking" && std::abs(gamma - 0.3660699362) < 6e-11);
      doubling = doubling || (point["kind"] == "period-doubling" && std::abs(gamma - 0.5042444674) < 6e-11);
    }
  }
  EXPECT_TRUE(breaking && doubling && stable && unstable);
}

TEST(Orbits, CsvRowsHoldTheSameInTheOrderOfTheBranch) {
  const auto result = run_fracfit(orbits(
      {"--from", "16", "--to", "20", "--force", "40", "--clearance", "0.3", "--mass1", "2", "--longest-period", "1"}));
  ASSERT_EQ(result.code, 0) << result.error;
  std::istringstream lines(result.output);
  std::string line;
  std::size_t commas = 0;
  int orbit_rows = 0;
  int bifurcation_rows = 0;
  bool scene = false;
  while (std::getline(lines, line)) {
    if (line[0] == '#') {
      scene = scene || line == "# mass1_kg: 2";
      continue;
    }
    const auto count = static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
    if (commas == 0) {
      commas = count;
      EXPECT_EQ(line.substr(0, 24), "branch,kind,omega_rad_s,");
      continue;
    }
    EXPECT_EQ(count, commas) << line;
    (line.find(",orbit,") != std::string::npos ? orbit_rows : bifurcation_rows) += 1;
  }
  EXPECT_TRUE(scene);
  EXPECT_GT(orbit_rows, 20);
  EXPECT_GE(bifurcation_rows, 2);
}

TEST(Orbits, NoOrbitIsNoUsableResult) {
  // Above the saddle-node, c_sn = 3.567, nothing is left but free motion.
  const auto result = run_fracfit(orbits({"--from", "30", "--to", "40", "--longest-period", "1"}));
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.error.find("no periodic orbit"), std::string::npos) << result.error;
}

TEST(Orbits, WrongUsageIsNamed) {
  const auto expect_usage = [](const std::vector<std::string>& arguments, const std::string& part) {
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.output, "");
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect_usage(orbits({"--from", "1"}), "--to");
  expect_usage(orbits({"--from", "2", "--to", "1"}), "omega_from");
  expect_usage(orbits({"--from", "1", "--to", "2", "--clearance", "0"}), "clearance");
  expect_usage(orbits({"--from", "1", "--to", "2", "--most-impacts", "1"}), "--most-impacts");
  expect_usage(orbits({"--from", "1", "--to", "2", "--most-impacts", "99999"}), "--most-impacts");
  expect_usage({"orbits", "--restitution", "1.5", "--from", "1", "--to", "2"}, "restitution");
}

TEST(Orbits, HoldsAllButWhatChanges) {
  const auto result = run_fracfit(
      {"orbits", "--parameter", "force", "--restitution", "0.6", "--omega", "1", "--from", "0.2", "--to", "0.6"});
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.output.find("\nbranch,kind,force_n,"), std::string::npos);
  EXPECT_EQ(result.output.find("--force"), std::string::npos);
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& name) {
    const auto answer = run_fracfit(arguments);
    EXPECT_EQ(answer.code, 2);
    EXPECT_NE(answer.error.find(name), std::string::npos) << answer.error;
    EXPECT_EQ(answer.output, "");
  };
  refused({"orbits", "--parameter", "force", "--force", "3", "--restitution", "0.6", "--omega", "1", "--from", "0.2",
           "--to", "0.6"},
          "--force has no meaning with --parameter force, which is what changes");
  refused({"orbits", "--parameter", "restitution", "--restitution", "0.6", "--omega", "1", "--from", "0", "--to", "1"},
          "--restitution has no meaning with --parameter restitution, which is what changes");
  refused({"orbits", "--parameter", "force", "--restitution", "0.6", "--from", "0.2", "--to", "0.6"},
          "--parameter force needs --omega");
}

}  // namespace
