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

// The record of a rig: no sensor errors, so that it is the motion itself; at one frequency that of the rows of events.
TEST(History, WritesTheRecordOfARig) {
  const std::vector<std::string> scene{"history", "--force",   "40",  "--clearance", "0.3", "--restitution",
                                       "0.6",     "--periods", "3",   "--skip",      "50",  "--omega",
                                       "20",      "--format",  "json"};
  auto sampled = scene, with_rows = scene;
  // Ten samples per period.
  sampled.insert(sampled.end(), {"--sample-time", "0.031415926535897934"});
  with_rows.insert(with_rows.end(), {"--samples", "10"});
  const auto record = run_fracfit(sampled), rows = run_fracfit(with_rows);
  ASSERT_EQ(record.code, 0) << record.error;
  const auto found = nlohmann::json::parse(record.output), exact = nlohmann::json::parse(rows.output);
  std::vector<nlohmann::json> samples;
  for (const auto& row : exact["rows"])
    if (row["event"] == "sample") samples.push_back(row);
  // The last sample falls on the end or just behind it.
  ASSERT_GE(found["rows"].size(), 30U);
  for (std::size_t i = 0; i < 30; ++i) {
    const auto& row = found["rows"][i];
    EXPECT_NEAR(row["time_s"].get<double>(), samples[i]["time_s"].get<double>(), 1e-12);
    EXPECT_NEAR(row["force_n"].get<double>(), 40 * std::cos(20 * row["time_s"].get<double>()), 1e-10);
    EXPECT_NEAR(row["x1_m"].get<double>(), samples[i]["x1_m"].get<double>(), 1e-11);
    EXPECT_NEAR(row["x2_m"].get<double>(), samples[i]["x2_m"].get<double>(), 1e-11);
  }
}

// Each sensor error alone has the effect that its name says; the library's test has their distributions.
TEST(History, SensorsOfARigErr) {
  const auto rows_with = [](const std::vector<std::string>& more) {
    std::vector<std::string> words{"history", "--restitution", "0.6",  "--omega",  "0.8", "--periods",
                                   "3",       "--sample-time", "0.05", "--format", "json"};
    words.insert(words.end(), more.begin(), more.end());
    const auto result = run_fracfit(words);
    EXPECT_EQ(result.code, 0) << result.error;
    return nlohmann::json::parse(result.output)["rows"];
  };
  const auto exact = rows_with({});
  const auto rms = [&](const nlohmann::json& rows, const char* column, std::size_t later = 0) {
    double sum = 0;
    const std::size_t count = std::min(rows.size(), exact.size() - later);
    for (std::size_t i = 0; i < count; ++i)
      sum += std::pow(rows[i][column].get<double>() - exact[i + later][column].get<double>(), 2);
    return std::sqrt(sum / static_cast<double>(count));
  };
  // 471 samples: their mean square scatters by sqrt(2/471), 6.5 %.
  EXPECT_NEAR(rms(rows_with({"--sensor-noise", "0.01"}), "x1_m"), 0.01, 0.002);
  EXPECT_EQ(rms(rows_with({"--sensor-noise", "0.01"}), "force_n"), 0);
  EXPECT_NEAR(rms(rows_with({"--force-noise", "0.1"}), "force_n"), 0.1, 0.02);
  EXPECT_EQ(rms(rows_with({"--force-noise", "0.1"}), "x2_m"), 0);
  EXPECT_NEAR(rms(rows_with({"--quantisation", "0.05"}), "x2_m"), 0.05 / std::sqrt(12.0), 0.003);
  for (const auto& row : rows_with({"--clip", "0.2"})) EXPECT_LE(std::abs(row["x1_m"].get<double>()), 0.2);
  // Two samples late; the record begins where the first reading is.
  const auto late = rows_with({"--sensor-delay", "0.1"});
  EXPECT_NEAR(late[0]["time_s"].get<double>(), 0.1, 1e-12);
  EXPECT_LT(rms(late, "x1_m"), 1e-6);
  EXPECT_NEAR(late[0]["force_n"].get<double>(), exact[2]["force_n"].get<double>(), 1e-9);
  // sin of the force under jitter j: j w/sqrt(2).
  const auto jitter = rows_with({"--clock-jitter", "0.004"});
  EXPECT_NEAR(jitter[0]["time_s"].get<double>(), 0.05, 1e-12);
  EXPECT_NEAR(rms(jitter, "force_n", 1), 0.004 * 0.8 / std::sqrt(2.0), 0.0004);
  EXPECT_EQ(rows_with({"--sensor-noise", "1", "--seed", "7"}), rows_with({"--sensor-noise", "1", "--seed", "7"}));
  EXPECT_NE(rows_with({"--sensor-noise", "1", "--seed", "7"}), rows_with({"--sensor-noise", "1", "--seed", "8"}));
}

