// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <complex>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/structure.hpp"
#include "generators.hpp"

namespace {

using fuzz::Random;

// Everything that a text of whatever kind may lead to: a structure that can be evaluated, or the documented exceptions.
void take(const std::string& text, std::size_t& understood) {
  try {
    const frac::Structure structure(text);
    ++understood;
    const std::vector<double> parameters(structure.parameter_names().size(), 0.7);
    for (const double omega : {1e-6, 1.0, 1e9}) {
      static_cast<void>(structure.response(parameters, omega));
      std::vector<std::complex<double>> gradient(parameters.size());
      static_cast<void>(structure.response_and_gradient(parameters, omega, frac::ExactRealisation{}, gradient));
    }
  } catch (const frac::FormulaError& error) {
    EXPECT_LE(error.column(), text.size() + 1) << text;
  }
}

TEST(FormulaFuzz, AnyTextIsAStructureOrAFormulaErrorWithItsPlace) {
  Random random(fuzz::seed(1));
  std::size_t understood = 0;
  const std::size_t count = fuzz::cases(20'000);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string text = fuzz::formula(random, 1 + static_cast<int>(random.below(6)));
    ASSERT_NO_THROW(take(text, understood)) << text;
    const std::string broken = fuzz::damaged(random, text);
    ASSERT_NO_THROW(take(broken, understood)) << broken;
  }
  // Otherwise the test would not reach beyond the parser.
  EXPECT_GT(understood, count / 4);
}

TEST(FormulaFuzz, ATransferFunctionIsItselfAgainFromItsFormula) {
  Random random(fuzz::seed(2));
  std::size_t understood = 0;
  for (std::size_t i = 0; i < fuzz::cases(5000); ++i) {
    const std::string text = fuzz::formula(random, 1 + static_cast<int>(random.below(4)));
    try {
      const auto model = frac::FractionalTransferFunction::parse(text);
      ++understood;
      EXPECT_EQ(frac::FractionalTransferFunction::parse(model.formula()), model) << text;
    } catch (const std::invalid_argument&) {  // no ratio of sums of powers
    }
  }
  EXPECT_GT(understood, 100U);
}

TEST(FormulaFuzz, DeepAndLongTextsEndInASentence) {
  for (const std::size_t depth : {10U, 1000U, 100'000U}) {
    std::size_t understood = 0;
    for (const std::string& piece :
         {std::string("("), std::string("-"), std::string("s^("), std::string("exp("), std::string("1/(")}) {
      std::string text;
      for (std::size_t i = 0; i < depth; ++i) text += piece;
      EXPECT_NO_THROW(take(text, understood)) << piece << depth;
      EXPECT_NO_THROW(take(text + "s" + std::string(depth, ')'), understood)) << piece << depth;
    }
    std::string sum = "s";
    for (std::size_t i = 0; i < depth; ++i) sum += "+s";
    EXPECT_NO_THROW(take(sum, understood)) << depth;
  }
}

}  // namespace
