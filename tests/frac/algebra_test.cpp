// SPDX-License-Identifier: BSD-3-Clause
#include "frac/model/algebra.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "frac/model/delayed_loop.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using frac::FractionalTransferFunction;
using frac::PowerTerm;
using support::expect_invalid_argument;

FractionalTransferFunction model(const char* formula) {
  return FractionalTransferFunction::parse(formula);
}

FractionalTransferFunction random_model(support::Random& random, double delay) {
  const auto terms = [&](std::size_t count) {
    std::vector<PowerTerm> sum;
    for (std::size_t i = 0; i < count; ++i) {
      // Orders repeat, so that terms meet and merge.
      sum.push_back(
          {random.uniform(0.2, 2) * (random.unit() < 0.3 ? -1 : 1), 0.1 * static_cast<double>(random.below(20))});
    }
    sum.push_back({random.uniform(0.2, 2), 0});
    return sum;
  };
  return {terms(1 + random.below(3)), terms(1 + random.below(3)), delay};
}

using Complex = std::complex<double>;

// Products of four-term sums round by some ten eps, more where the terms of the result cancel.
void expect_response(const FractionalTransferFunction& result, const std::vector<Complex>& expected,
                     const std::vector<double>& size) {
  const double omega[] = {0.1, 0.9, 7.3};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(std::abs(result.response(omega[i]) - expected[i]), 1e-12 * size[i]) << result.formula();
  }
}

}  // namespace

TEST(Algebra, OperationsAreThoseOfTheResponses) {
  support::Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const auto a = random_model(random, 0.3), b = random_model(random, 0.3);
    const auto c = random_model(random, 0), d = random_model(random, 0);
    std::vector<Complex> sum, difference, product, quotient, loop;
    std::vector<double> sum_size, product_size, quotient_size, loop_size;
    for (const double omega : {0.1, 0.9, 7.3}) {
      const Complex x = a.response(omega), y = b.response(omega), g = c.response(omega), h = d.response(omega);
      sum.push_back(x + y);
      difference.push_back(x - y);
      product.push_back(x * y);
      quotient.push_back(x / g);
      loop.push_back(g / (1.0 + g * h));
      // Denominators near zero amplify rounding: by their terms over themselves, at most some hundred here.
      sum_size.push_back(100 * (std::abs(x) + std::abs(y)));
      product_size.push_back(100 * std::abs(x * y));
      quotient_size.push_back(100 * std::abs(x / g));
      loop_size.push_back(100 * std::abs(loop.back()) * (1 + std::abs(g * h)) / std::abs(1.0 + g * h));
    }
    expect_response(a + b, sum, sum_size);
    expect_response(a - b, difference, sum_size);
    expect_response(a * b, product, product_size);
    expect_response(a / c, quotient, quotient_size);
    expect_response(feedback(c, d), loop, loop_size);
    EXPECT_EQ((a * b).delay(), 0.6);
    EXPECT_EQ((a / c).delay(), 0.3);
  }
}

TEST(Algebra, MergesAndCancels) {
  EXPECT_EQ((model("1/(s + 1)") + model("2/(s + 1)")).formula(), "3/(s + 1)");
  EXPECT_EQ((model("s^0.5") * model("1/s^0.5")).formula(), "1");
  EXPECT_EQ((model("s^0.3/(s + 1)") * model("(s + 2)/s^0.3")).formula(), "(s + 2)/(s + 1)");
  // 0.1 + 0.2 - 0.3 is rounding.
  EXPECT_EQ((model("(0.1 s + 1)/s^2") + model("0.2/s") - model("0.3/s")).formula(), "1/s^2");
  EXPECT_EQ(feedback(model("1/s^0.5"), model("1")).formula(), "1/(s^0.5 + 1)");
  EXPECT_EQ((2 * model("1/(s + 1)")).formula(), "2/(s + 1)");
}

