// SPDX-License-Identifier: BSD-3-Clause
#include "io/number.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <string_view>

#include "io/fingerprint.hpp"
#include "support/random.hpp"

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

// The C library rounds correctly: its value is the only right one, to the last bit and with the sign of 0.
TEST(Number, AgreesWithTheLibraryToTheLastBit) {
  support::Random random(99);
  const auto digits = [&](std::size_t count) {
    std::string text;
    for (std::size_t k = 0; k < count; ++k) text += static_cast<char>('0' + random.below(10));
    return text;
  };
  for (int i = 0; i < 200000; ++i) {
    const std::size_t before = random.below(12), behind = random.below(12);
    std::string text = (random.below(2) == 0 ? "-" : "") + digits(before);
    if (behind > 0 || random.below(4) == 0) text += '.';
    text += digits(behind);
    if (before + behind == 0) text = "0";
    if (random.below(2) == 0) {
      const std::size_t sign = random.below(3);
      text += sign == 0 ? "e" : sign == 1 ? "E-" : "e+";
      text += std::to_string(random.below(random.below(2) == 0 ? 30 : 320));
    }
    const auto number = io::parse_number(text);
    ASSERT_TRUE(number) << text;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(*number), std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr)))
        << text;
  }
}

TEST(Number, MayHaveTheExponentOfFortran) {
  EXPECT_EQ(io::parse_number("1.0D+00"), 1.0);
  EXPECT_EQ(io::parse_number("-2.5d-03"), -2.5e-3);
  EXPECT_EQ(io::parse_number("+.123456789012345678D+02"), 12.3456789012345678);
  EXPECT_EQ(io::parse_number("1D400"), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(io::is_number("1.0D+00"));
  for (const char* text : {"D+00", "1.0D", "1.0D+", "1D2D3", "1.0DD1", "1e5D2", "nanD1", "2D", "1.0D+00x"})
    EXPECT_FALSE(io::parse_number(text)) << text;
}

TEST(Number, IsTheWholeText) {
  for (const char* text : {"", "-", ".", "-.", "e5", "1e", "1e+", "1.5.2", "1,5", "1 ", " 1", "--1", "+-1", "1e5.0",
                           "0x10", "1'000", "12a"})
    EXPECT_FALSE(io::parse_number(text)) << text;
}

TEST(Fingerprint, DependsOnTheTextAloneAndOnEveryBitOfIt) {
  support::Random random(7);
  std::string text;
  for (int i = 0; i < 300; ++i) text += static_cast<char>('0' + random.below(64));
  const std::string whole = io::Fingerprint(text).text();
  for (int trial = 0; trial < 50; ++trial) {
    io::Fingerprint parts;
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t length = std::min(text.size() - begin, static_cast<std::size_t>(random.below(30)));
      parts.add(std::string_view(text).substr(begin, length));
      begin += length;
    }
    ASSERT_EQ(parts.text(), whole);
  }
  std::set<std::string> all{whole};
  for (std::size_t i = 0; i < text.size(); ++i)
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::string other = text;
      other[i] = static_cast<char>(static_cast<unsigned char>(other[i]) ^ (1U << bit));
      all.insert(io::Fingerprint(other).text());
    }
  EXPECT_EQ(all.size(), 1 + 8 * text.size());
  EXPECT_NE(io::Fingerprint(text + '\0').text(), whole);
}
