// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <complex>
#include <string>
#include <vector>

#include "frac/structure.hpp"
#include "support/random.hpp"
#include "support/random_spelling.hpp"

namespace {

using frac::Structure;

constexpr const char* formulas[] = {
    "K s^a",
    "K1 s^a1 + K2 s^a2",
    "K exp(-L s)/(T s^a + 1)",
    "K/(b2 s^a2 + b1 s^a1 + 1)",
    "1/(M s^2) + d + c s^q",
    "K/(1 + (T s)^a)^b",
    "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2) + A s^n3",
    "E0 + E1 (1 - 1/(1 + (T s)^a)^b)",
    "R0 + R1 tanh(sqrt(T s))/sqrt(T s)",
    "K ((T1 s + 1)/(T2 s + 1))^a",
    "K/((T2 s + 1) cosh(sqrt(T s)))",
    "(b0 + b1 s^a - b2 s^(2 a))/((s^2/w^2 + d s/w + 1) (s/p1 + 1) (s/p2 + 1)) - 3.5/(2 x - y)",
    "A1 s^n1 + A2 s^n2 + A3 s^n3 + A4 s^n4 + A5 s^n5",
    "log(1 + T s) sech(s/w) - coth(1/(c s)) sinh(a)",
};

/// The values of one formula as those of another, by the parameters that correspond.
std::vector<double> moved(const std::vector<double>& values, const std::vector<std::size_t>& correspondence) {
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) result[correspondence[i]] = values[i];
  return result;
}

std::vector<double> drawn(support::Random& random, std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(random.uniform(0.2, 1.7));
  return values;
}

/// Largest relative difference of two formulas at random parameters and frequencies.
double difference(const Structure& one, const Structure& other, const std::vector<std::size_t>& correspondence,
                  support::Random& random) {
  double most = 0;
  for (int draw = 0; draw < 3; ++draw) {
    const std::vector<double> values = drawn(random, one.parameter_names().size());
    const double omega = random.log_uniform(0.1, 10);
    const std::complex<double> a = one.response(values, omega),
                               b = other.response(moved(values, correspondence), omega);
    most = std::max(most, std::abs(a - b) / std::abs(a));
  }
  return most;
}

// Every way to write a formula is the same structure, and the parameters that are said to correspond do: with their
// values the responses agree to the rounding of sums and products in another order, of which there are some tens.
TEST(StructureIdentity, DoesNotDependOnTheSpelling) {
  support::Random random(1);
  for (const char* formula : formulas) {
    const Structure written(formula);
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const support::RandomSpelling spelling(written, seed);
      const Structure other(spelling.text());
      const auto correspondence = written.correspondence(other);
      ASSERT_TRUE(correspondence) << formula << "\n" << spelling.text();
      EXPECT_LT(difference(written, other, *correspondence, random), 1e-12) << formula << "\n" << spelling.text();
    }
  }
}

// With the names kept each parameter is its own, also where another one could stand for it.
TEST(StructureIdentity, KeepsNamesWhereItCan) {
  for (const char* formula : formulas) {
    const Structure written(formula);
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Structure other(support::RandomSpelling(written, seed, false).text());
      const auto correspondence = written.correspondence(other);
      ASSERT_TRUE(correspondence) << formula;
      for (std::size_t i = 0; i < correspondence->size(); ++i)
        EXPECT_EQ(other.parameter_names()[(*correspondence)[i]], written.parameter_names()[i]) << formula;
    }
  }
}

// Like parts go by their names, whatever the order of terms.
TEST(StructureIdentity, MatchesLikePartsByTheirNames) {
  const Structure preset("K1 s^a1 + K2 s^a2");
  for (const char* formula : {"A2 s^x + A10 s^y", "s^y A10 + A2 s^x"}) {
    const Structure other(formula);
    const auto correspondence = preset.correspondence(other);
    ASSERT_TRUE(correspondence);
    EXPECT_EQ(other.parameter_names()[correspondence->at(0)], "A2");
    EXPECT_EQ(other.parameter_names()[correspondence->at(1)], "x");
  }
}

TEST(StructureIdentity, TellsStructuresApart) {
  const Structure all[] = {
      Structure("K/(T s^a + 1)"),
      Structure("K/(T s + 1)^a"),
      Structure("K/(1 + (T s)^a)"),
      Structure("K/(T s^a - 1)"),
      Structure("K (T s^a + 1)"),
      Structure("K/(K s^a + 1)"),
      Structure("K/(T s^T + 1)"),
      Structure("K/(T s^a + 2)"),
      Structure("K/(T s + 1)"),
      Structure("K/(T s^2 + 1)"),
      Structure("K1 s^a1 + K2 s^a2"),
      Structure("K1 s^a1 + K2 s^a1"),
      Structure("K1 s^a1 - K2 s^a2"),
      Structure("K1 s^a1 (K2 s^a2)"),
      Structure("K1 s^a1/(K2 s^a2)"),
      Structure("K1 s^K2 + a1 s^a1"),
      Structure("A/(B s + C) + B/(A s)"),
      Structure("A/(B s + C) + A/(B s)"),
      Structure("A/(B s + C) + C/(A s)"),
      Structure("exp(-L s) K"),
      Structure("exp(L s) K"),
      Structure("K tanh(L s)"),
      Structure("K sinh(L s)"),
      Structure("K + L s"),
      Structure("K"),
      Structure("s"),
      Structure("2"),
      Structure("2 K s"),
      Structure("K s/2"),
  };
  for (const Structure& one : all)
    for (const Structure& other : all)
      EXPECT_EQ(one.correspondence(other).has_value(), one.formula() == other.formula())
          << one.formula() << " and " << other.formula();
}

