// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

TEST(History, WritesBothMassesWithImpactsFlagged) {
  const auto result = run_fracfit({"history", "--force", "40", "--clearance", "0.3", "--restitution", "0.6", "--omega",
                                   "20", "--skip", "200", "--periods", "2", "--samples", "5"});
  ASSERT_EQ(result.code, 0) << result.error;
  std::istringstream lines(result.output);
  int samples = 0;
  int impacts = 0;
  bool has_columns = false;
  for (std::string line; std::getline(lines, line);) {
    if (line[0] == '#') continue;
    if (!has_columns) {
      EXPECT_EQ(line, "time_s,x1_m,v1_m_s,x2_m,v2_m_s,event,contact");
      has_columns = true;
      continue;
    }
    samples += line.find(",sample,none") != std::string::npos ? 1 : 0;
    impacts += line.find(",after-impact,") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(samples, 11);  // five per period and the end
  EXPECT_EQ(impacts, 4);   // two per period on the symmetric orbit
}

TEST(History, SaysWhatIsWrong) {
  for (const auto& [option, value, part] :
       std::vector<std::tuple<std::string, std::string, std::string>>{{"--periods", "0", "--periods"},
                                                                      {"--samples", "99999999999", "--samples"},
                                                                      {"--samples", "2.5e6", "at most 10000000"},
                                                                      {"--skip", "1.5", "--skip '1.5'"},
                                                                      {"--position", "2", "start.position is 2"},
                                                                      {"--velocity", "fast", "--velocity"}}) {
    const auto result = run_fracfit({"history", "--restitution", "0.6", "--omega", "2", option, value});
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  }
}

TEST(Basins, ListsAttractorsAndTheirStarts) {
  const std::vector<std::string> scene{"basins",     "--restitution", "0.6",        "--omega", "1.41",
                                       "--position", "0:1:11",        "--velocity", "-1:1:9"};
  auto with_json = scene;
  with_json.insert(with_json.end(), {"--format", "json"});
  const auto result = run_fracfit(with_json);
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = nlohmann::json::parse(result.output);
  ASSERT_EQ(json["attractor"].size(), 99u);
  double share = 0;
  for (const auto& attractor : json["attractors"]) {
    EXPECT_EQ(attractor["regime"], "periodic");
    share += attractor["share"].get<double>();
  }
  EXPECT_NEAR(share, 1, 1e-12);
  const auto table = run_fracfit(scene);
  ASSERT_EQ(table.code, 0) << table.error;
  EXPECT_NE(table.output.find("# attractor 0: share "), std::string::npos);
  EXPECT_NE(table.output.find("position_m,velocity_m_s,attractor\n0,-1,"), std::string::npos);
}

// In the picture for people each line is a position, the highest first, and each character the motion of one start.
TEST(Basins, ThePictureShowsEachStart) {
  const std::vector<std::string> scene{"basins",     "--restitution", "0.6",        "--omega", "1.41",
                                       "--position", "0:1:11",        "--velocity", "-1:1:9"};
  auto with_json = scene, as_table = scene;
  with_json.insert(with_json.end(), {"--format", "json"});
  as_table.insert(as_table.end(), {"--format", "table"});
  const auto json = nlohmann::json::parse(run_fracfit(with_json).output);
  std::istringstream lines(run_fracfit(as_table).output);
  std::string line;
  while (std::getline(lines, line) && !line.starts_with("start at position")) {
  }
  std::getline(lines, line);
  for (std::size_t row = 11; row-- > 0;) {
    ASSERT_TRUE(std::getline(lines, line));
    std::string expected;
    for (std::size_t column = 0; column < 9; ++column)
      expected += std::to_string(json["attractor"][row * 9 + column].get<int>());
    EXPECT_EQ(line.substr(line.rfind(' ') + 1), expected) << row;
  }
}

// Without loss of energy the map of impacts keeps areas, so that no motion attracts others.
TEST(Basins, CallsNothingAnAttractorWhereNoEnergyIsLost) {
  std::vector<std::string> scene{"basins",     "--restitution", "1",          "--omega", "1.41",
                                 "--position", "0.2,0.4",       "--velocity", "0,0.5"};
  const auto table = run_fracfit(scene);
  ASSERT_EQ(table.code, 0) << table.error;
  EXPECT_NE(table.error.find("nothing attracts"), std::string::npos) << table.error;
  EXPECT_EQ(table.output.find("attractor"), std::string::npos) << table.output;
  EXPECT_NE(table.output.find("# motion 0: share "), std::string::npos);
  EXPECT_NE(table.output.find("position_m,velocity_m_s,motion\n0.2,0,"), std::string::npos);
  scene.insert(scene.end(), {"--format", "json"});
  const auto json = nlohmann::json::parse(run_fracfit(scene).output);
  EXPECT_FALSE(json.contains("attractors"));
  EXPECT_EQ(json["motion"].size(), 4u);
  EXPECT_FALSE(json["motions"].empty());
}

}  // namespace
