// SPDX-License-Identifier: BSD-3-Clause
#include "io/number_list.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

namespace {

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST(NumberList, CommaListsKeepTheirOrder) {
  EXPECT_EQ(io::parse_list("10,20, 5", "--force"), (std::vector<double>{10, 20, 5}));
  EXPECT_EQ(io::parse_list("-1e-3", "--force"), (std::vector<double>{-1e-3}));
}

TEST(NumberList, ErrorsNameQuantityTextAndEntry) {
  const std::string message = message_of([] { (void)io::parse_list("1,abc", "--force"); });
  EXPECT_NE(message.find("--force"), std::string::npos) << message;
  EXPECT_NE(message.find("'abc' (entry 2)"), std::string::npos) << message;
  for (const char* text : {"", " ", ",", "1,", "1,,2", "nan", "inf", "1e400", "1;2"})
    EXPECT_THROW((void)io::parse_list(text, "--force"), std::invalid_argument) << text;
}

TEST(NumberGrid, LinearGridsHaveEqualStepsAndExactEnds) {
  const auto grid = io::parse_grid("0.1:0.7:7", "--omega");
  ASSERT_EQ(grid.size(), 7U);
  EXPECT_EQ(grid.front(), 0.1);
  EXPECT_EQ(grid.back(), 0.7);
  // Each entry is rounded once or twice: a few units in the last place of 0.7.
  for (std::size_t i = 0; i < grid.size(); ++i) EXPECT_NEAR(grid[i], 0.1 * (1.0 + static_cast<double>(i)), 4e-16);
}

TEST(NumberGrid, LogarithmicGridsHaveEqualRatiosAndExactEnds) {
  const auto grid = io::parse_grid("1e-6:1e6:13log", "--omega");
  ASSERT_EQ(grid.size(), 13U);
  EXPECT_EQ(grid.front(), 1e-6);
  EXPECT_EQ(grid.back(), 1e6);
  // exp of a logarithm up to 14 with a rounding of half a unit of it: relative error below 14 * 2.3e-16 * 2.
  for (std::size_t i = 0; i < grid.size(); ++i)
    EXPECT_NEAR(grid[i] / std::pow(10.0, static_cast<double>(i) - 6), 1, 7e-15);
}

TEST(NumberGrid, CountsMayBeWrittenAsPowersOfTen) {
  EXPECT_EQ(io::parse_grid("1:2:1e3", "--omega"), io::parse_grid("1:2:1000", "--omega"));
  EXPECT_EQ(io::parse_grid("1:2:1e3log", "--omega"), io::parse_grid("1:2:1000log", "--omega"));
}

TEST(NumberGrid, AListIsTakenAsItIs) {
  EXPECT_EQ(io::parse_grid("5,10,20", "--omega"), (std::vector<double>{5, 10, 20}));
}

TEST(NumberGrid, HugeRangesDoNotOverflow) {
  const auto grid = io::parse_grid("-1.7e308:1.7e308:5", "--omega");
  EXPECT_TRUE(std::all_of(grid.begin(), grid.end(), [](double value) { return std::isfinite(value); }));
  EXPECT_EQ(grid[2], 0);
}

TEST(NumberGrid, ErrorsSayWhatIsWrong) {
  const auto grid_message = [](const char* text) { return message_of([&] { (void)io::parse_grid(text, "--omega"); }); };
  const auto says = [&](const char* text, const char* part) {
    EXPECT_NE(grid_message(text).find(part), std::string::npos) << text << ": " << grid_message(text);
  };
  says("", "empty");
  says("5:35", "2 parts");
  says("5:35:2:1", "4 parts");
  says("5:35:0", "count 0");
  says("5:35:1", "count 1");
  says("5:35:-3", "'-3' (count)");
  says("5:35:2.5", "'2.5' (count)");
  says("5:35:log", "'' (count)");
  says("5:35:10lin", "'10lin' (count)");
  says("5:35:99999999999999999999", "must lie between");
  says("5:35:10000001", "must lie between");
  says("5:35:1e9", "must lie between");
  says("5:35:1e9log", "must lie between");
  says("35:5:10", "from 35 must be less than to 5");
  says("5:5:10", "from 5 must be less than to 5");
  says("0:5:10log", "from 0 must be > 0");
  says("-1:5:10log", "from -1 must be > 0");
  says("nan:5:10", "finite");
  says("1:inf:10", "finite");
  says("a:5:10", "'a' (from)");
  says("1::10", "'' (to)");
}