// Random formulas of few letters, so that many are close to each other.  Those that are called the same must have the
// same response for the parameters said to correspond.
TEST(StructureIdentity, NeverConfusesRandomFormulas) {
  support::Random random(7);
  const auto factor = [&] {
    const std::string name(1, "abc"[random.below(3)]);
    return std::vector<std::string>{
        name, "s", name + " s", "s^" + name, "(" + name + " s)^0.5", "2", "(1 + " + name + " s)"}[random.below(7)];
  };
  std::vector<Structure> all;
  while (all.size() < 600) {
    std::string text = "a";
    for (std::size_t term = 0; term < 1 + random.below(2); ++term)
      text += (random.below(3) == 0 ? " - (" : " + (") + factor() + ") (" + factor() + ")/(" + factor() + ")";
    all.emplace_back(text);
  }
  std::size_t same = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto correspondence = all[i].correspondence(all[j]);
      if (!correspondence) continue;
      ++same;
      // The sums cancel rarely by more than a digit or two.
      EXPECT_LT(difference(all[i], all[j], *correspondence, random), 1e-10)
          << all[i].formula() << " and " << all[j].formula();
    }
  }
  EXPECT_GT(same, 20u);
}

TEST(StructureIdentity, TakesOtherWaysToWriteSignsAndNumbers) {
  const std::pair<const char*, const char*> pairs[] = {
      {"K/s", "K s^-1"},
      {"K/s^2", "s^(-2) K"},
      {"K sqrt(s)", "K s^0.5"},
      {"-(a - b s)", "b s - a"},
      {"K/(2 s)", "0.5 K/s"},
      {"a - -b s", "a + b s"},
      {"K (1 + T s)^-1", "K/(T s + 1)"},
      {"a + 1 + s - 3", "s - 2 + a"},
  };
  for (const auto& [one, other] : pairs) {
    EXPECT_TRUE(Structure(one).correspondence(Structure(other))) << one << " and " << other;
  }
}

TEST(StructureIdentity, RenamesParametersAlone) {
  const Structure structure("K1 exp(-L s)/(1e3 s^a + 2.5e-1 K s^K1)");
  const std::vector<std::string> names{"e1", "exponent", "b", "s1"};
  EXPECT_EQ(structure.renamed(names).formula(), "e1 exp(-exponent s)/(1e3 s^b + 2.5e-1 s1 s^e1)");
  EXPECT_THROW((void)structure.renamed(std::vector<std::string>{"a"}), std::invalid_argument);
  EXPECT_THROW((void)structure.renamed(std::vector<std::string>{"a", "b", "c", "?"}), frac::FormulaError);
}

// Long formulas of many like terms take no time that grows with the number of ways to match them, of which there are
// 60! here.
TEST(StructureIdentity, MatchesManyLikeTerms) {
  std::string one, other;
  for (int i = 0; i < 60; ++i) {
    one += (i > 0 ? " + " : "") + ("K" + std::to_string(i)) + " s^a" + std::to_string(i);
    other += (i > 0 ? "+" : "") + ("s^b" + std::to_string(i)) + "*g" + std::to_string(59 - i);
  }
  EXPECT_TRUE(Structure(one).correspondence(Structure(other)));
  EXPECT_FALSE(Structure(one).correspondence(Structure(other + "+ b3")));
}

TEST(StructureIdentity, CoefficientsThatKeepTheirSign) {
  const struct {
    const char* formula;
    std::vector<bool> keeps_sign;
  } cases[] = {
      {"K/(T s^a + 1)", {false, true, false}},
      {"K exp(-L s)/(T s + 1)", {false, false, true}},
      {"R0 + R1/(1 + R1 Q1 s^n1)", {false, true, true, false}},
      {"K1 s^a1 + K2 s^a2", {false, false, false, false}},
      {"1/(M s^2) + d + c s^q", {false, false, false, false}},
      {"K (T s + 1)/(b2 s^2 + b1 s + 1)", {false, false, true, true}},
      {"K/(1 + (T s)^a)^b", {false, true, false, false}},
      {"E0 + E1 (T s)^a/(1 + (T s)^a)", {false, false, true, false}},
      {"K/cosh(sqrt(T s))", {false, true}},
      {"K/(M (T s + 1))", {false, false, true}},
      {"(b0 + b1 s)/(s/p + 1) - c", {false, false, true, false}},
  };
  for (const auto& each : cases)
    EXPECT_EQ(Structure(each.formula).parameter_keeps_sign(), each.keeps_sign) << each.formula;
}

}  // namespace
