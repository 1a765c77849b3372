// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "backlash/sweep_pieces.hpp"
#include "generators.hpp"
#include "io/data_error.hpp"
#include "io/frequency_response_file.hpp"
#include "io/number.hpp"
#include "io/shard.hpp"
#include "io/shard_file.hpp"
#include "io/time_series_file.hpp"
#include "tools/temporary_folder.hpp"

namespace {

using fuzz::Random;

// Runs a reader on a text of whatever kind; true where it took it.  Anything but the documented exceptions ends the
// test.
template <typename Read>
bool takes(const Read& read) {
  try {
    read();
    return true;
  } catch (const io::DataError&) {
  } catch (const std::invalid_argument&) {
  }
  return false;
}

TEST(ReaderFuzz, TablesAreReadAsTheyWereWritten) {
  Random random(fuzz::seed(3));
  const TemporaryFolder folder;
  for (std::size_t i = 0; i < fuzz::cases(1500); ++i) {
    const auto table = fuzz::table(random);
    const auto file = folder.write("table", table.text);
    const auto data = io::read_frequency_response(file).data;
    ASSERT_EQ(data.size(), table.omega.size()) << table.text;
    for (std::size_t k = 0; k < data.size(); ++k) {
      // One product and one trigonometric function of an angle of at most 10 rad, each with its rounding: the angle
      // itself is off by 10 roundings where it went through degrees.
      constexpr double rounding = std::numeric_limits<double>::epsilon();
      ASSERT_NEAR(data.omega()[k], table.omega[k], 2 * rounding * table.omega[k]) << table.text;
      // A level of 200 dB is known to 200/20 ln 10 roundings.
      ASSERT_LE(std::abs(data.value()[k] - table.value[k]), 60 * rounding * std::abs(table.value[k])) << table.text;
    }
  }
}

TEST(ReaderFuzz, DamagedTablesAreReadOrRefused) {
  Random random(fuzz::seed(4));
  const TemporaryFolder folder;
  std::size_t taken = 0;
  for (std::size_t i = 0; i < fuzz::cases(4000); ++i) {
    auto text = fuzz::damaged(random, fuzz::table(random).text);
    if (random.below(3) == 0) text = fuzz::damaged(random, text);
    const auto file = folder.write("table", text);
    io::FrequencyResponseReadOptions options;
    if (random.below(3) == 0) options.where.emplace_back("remark!=some");
    options.phase_may_miss = random.below(2) == 0;
    options.real_may_miss = i % 2 == 0;
    bool read = false;
    ASSERT_NO_THROW(read = takes([&] { static_cast<void>(io::read_frequency_response(file, options)); })) << text;
    taken += read ? 1 : 0;
    ASSERT_NO_THROW(takes([&] { static_cast<void>(io::read_time_response(file)); })) << text;
    ASSERT_NO_THROW(takes([&] { static_cast<void>(io::curve_labels(io::read_measurement(file), "")); })) << text;
    ASSERT_NO_THROW(takes([&] { static_cast<void>(io::scenes_in(io::read_measurement(file))); })) << text;
    ASSERT_NO_THROW(takes([&] { io::join_block_tables({file}, [](std::string_view) {}); })) << text;
  }
  EXPECT_GT(taken, 100U);
}

// The shards of a map, in order, without a computation: the texts alone matter.
std::vector<std::string> shards_of(Random& random, std::size_t count) {
  const std::vector<double> restitutions{0.1, 0.25, 0.5, 0.75, 0.9};
  const std::vector<double> omega{1, 1.5, 2, 2.5, 3, 3.5, 4};
  std::vector<double> cost;
  for (const double restitution : restitutions) cost.push_back(backlash::expected_cost(restitution));
  std::vector<std::string> texts;
  for (std::size_t index = 1; index <= count; ++index) {
    const io::Shard shard{index, count};
    std::string text =
        "# fracfit: 1.0\n# command: fracfit map --force 40 --clearance 0.3 --restitution 0.1,0.25,0.5,0.75,0.9 --omega "
        "1:4:7\n# force_n: 40\n# shard: " +
        io::text_of(shard) + "\nrestitution,omega_rad_s,re_m_per_n,im_m_per_n,regime,period,uncertainty_m_per_n\n";
    for (const double restitution : io::part_of(restitutions, shard, cost)) {
      for (const double each : omega) {
        for (const double number : {restitution, each, random.normal(), random.normal()})
          text += io::format_number(number) + ",";
        text += "periodic," + std::to_string(random.below(9)) + "," + io::format_number(random.unit()) + "\n";
      }
    }
    texts.push_back(text + io::checksum_line(io::Fingerprint(text)));
  }
  return texts;
}

std::string joined(const TemporaryFolder& folder, const std::vector<std::string>& texts) {
  std::vector<std::string> files;
  for (const auto& text : texts) files.push_back(folder.write("shard" + std::to_string(files.size()), text));
  std::string joined;
  io::join_block_tables(files, [&](std::string_view part) { joined += part; });
  return joined;
}

TEST(ReaderFuzz, NoDamagedShardIsAccepted) {
  Random random(fuzz::seed(5));
  const TemporaryFolder folder;
  const auto texts = shards_of(random, 3);
  const std::string whole = joined(folder, texts);
  std::size_t damaged = 0, accepted = 0;
  for (std::size_t i = 0; i < fuzz::cases(3000); ++i) {
    auto some = texts;
    auto& text = some[random.below(some.size())];
    const std::string before = text;
    text = random.below(2) == 0 ? fuzz::cut(random, text) : fuzz::damaged(random, text);
    if (text == before) continue;
    ++damaged;
    std::string result;
    ASSERT_NO_THROW(takes([&] { result = joined(folder, some); })) << text;
    accepted += result.empty() ? 0 : 1;
  }
  RecordProperty("damaged", static_cast<int>(damaged));
  EXPECT_EQ(accepted, 0U) << "of " << damaged;
  // Lines lost, doubled or exchanged, as by a program that copies lines.
  for (std::size_t i = 0; i < fuzz::cases(500); ++i) {
    auto some = texts;
    auto& text = some[random.below(some.size())];
    auto lines = std::vector<std::string>{};
    for (std::size_t begin = 0; begin < text.size(); begin = text.find('\n', begin) + 1)
      lines.push_back(text.substr(begin, text.find('\n', begin) + 1 - begin));
    const std::size_t a = random.below(lines.size()), b = random.below(lines.size());
    if (a == b) lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(a));
    if (a < b) std::swap(lines[a], lines[b]);
    if (a > b) lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(b), lines[a]);
    text = std::accumulate(lines.begin(), lines.end(), std::string());
    std::string result;
    ASSERT_NO_THROW(takes([&] { result = joined(folder, some); })) << text;
    EXPECT_TRUE(result.empty() || result == whole) << text;
  }
}