TEST(Algebra, RefusesWhatIsNoRatioOfSumsOfPowers) {
  const auto early = model("exp(-0.1 s)/(s + 1)"), late = model("exp(-0.2 s)/(s + 1)");
  expect_invalid_argument([&] { (void)(early + late); }, {"0.1 s and 0.2 s differ"});
  expect_invalid_argument([&] { (void)(early - late); }, {"differ"});
  expect_invalid_argument([&] { (void)(early / late); }, {"0.2 s", "future"});
  expect_invalid_argument([&] { (void)(early - early); }, {"zero"});
  expect_invalid_argument([&] { (void)feedback(early, model("1")); }, {"dead time of 0.1 s"});
  expect_invalid_argument([&] { (void)feedback(model("1"), model("-1")); }, {"zero"});
  EXPECT_EQ((late / early).delay(), 0.1);
}

// Every spelling of the loop has the value of its formula at points right of the axis.
TEST(DelayedLoop, IsReadFromItsFormula) {
  for (const char* formula :
       {"exp(-0.5 s)/(s + exp(-0.5 s))", "2 exp(-1 s)/s^0.5/(1 + 2 exp(-1 s)/s^0.5)",
        "-(s + 3)/(s (1 + exp(-1 s)/(s + 2)))", "(1/(s + 1)) (1/(s^0.3 + 2 - exp(-2 s)/(s + 4) + s)) exp(-3 s)",
        "exp(-2 s)/(exp(-1 s)*(s + 1) + 0.2 exp(-1.5 s))", "1/(3 - (2 - exp(-1 s)/s))"}) {
    const frac::Structure structure(formula);
    const auto loop = frac::delayed_loop(structure, {});
    ASSERT_TRUE(loop) << formula;
    for (const double omega : {0.1, 0.7, 3.0}) {
      const auto expected = structure.response({}, omega);
      const auto found = loop->forward.response(omega) / (1.0 + loop->loop.response(omega));
      // A dozen operations on values of which the smallest sum is a tenth of its terms.
      EXPECT_LT(std::abs(found / expected - 1.0), 1e-13) << formula;
    }
  }
  for (const char* none : {"1/(s + 1)", "exp(-1 s)", "1/(1 + exp(-1 s) + exp(-2 s))", "1/(1 + exp(-1 s)/s)^2",
                           "tanh(s)/(1 + exp(-1 s))", "1 + 1/(s + exp(-1 s))", "1/(exp(-1 s) + s exp(-2 s))"}) {
    EXPECT_FALSE(frac::delayed_loop(frac::Structure(none), {})) << none;
  }
  const double values[] = {2, 0.5};
  EXPECT_EQ(frac::delayed_loop(frac::Structure("K/(s + K exp(-L s))"), values)->loop.delay(), 0.5);
  expect_invalid_argument([] { (void)frac::delayed_loop(frac::Structure("K/(s + K exp(-L s))"), {}); },
                          {"2 are needed"});
}

TEST(Simplified, CancelsCommonFactorsWhereTheDivisionIsExact) {
  EXPECT_EQ(simplified(model("(s + 1)/((s + 1) (s + 2))")).formula(), "1/(s + 2)");
  EXPECT_EQ(simplified(model("(s - 1)/(s^0.5 - 1)")).formula(), "s^0.5 + 1");
  EXPECT_EQ(simplified(model("(s^1.4 + 2 s^0.7 + 1)/((s^0.7 + 1) (s^0.3 + 4))")).formula(), "(s^0.7 + 1)/(s^0.3 + 4)");
  EXPECT_EQ(simplified(model("(2 s^0.5 + 4)/(s^0.5 + 2)")).formula(), "2");
  EXPECT_EQ(simplified(model("exp(-1 s) (s^0.2 + s^1.2)/(s + 1)")).formula(), "exp(-1 s) (s^0.2)");
  for (const char* kept : {"(s + 1)/(s + 2)", "(s + 1)/(s + 1.000001)", "(s^1.4142135623730951 + 1)/(s + 1)"}) {
    EXPECT_EQ(simplified(model(kept)), model(kept));
  }
}

