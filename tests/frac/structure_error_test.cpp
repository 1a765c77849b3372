// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "frac/structure.hpp"

namespace {

struct BadFormula {
  std::string formula;
  std::size_t column;
  std::string reason;  // part of the first line
};

class FormulaErrorAt : public testing::TestWithParam<BadFormula> {};

TEST_P(FormulaErrorAt, NamesReasonAndPlace) {
  const auto& [formula, column, reason] = GetParam();
  try {
    const frac::Structure structure(formula);
    FAIL() << "\"" << formula << "\" was accepted";
  } catch (const frac::FormulaError& error) {
    const std::string text = error.what();
    EXPECT_EQ(error.column(), column) << text;
    EXPECT_NE(text.substr(0, text.find('\n')).find(reason), std::string::npos) << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cases, FormulaErrorAt,
    testing::Values(BadFormula{"", 0, "empty"}, BadFormula{"  \t", 0, "empty"},                                    //
                    BadFormula{"1/(s + 1", 2, "not closed"}, BadFormula{"((s)", 0, "not closed"},                  //
                    BadFormula{"exp(-s", 3, "not closed"}, BadFormula{"(", 0, "not closed"},                       //
                    BadFormula{"s + 1)", 5, "no parenthesis is open"},                                             //
                    BadFormula{"()", 1, "operand is missing here"}, BadFormula{"exp()", 4, "operand is missing"},  //
                    BadFormula{"s +", 3, "missing at the end"}, BadFormula{"s + ", 4, "missing at the end"},       //
                    BadFormula{"* s", 0, "operand is missing here"}, BadFormula{"s + * 2", 4, "operand is missing"},
                    BadFormula{"s // 2", 3, "operand is missing here"}, BadFormula{"s ^", 3, "exponent is missing"},
                    BadFormula{"s^^2", 2, "operand is missing here"}, BadFormula{"s^-", 3, "exponent is missing"},
                    BadFormula{"s $ 2", 2, "unknown character"}, BadFormula{"s + \xc3\xa9", 4, "unknown character"},
                    BadFormula{"[s]", 0, "write parentheses"}, BadFormula{"{s}", 0, "write parentheses"},
                    BadFormula{"K/(τ s + 1)", 3, "spell it out: tau"}, BadFormula{"K/(1 + j ω T)", 9, "write s"},
                    BadFormula{"s**2", 2, "write ^"}, BadFormula{"K e^(-L)", 2, "write exp"},
                    BadFormula{"K·s", 1, "write *"}, BadFormula{"s²", 1, "write ^2"}, BadFormula{"K − s", 2, "write -"},
                    BadFormula{"\\frac{1}{s}", 0, "LaTeX"},
                    BadFormula{std::string("s + \0", 5), 4, "unknown character"}, BadFormula{"1,5 s", 1, "comma"},  //
                    BadFormula{"K s^(a s)", 7, "exponent must not contain s"},                                      //
                    BadFormula{"2^s", 2, "exponent must not contain s"},                                            //
                    BadFormula{"s^(1 + 2^s)", 9, "exponent must not contain s"},                                    //
                    BadFormula{"sin(s)", 0, "unknown function 'sin'"},
                    BadFormula{"2 + K(s)", 4, "unknown function 'K'"}, BadFormula{"exp", 3, "needs its argument"},
                    BadFormula{"sqrt s", 5, "needs its argument"},                                             //
                    BadFormula{"1/Q s^n", 4, "can be read"}, BadFormula{"1/-(s + 1) K", 11, "can be read"},    //
                    BadFormula{"a^b^c", 3, "write parentheses"}, BadFormula{"s^2^2", 3, "write parentheses"},  //
                    BadFormula{"2 3", 2, "a number cannot follow"}, BadFormula{"s 2", 2, "a number cannot follow"},
                    BadFormula{"1.2.3", 3, "a number cannot follow"},
                    BadFormula{"1 000 s", 2, "a number cannot follow"}, BadFormula{"1e400 s", 0, "out of the range"},
                    BadFormula{"1 + 1e-400", 4, "out of the range"}, BadFormula{". s", 0, "no number"},
                    BadFormula{"pi s", 0, "'pi'"}, BadFormula{"s + inf", 4, "'inf'"}, BadFormula{"nan", 0, "'nan'"}));

TEST(FormulaError, ShowsReasonFormulaAndCaret) {
  try {
    const frac::Structure structure("K/(T s^a + )");
    FAIL() << "accepted";
  } catch (const frac::FormulaError& error) {
    EXPECT_STREQ(error.what(),
                 "an operand is missing here\n"
                 "K/(T s^a + )\n"
                 "           ^");
  }
}

TEST(FormulaError, ShowsLineBreaksAsBlanks) {
  try {
    const frac::Structure structure("s +\n$");
    FAIL() << "accepted";
  } catch (const frac::FormulaError& error) {
    EXPECT_STREQ(error.what(), "unknown character\ns + $\n    ^");
  }
}

// Of a long formula the part around the place is shown, and the caret stands under it there.
TEST(FormulaError, ShowsThePlaceInALongFormula) {
  std::string formula = "s";
  while (formula.size() < 5000) formula += " + s";
  formula += " + $ + s";
  while (formula.size() < 8000) formula += " + s";
  try {
    const frac::Structure structure(formula);
    FAIL() << "accepted";
  } catch (const frac::FormulaError& error) {
    const std::string text = error.what();
    EXPECT_LT(text.size(), 400u);
    const std::size_t first_break = text.find('\n');
    const std::size_t second_break = text.find('\n', first_break + 1);
    const std::size_t caret = text.size() - 1 - (second_break + 1);
    EXPECT_EQ(text[first_break + 1 + caret], '$') << text;
    EXPECT_EQ(formula[error.column()], '$');
  }
}

TEST(FormulaError, LimitsLengthAndNesting) {
  std::string longest = "s";
  while (longest.size() + 2 <= 10'000) longest += "+s";
  EXPECT_NO_THROW(frac::Structure{longest});
  EXPECT_THROW(frac::Structure{longest + std::string(10, ' ')}, frac::FormulaError);

  const auto nested = [](std::size_t depth) { return std::string(depth, '(') + "s" + std::string(depth, ')'); };
  EXPECT_NO_THROW(frac::Structure{nested(200)});
  try {
    const frac::Structure structure(nested(201));
    FAIL() << "accepted";
  } catch (const frac::FormulaError& error) {
    EXPECT_EQ(error.column(), 200u);
  }
  // Signs and operators chain without nesting.
  EXPECT_NO_THROW(frac::Structure{std::string(9'000, '-') + "s"});
}

}  // namespace
