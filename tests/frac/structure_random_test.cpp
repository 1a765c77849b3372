// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/structure.hpp"
#include "support/random.hpp"

namespace {

using Complex = std::complex<double>;
using LongComplex = std::complex<long double>;
using support::Random;

const std::vector<std::string> names{"K", "T1", "a", "R_2"};
const std::vector<double> values{1.3, 0.4, 0.6, 2.2};

// How tightly the last operation of a text binds.
enum class Rank { atom, product, quotient, sum };

// A formula drawn at random, its value by direct computation, and a bound of the error with which double arithmetic in
// the same order computes it, in units of the rounding of a double.
struct Drawn {
  std::string text;
  Rank rank;
  LongComplex value;
  long double error;
};

std::string parenthesised(const std::string& text) {
  return "(" + text + ")";
}
std::string blanks(Random& random) {
  return std::string(random.below(3), ' ');
}

// In parentheses where needed, and now and then where not.
std::string wrapped(Random& random, const Drawn& operand, bool needed) {
  return needed || random.below(5) == 0 ? parenthesised(operand.text) : operand.text;
}

Drawn draw_leaf(Random& random) {
  const std::size_t choice = random.below(4);
  if (choice == 0) {
    const double number = static_cast<double>(1 + random.below(30)) / 8;
    return {std::to_string(number), Rank::atom, number, 0};
  }
  if (choice == 1) {
    const std::size_t index = random.below(names.size());
    return {names[index], Rank::atom, values[index], 0};
  }
  return {"s", Rank::atom, {0, 0.8L}, 0};
}

// (factor s + constant)^order with constant >= 0: the base keeps clear of the cut of the principal value.
Drawn draw_power(Random& random) {
  const double order = static_cast<double>(1 + random.below(11)) / 4;
  const double factor = static_cast<double>(1 + random.below(8)) / 4;
  const double constant = static_cast<double>(random.below(3));
  const LongComplex base(constant, 0.8L * static_cast<long double>(factor));
  const LongComplex value = std::pow(base, static_cast<long double>(order));
  std::string text = std::to_string(factor) + " s";
  if (constant != 0) text += " + " + std::to_string(constant);
  text = factor == 1 && constant == 0 && random.below(2) == 0 ? "s" : parenthesised(text);
  text += random.below(2) == 0 ? "^" + std::to_string(order) : "^(" + std::to_string(2 * order) + "/2)";
  return {text, Rank::atom, value, 20 * std::abs(value)};
}

Drawn draw(Random& random, int depth) {
  const std::size_t choice = random.below(9);
  if (depth == 0 || choice == 0) return draw_leaf(random);
  if (choice == 1) return draw_power(random);
  const Drawn a = draw(random, depth - 1);
  if (choice == 2)
    return {"-" + blanks(random) + wrapped(random, a, a.rank != Rank::atom), Rank::sum, -a.value, a.error};
  const Drawn b = draw(random, depth - 1);
  const std::string gap = blanks(random);
  if (choice == 3 || choice == 4) {
    const LongComplex value = choice == 3 ? a.value + b.value : a.value - b.value;
    const char* const sign = choice == 3 ? "+" : "-";
    return {a.text + gap + sign + gap + wrapped(random, b, b.rank == Rank::sum), Rank::sum, value,
            a.error + b.error + std::abs(value)};
  }
  if (choice == 5 || choice == 6) {
    const LongComplex value = a.value * b.value;
    const long double error = a.error * std::abs(b.value) + b.error * std::abs(a.value) + 3 * std::abs(value);
    // A product by juxtaposition must not follow a division, nor a number stand second.
    const bool juxtaposed = choice == 6;
    const bool is_number = b.text[0] >= '0' && b.text[0] <= '9';
    const std::string left = wrapped(random, a, a.rank == Rank::sum || (juxtaposed && a.rank == Rank::quotient));
    const std::string right = wrapped(random, b, b.rank != Rank::atom || (juxtaposed && is_number));
    return {left + (juxtaposed ? " " : gap + "*" + gap) + right, Rank::product, value, error};
  }
  const LongComplex value = a.value / b.value;
  const long double error = a.error / std::abs(b.value) + b.error * std::abs(value / b.value) + 5 * std::abs(value);
  return {wrapped(random, a, a.rank == Rank::sum) + gap + "/" + gap + wrapped(random, b, b.rank != Rank::atom),
          Rank::quotient, value, error};
}

TEST(RandomFormulas, EvaluateToWhatTheyWereDrawnFrom) {
  Random random(20091);
  int compared = 0;
  for (int i = 0; i < 4000; ++i) {
    const Drawn drawn = draw(random, 1 + static_cast<int>(random.below(5)));
    const frac::Structure structure(drawn.text);
    std::vector<double> parameters;
    for (const std::string& name : structure.parameter_names()) {
      const auto index = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
      parameters.push_back(values[index]);
    }
    const auto bound = static_cast<double>(2.2e-16L * (drawn.error + std::abs(drawn.value)));
    // Formulas that divide by a difference of equal terms have no value to compare.
    if (!(bound < 1e-3 * static_cast<double>(std::abs(drawn.value)))) continue;
    ++compared;
    EXPECT_LE(std::abs(structure.response(parameters, 0.8) - Complex(drawn.value)), bound) << drawn.text;
  }
  EXPECT_GT(compared, 3500);
}

double round_number(Random& random) {
  const double number = random.log_uniform(1e-6, 1e6);
  return random.below(3) == 0 ? std::nearbyint(number) + 1 : number;
}

std::vector<frac::PowerTerm> random_terms(Random& random) {
  std::vector<frac::PowerTerm> terms;
  const std::size_t count = 1 + random.below(5);
  for (std::size_t i = 0; i < count; ++i) {
    const double sign = random.below(3) == 0 ? -1 : 1;
    const double order = random.below(4) == 0 ? static_cast<double>(random.below(4)) : random.uniform(-1, 4);
    terms.push_back({random.below(4) == 0 ? sign : sign * round_number(random), order});
  }
  return terms;
}

TEST(RandomFormulas, TransferFunctionsReadBackAsTheyWereWritten) {
  Random random(56);
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    try {
      const frac::FractionalTransferFunction system(random_terms(random), random_terms(random),
                                                    random.below(2) == 0 ? 0 : random.log_uniform(1e-9, 1e9));
      EXPECT_EQ(frac::FractionalTransferFunction::parse(system.formula()), system) << system.formula();
      EXPECT_EQ(frac::FractionalTransferFunction::parse(system.formula()).formula(), system.formula());
      ++compared;
    } catch (const std::invalid_argument& error) {
      // Coefficients 1 and -1 of one order add up to nothing.
      EXPECT_NE(std::string(error.what()).find("is zero"), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(compared, 2900);
}

// Any text either is a formula, which then evaluates without incident, or a FormulaError with its caret inside it.
void try_text(const std::string& text) {
  try {
    const frac::Structure structure(text);
    const std::size_t count = structure.parameter_names().size();
    std::vector<Complex> gradient(count);
    structure.response_and_gradient(std::vector<double>(count, 0.7), 1.3, frac::ExactRealisation{}, gradient);
    try {
      const auto system = frac::to_transfer_function(structure, std::vector<double>(count, 0.7));
      EXPECT_EQ(frac::FractionalTransferFunction::parse(system.formula()), system) << text;
    } catch (const std::invalid_argument&) {
    }
  } catch (const frac::FormulaError& error) {
    EXPECT_LE(error.column(), text.size()) << text;
  }
}

TEST(RandomFormulas, AnyTextIsAFormulaOrAFormulaError) {
  Random random(4);
  const std::vector<std::string> pieces{"s",     "s^",    "^",   "(",    ")",     "+",     "-",   "*",       "/",
                                        " ",     "1",     "2.5", "1e3",  "1e999", "a",     "K2",  "exp(",    "sqrt(",
                                        "tanh(", "coth(", "exp", ".",    "e",     "s^0.5", "^-1", "(s",      "s)",
                                        "\n",    ",",     "pi",  "\xff", "$",     "0",     "-1",  "(T s)^a", "^2"};
  for (int i = 0; i < 40'000; ++i) {
    std::string text;
    const std::size_t length = 1 + random.below(12);
    for (std::size_t k = 0; k < length; ++k) text += pieces[random.below(pieces.size())];
    try_text(text);
  }
}

TEST(RandomFormulas, DamagedFormulasAreFormulasOrFormulaErrors) {
  Random random(5);
  const std::vector<std::string> originals{
      "K exp(-L s)/(T s^a + 1)", "K/(1 + (T s)^a)^b", "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)",
      "R0 + R1/(1 + R1 C1 s) + 1/(C2 s + 1/(R2 + W/((tau s)^0.5 tanh((tau s)^0.5))))"};
  for (int i = 0; i < 20'000; ++i) {
    std::string text = originals[random.below(originals.size())];
    const std::size_t changes = 1 + random.below(3);
    for (std::size_t k = 0; k < changes && !text.empty(); ++k) {
      const std::size_t place = random.below(text.size());
      switch (random.below(3)) {
        case 0:
          text.erase(place, 1);
          break;
        case 1:
          text[place] = static_cast<char>(random.below(256));
          break;
        default:
          text.insert(place, 1, text[random.below(text.size())]);
          break;
      }
    }
    try_text(text);
  }
}

}  // namespace