TEST(Simplified, OfRandomModelsWithACommonFactorIsTheSameFunctionWithFewerTerms) {
  support::Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const auto a = random_model(random, 0), factor = random_model(random, 0);
    const FractionalTransferFunction common(factor.numerator(), {{1, 0}});
    const FractionalTransferFunction wide = (a * common) / common;
    const FractionalTransferFunction narrow = simplified(wide);
    EXPECT_LE(narrow.numerator().size() + narrow.denominator().size(),
              wide.numerator().size() + wide.denominator().size());
    for (const double omega : {0.1, 0.9, 7.3}) {
      const Complex value = a.response(omega);
      EXPECT_LE(std::abs(narrow.response(omega) - value), 1e-9 * std::abs(value)) << a.formula();
    }
  }
}

// Long division by orders without a common divisor makes ever more terms, which went on for minutes.  No factor is
// common to sums of random coefficients and orders, so that the terms stay; one that is put in is found where what it
// multiplies has a term or two.  The timeout of the test program alone judges the time.
TEST(Simplified, OfOrdersWithoutACommonDivisorEnds) {
  support::Random random(3904);
  const auto sum = [&](int terms) {
    std::vector<PowerTerm> result{{1, 0}};
    for (int i = 1; i < terms; ++i) result.push_back({random.uniform(0.5, 2), random.uniform(0.05, 3)});
    return result;
  };
  for (int terms = 3; terms <= 8; ++terms) {
    const FractionalTransferFunction plain(sum(terms), sum(terms + 1));
    const FractionalTransferFunction narrow = simplified(plain);
    EXPECT_EQ(narrow.numerator().size(), plain.numerator().size());
    EXPECT_EQ(narrow.denominator().size(), plain.denominator().size());
    const FractionalTransferFunction common(sum(terms), {{1, 0}});
    const double order = random.uniform(0.1, 0.9);
    const FractionalTransferFunction with_factor =
        common / (common * FractionalTransferFunction({{1, order}, {2, 0}}, {{1, 0}}));
    EXPECT_EQ(simplified(with_factor).denominator().size(), 2u) << terms;
    for (const double omega : {0.1, 0.9, 7.3}) {
      const Complex value = plain.response(omega);
      EXPECT_LE(std::abs(narrow.response(omega) - value), 1e-9 * std::abs(value)) << plain.formula();
    }
  }
}

TEST(Simplified, WholeOrdersAreExactlyWhole) {
  // 0.1 ten times is 0.9999999999999999.
  std::vector<PowerTerm> sum{{1, 0}};
  double order = 0;
  for (int i = 0; i < 10; ++i) order += 0.1;
  ASSERT_NE(order, 1);
  const auto lag = simplified(FractionalTransferFunction({{1, 0}}, {{1, order}, {1, 0}}));
  EXPECT_EQ(lag, model("1/(s + 1)"));
}

TEST(CommensurateOrder, IsFoundByContinuedFractions) {
  const auto of = [](const char* formula) {
    const auto order = frac::commensurate_order(model(formula));
    return order ? std::pair(order->numerator, order->denominator) : std::pair(0l, 0l);
  };
  EXPECT_EQ(of("1/(s^1.8 + s^0.9 + 1)"), std::pair(9l, 10l));
  EXPECT_EQ(of("(s^0.5 + 1)/(s^0.75 + 1)"), std::pair(1l, 4l));
  EXPECT_EQ(of("1/(s^2 + s + 1)"), std::pair(1l, 1l));
  EXPECT_EQ(of("1/(s^0.3333333333333333 + 1)"), std::pair(1l, 3l));
  EXPECT_EQ(of("1/(s^0.142857142857142857 + s^0.6 + 1)"), std::pair(1l, 35l));
  EXPECT_EQ(of("1/(s^3.501 + s^2.42 + 1)"), std::pair(1l, 1000l));
  EXPECT_EQ(of("1/(s^0.0123 + 1)"), std::pair(0l, 0l));  // 123/10000
  EXPECT_EQ(of("1/(s^1.4142135623730951 + 1)"), std::pair(0l, 0l));
  EXPECT_EQ(of("3"), std::pair(0l, 0l));
  EXPECT_EQ(frac::commensurate_order(model("1/(s^0.0123 + 1)"), 10'000)->numerator, 123);
}
