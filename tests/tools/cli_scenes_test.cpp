// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

std::vector<std::string> simulate(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"simulate", "--clearance", "0.1:0.3:2",  "--restitution",
                                     "0.6",      "--omega",     "5:35:12log", "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::vector<std::string> rows_of(const std::string& csv) {
  std::vector<std::string> rows;
  bool has_columns = false;
  for (const std::string& line : lines_of(csv)) {
    if (line.starts_with("#")) continue;
    if (has_columns) rows.push_back(line);
    has_columns = true;
  }
  return rows;
}

TEST(Scenes, EveryCombinationIsWhatItIsAlone) {
  const auto result = run_fracfit(simulate({"--force", "20:40:2"}));
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.output.find("\nforce_n,clearance_m,restitution,omega_rad_s,re_m_per_n,im_m_per_n,regime,"),
            std::string::npos);
  std::vector<std::string> expected;
  for (const std::string force : {"20", "40"}) {
    for (const std::string clearance : {"0.1", "0.3"}) {
      const auto alone = run_fracfit({"simulate", "--force", force, "--clearance", clearance, "--restitution", "0.6",
                                      "--omega", "5:35:12log", "--quiet"});
      ASSERT_EQ(alone.code, 0) << alone.error;
      for (const std::string& row : rows_of(alone.output)) expected.push_back(force + "," + clearance + ",0.6," + row);
    }
  }
  EXPECT_EQ(rows_of(result.output), expected);
}

TEST(Scenes, JsonHoldsOneSweepPerScene) {
  const auto result = run_fracfit(simulate({"--force", "20:40:2", "--format", "json"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto sweeps = nlohmann::json::parse(result.output)["sweeps"];
  ASSERT_EQ(sweeps.size(), 4u);
  EXPECT_EQ(sweeps[1]["scene"]["force_n"], 20);
  EXPECT_EQ(sweeps[1]["scene"]["clearance_m"], 0.3);
  EXPECT_EQ(sweeps[3]["points"].size(), 12u);
}

TEST(Scenes, ShardsJoinToTheWhole) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
    auto arguments = simulate({"--force", "20,30,40", "--out", folder.path(name)});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = run_fracfit(arguments);
    ASSERT_EQ(result.code, 0) << result.error;
  };
  run("whole.csv", {});
  run("1.csv", {"--shard", "1/4"});
  run("2.csv", {"--shard", "2/4"});
  run("3.csv", {"--shard", "3/4"});
  run("4.csv", {"--shard", "4/4"});
  const auto joined = run_fracfit({"merge", "--out", folder.path("joined.csv"), folder.path("4.csv"),
                                   folder.path("1.csv"), folder.path("3.csv"), folder.path("2.csv")});
  ASSERT_EQ(joined.code, 0) << joined.error;
  EXPECT_EQ(content_of(folder.path("joined.csv")), content_of(folder.path("whole.csv")));
  const auto missing =
      run_fracfit({"merge", "--out", "-", folder.path("1.csv"), folder.path("2.csv"), folder.path("4.csv")});
  EXPECT_EQ(missing.code, 3);
  EXPECT_NE(missing.error.find("shard 3/4 is missing"), std::string::npos) << missing.error;
}

TEST(Scenes, ASingleCurveIsNoShard) {
  const TemporaryFolder folder;
  const auto single = run_fracfit({"simulate", "--force", "40", "--clearance", "0.3", "--restitution", "0.6", "--omega",
                                   "5:35:3", "--out", folder.path("single.csv")});
  ASSERT_EQ(single.code, 0) << single.error;
  const auto result = run_fracfit({"merge", "--out", "-", folder.path("single.csv")});
  EXPECT_EQ(result.code, 3);
  EXPECT_NE(result.error.find("holds a single curve"), std::string::npos) << result.error;
}

TEST(Scenes, SaysWhatIsWrong) {
  for (const auto& [more, part] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--force", "20,40,20"}, "--force '20,40,20': holds 20 twice"},
           {{"--force", "20,5"}, "--force '20,5': expected one number with a decimal point"},
           {{"--force", "20,30,-1"}, "--force is -1"},
           {{"--force", "1:2:1e7"}, "expected at most 10000000"},
           {{"--force", "20", "--shard", "3/2"}, "--shard"},
           {{"--force", "20", "--shard", "1/2", "--format", "json"}, "--shard has no meaning with --format json"}}) {
    const auto result = run_fracfit(simulate(more));
    EXPECT_EQ(result.code, 2) << part;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  }
}

}  // namespace
