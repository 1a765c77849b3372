// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

std::vector<std::string> map(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"map",     "--force",    "40",        "--clearance", "0.3",
                                     "--omega", "5:35:12log", "--threads", "2",           "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(Map, WritesARowPerPointWithScene) {
  const auto result = run_fracfit(map({"--restitution", "0.2,0.6"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto lines = lines_of(result.output);
  std::size_t rows = 0;
  bool has_columns = false;
  for (const std::string& line : lines) {
    if (line.starts_with("# ")) continue;
    if (!has_columns) {
      EXPECT_EQ(line,
                "restitution,omega_rad_s,re_m_per_n,im_m_per_n,regime,period,impacts_per_period,uncertainty_m_per_n,"
                "third_harmonic_ratio,even_harmonic_ratio,energy_defect,lyapunov_exponent,periods_followed,transient_possible,"
                "force_sensitivity");
      has_columns = true;
      continue;
    }
    EXPECT_TRUE(line.starts_with(rows < 12 ? "0.2," : "0.6,")) << line;
    ++rows;
  }
  EXPECT_EQ(rows, 24u);
  EXPECT_NE(result.output.find("# force_n: 40\n"), std::string::npos);
  EXPECT_NE(result.output.find("--mean-tolerance 0.01"), std::string::npos);
}

TEST(Map, ARowIsWhatSimulateGivesWithFullMeans) {
  const auto result = run_fracfit(map({"--restitution", "0.6", "--mean-tolerance", "0"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto sweep = run_fracfit({"simulate", "--force", "40", "--clearance", "0.3", "--restitution", "0.6", "--omega",
                                  "5:35:12log", "--diagnostics"});
  ASSERT_EQ(sweep.code, 0) << sweep.error;
  const auto rows = lines_of(result.output);
  const auto expected = lines_of(sweep.output);
  ASSERT_GT(rows.size(), 12u);
  for (std::size_t i = 1; i <= 12; ++i) EXPECT_EQ(rows[rows.size() - i], "0.6," + expected[expected.size() - i]);
}

TEST(Map, ShardsJoinToTheWholeInAnyOrder) {
  const TemporaryFolder folder;
  const std::vector<std::string> grid{"--restitution", "0.1:0.9:5"};
  const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
    auto arguments = map(grid);
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.insert(arguments.end(), {"--out", folder.path(name)});
    const auto result = run_fracfit(arguments);
    ASSERT_EQ(result.code, 0) << result.error;
  };
  run("whole.csv", {});
  run("1.csv", {"--shard", "1/3"});
  run("2.csv", {"--shard", "2/3"});
  run("3.csv", {"--shard", "3/3"});
  const auto joined = run_fracfit(
      {"merge", "--out", folder.path("joined.csv"), folder.path("3.csv"), folder.path("1.csv"), folder.path("2.csv")});
  ASSERT_EQ(joined.code, 0) << joined.error;
  EXPECT_EQ(content_of(folder.path("joined.csv")), content_of(folder.path("whole.csv")));

  const auto missing = run_fracfit({"merge", "--out", "-", folder.path("1.csv"), folder.path("3.csv")});
  EXPECT_EQ(missing.code, 3);
  EXPECT_NE(missing.error.find("shard 2/3 is missing"), std::string::npos) << missing.error;
  const auto twice = run_fracfit({"merge", "--out", "-", folder.path("1.csv"), folder.path("1.csv")});
  EXPECT_EQ(twice.code, 3);
  EXPECT_NE(twice.error.find("shard 1"), std::string::npos) << twice.error;
  run("other.csv", {"--shard", "2/3", "--protocol", "sweep-down"});
  const auto other = run_fracfit({"merge", "--out", "-", folder.path("1.csv"), folder.path("other.csv")});
  EXPECT_EQ(other.code, 3);
  EXPECT_NE(other.error.find("another command"), std::string::npos) << other.error;
}

TEST(Map, SaysWhatIsWrong) {
  for (const auto& [more, part] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--restitution", "0.2,1.5"}, "restitution[1] is 1.5"},
           {{"--restitution", "0.2", "--shard", "2/2"}, "only 1 restitutions"},
           {{"--restitution", "0.2", "--shard", "3/2"}, "--shard"},
           {{"--restitution", "0.2", "--mean-tolerance", "2"}, "--mean-tolerance"},
           {{"--restitution", "0.2", "--protocol", "sideways"}, "sideways"},
           {{}, "--restitution"}}) {
    const auto result = run_fracfit(map(more));
    EXPECT_EQ(result.code, 2) << part;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  }
}

}  // namespace
