// SPDX-License-Identifier: BSD-3-Clause
#include "io/number.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <string_view>

TEST(Number, EveryFiniteDoubleReadsBackBitForBit) {
  std::mt19937_64 generator(1);
  int tried = 0;
  while (tried < 20000) {
    const auto value = std::bit_cast<double>(generator());
    if (!std::isfinite(value)) continue;
    ++tried;
    const auto back = io::parse_number(io::format_number(value));
    ASSERT_TRUE(back.has_value()) << io::format_number(value);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(*back), std::bit_cast<std::uint64_t>(value)) << io::format_number(value);
  }
}

TEST(Number, IsWrittenAsShortAsPossible) {
  EXPECT_EQ(io::format_number(0.1), "0.1");
  EXPECT_EQ(io::format_number(40), "40");
  EXPECT_EQ(io::format_number(-1e-10), "-1e-10");
}

TEST(Number, NonFiniteValuesHaveOneSpellingEach) {
  EXPECT_EQ(io::format_number(std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(io::format_number(-std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(io::format_number(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(io::format_number(-std::numeric_limits<double>::infinity()), "-inf");
}

TEST(Number, WholeTextMustBeTheNumber) {
  for (const char* text : {"", "abc", "1.5x", "1,5", "1 2", "+", "+-1", "++1", "0x10", "1e", "--1"})
    EXPECT_FALSE(io::parse_number(text).has_value()) << text;
  EXPECT_EQ(io::parse_number("+1.5"), 1.5);
  EXPECT_EQ(io::parse_number("1E3"), 1000.0);
  EXPECT_EQ(io::parse_number(".5"), 0.5);
}

// Every text of up to five of the characters that numbers are made of, right or wrong.
TEST(Number, IsOneWhereItCanBeRead) {
  constexpr std::string_view characters = "-+.e0i9";
  std::string text;
  const auto try_longer = [&](const auto& self) -> void {
    EXPECT_EQ(io::is_number(text), io::parse_number(text).has_value()) << text;
    if (text.size() == 5) return;
    for (const char c : characters) {
      text.push_back(c);
      self(self);
      text.pop_back();
    }
  };
  try_longer(try_longer);
  for (const char* other : {"nan", "inf", "-inf", "1e400", "1e-400", "1.5x", "1,5"})
    EXPECT_EQ(io::is_number(other), io::parse_number(other).has_value()) << other;
}

TEST(Number, BeyondTheRangeOfADoubleIsInfiniteAndBelowItIsZero) {
  EXPECT_EQ(io::parse_number("1e400"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(io::parse_number("-1e400"), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(io::parse_number("1e-400"), 0.0);
}

TEST(Number, CountsAreWholeInAnySpelling) {
  EXPECT_EQ(io::parse_count("0"), 0U);
  EXPECT_EQ(io::parse_count("2000"), 2000U);
  EXPECT_EQ(io::parse_count("1e5"), 100000U);
  EXPECT_EQ(io::parse_count("2.5e1"), 25U);
  EXPECT_EQ(io::parse_count("18446744073709551615"), 18446744073709551615U);  // 2^64 - 1, every digit kept
  // From 2^53 on a double may stand for several whole numbers.
  for (const char* text : {"", "-1", "2.5", "1e-3", "9007199254740992.0", "1e300", "1e400", "nan", "inf", "ten", "5 "})
    EXPECT_FALSE(io::parse_count(text).has_value()) << text;
}