TEST(History, SaysWhatIsWrongWithARecord) {
  const auto refused = [](const std::vector<std::string>& more, const std::string& part) {
    std::vector<std::string> words{"history", "--restitution", "0.6"};
    words.insert(words.end(), more.begin(), more.end());
    const auto result = run_fracfit(words);
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  refused({"--omega", "1,2"}, "--sample-time for a record");
  refused({"--omega", "2", "--clip", "1"}, "--clip");
  refused({"--omega", "2", "--sample-time", "0"}, "--sample-time 0");
  refused({"--omega", "2", "--sample-time", "0.1", "--samples", "20"}, "--samples");
  refused({"--omega", "2", "--sample-time", "0.1", "--sensor-noise", "-1"}, "--sensor-noise -1");
  refused({"--omega", "2", "--sample-time", "0.1", "--clip", "0"}, "--clip 0: allowed is a finite number above 0");
  refused({"--omega", "2", "--sample-time", "0.1", "--clock-jitter", "0.05"}, "--clock-jitter is 0.05");
  refused({"--omega", "2", "--sample-time", "1e-9"}, "expected 1 to 1e7");
  refused({"--omega", "2,3", "--sample-time", "0.1", "--periods", "1e6"}, "--periods");
  refused({"--omega", "2", "--sample-time", "0.1", "--sensor-delay", "1e9"}, "0 samples after delay");
}

// The samples of a record of a loop are among the rows of that loop, and its sensors err as those of history do.
TEST(Loop, WritesTheRecordOfARig) {
  const auto rows_with = [](const std::vector<std::string>& more) {
    std::vector<std::string> words{"loop", "--controller", "2 + s", "--restitution", "0.6",  "--velocity2",
                                   "0.93", "--duration",   "20",    "--every",       "0.05", "--format",
                                   "json"};
    words.insert(words.end(), more.begin(), more.end());
    const auto result = run_fracfit(words);
    EXPECT_EQ(result.code, 0) << result.error;
    return nlohmann::json::parse(result.output)["rows"];
  };
  const auto record = rows_with({"--record"}), all = rows_with({}),
             noisy = rows_with({"--record", "--sensor-noise", "0.01", "--force-noise", "0.1"});
  std::vector<nlohmann::json> samples;
  for (const auto& row : all)
    if (row["event"] == "sample") samples.push_back(row);
  ASSERT_GE(record.size(), 400U);
  double squares = 0;
  for (std::size_t i = 0; i < 400; ++i) {
    for (const char* column : {"time_s", "force_n", "x1_m", "x2_m"})
      EXPECT_NEAR(record[i][column].get<double>(), samples[i][column].get<double>(), 1e-9) << i << column;
    squares += std::pow(noisy[i]["x1_m"].get<double>() - record[i]["x1_m"].get<double>(), 2);
  }
  // The mean of 400 squares scatters by sqrt(2/400), 7 %.
  EXPECT_NEAR(std::sqrt(squares / 400), 0.01, 0.0015);
  // The set-point stands beside them where a sine or a file drives it.
  EXPECT_FALSE(record[0].contains("reference_m"));
  const auto driven = rows_with({"--record", "--setpoint-sine", "0.5:3"});
  // Straight between rows, eight of a sample: (3 x 0.05/8)^2/8 of the amplitude.
  for (const auto& row : driven)
    EXPECT_NEAR(row["reference_m"].get<double>(), 0.5 * std::sin(3 * row["time_s"].get<double>()), 3e-5);
  const auto instant = run_fracfit({"loop", "--controller", "2 + s", "--restitution", "0.6", "--velocity2", "1",
                                    "--every", "0.1", "--duration", "1e-9", "--record"});
  EXPECT_EQ(instant.code, 2);
  EXPECT_NE(instant.error.find("--duration 1e-9: shorter than"), std::string::npos) << instant.error;
  const auto refused = run_fracfit({"loop", "--controller", "2 + s", "--restitution", "0.6", "--sensor-noise", "1"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.error.find("--record"), std::string::npos) << refused.error;
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