// A checksum that fits does not save a file with the wrong rows, such as one edited by a program that knows about it.
TEST(ReaderFuzz, RowsAreCheckedAgainstTheGridOfTheCommand) {
  Random random(fuzz::seed(6));
  const TemporaryFolder folder;
  const auto texts = shards_of(random, 2);
  const auto refusal = [&](const std::string& found, const std::string& replacement) {
    auto some = texts;
    for (auto& text : some) {
      const auto at = text.find(found);
      if (at == std::string::npos) continue;
      text.resize(text.rfind("# checksum: "));
      text.replace(at, found.size(), replacement);
      text += io::checksum_line(io::Fingerprint(text));
    }
    try {
      static_cast<void>(joined(folder, some));
    } catch (const io::DataError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  const std::string row = "0.1,1.5,";
  EXPECT_NE(refusal(row, "0.1,1.75,").find("expected a row that begins with '0.1,1.5,'"), std::string::npos);
  EXPECT_NE(refusal(row, "0.2,1.5,").find(":7:"), std::string::npos) << refusal(row, "0.2,1.5,");
  EXPECT_NE(refusal("--omega 1:4:7", "--omega 1:4:8").find("as the grid of the command says"), std::string::npos);
  EXPECT_NE(refusal("--omega 1:4:7", "").find("found no --omega in the command"), std::string::npos);
  EXPECT_NE(refusal(row, "0.1,1.5,x").find("expected a number"), std::string::npos);
  EXPECT_NE(refusal(row, "0.1,1.5,1,").find("fields; expected"), std::string::npos);
  EXPECT_NE(refusal("# shard: 1/2", "# shard: 3/2").find("expected '# shard: i/n'"), std::string::npos);
}

}  // namespace
