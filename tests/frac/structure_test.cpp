// SPDX-License-Identifier: BSD-3-Clause
#include "frac/structure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/parallel_for.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/relative_error.hpp"

namespace {

using frac::ParameterRole;
using frac::Structure;
using support::expect_invalid_argument;
using support::log_grid;
using support::relative_error;
using Complex = std::complex<double>;
using LongComplex = std::complex<long double>;

constexpr double eps = 2.2e-16;
constexpr double infinity = std::numeric_limits<double>::infinity();

LongComplex power_of_s(double order, double omega) {
  return std::polar(std::pow(static_cast<long double>(omega), static_cast<long double>(order)),
                    static_cast<long double>(order) * std::numbers::pi_v<long double> / 2);
}

// The peak of the furnace model, from an independent computation in 25 digits.
TEST(Structure, FurnacePeak) {
  const Structure furnace("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const double peak = std::abs(furnace.response({}, 1.190543709));
  // The peak is flat: the 1e-9 of the frequency enters squared.  The denominator cancels to 0.2, that is 5 to 10 eps.
  EXPECT_NEAR(peak, 4.6208373031928, 4.6e-13);
  EXPECT_LT(std::abs(furnace.response({}, 1.190543709 * 1.001)), peak);
  EXPECT_LT(std::abs(furnace.response({}, 1.190543709 * 0.999)), peak);
}

// At omega = 2: each operation once, the value written out by hand.
TEST(Structure, EvaluatesEachOperation) {
  const Complex s(0, 2);
  const struct {
    const char* formula;
    Complex value;
  } cases[] = {
      {"s + 3", s + 3.0},
      {"3 + s", s + 3.0},
      {"s - 3", s - 3.0},
      {"3 - s", 3.0 - s},
      {"s + s^2", s - 4.0},
      {"s^2 - s", -4.0 - s},
      {"-s", -s},
      {"- - +s", s},
      {"3 s", 3.0 * s},
      {"s*3", 3.0 * s},
      {"s s^2", s * s * s},
      {"s/4", s / 4.0},
      {"4/s", 4.0 / s},
      {"4/(s + 1) exp(-0.5 s)", 4.0 / (s + 1.0) * std::exp(-0.5 * s)},
      {"4/(s + 1)^2 s", 4.0 / ((s + 1.0) * (s + 1.0)) * s},
      {"(s + 1)/(s + 2)", (s + 1.0) / (s + 2.0)},
      {"6/3/2", 1},
      {"6/3*2", 4},
      {"2 - 3 - 4", -5},
      {"2^-1", 0.5},
      {"2^(1 + 2)", 8},
      {"-2^2", -4},
      {"2 (3 + 4)", 14},
      {"(s + 1)^3", (s + 1.0) * (s + 1.0) * (s + 1.0)},
      {"(s + 1)^-2", 1.0 / ((s + 1.0) * (s + 1.0))},
      {"(s + 1)^0", 1},
      {"s^0", 1},
      {"s^1", s},
      {"(3 s)^2", -36},
      {"(s/3)^2", -4.0 / 9},
      {"(3/s)^2", -9.0 / 4},
      {"(-s)^2", -4},
      {"(s + 1)^0.5", std::sqrt(s + 1.0)},
      {"(s + 1)^1.3", std::pow(s + 1.0, 1.3)},
      {"sqrt(s)", {1, 1}},
      {"sqrt(s + 1)", std::sqrt(s + 1.0)},
      {"sqrt(9 s)", {3, 3}},
      {"sqrt(16)", 4},
      {"exp(-0.3 s)", std::polar(1.0, -0.6)},
      {"exp(1 - s)", std::exp(1.0) * std::polar(1.0, -2.0)},
      {"exp(2)", std::exp(2.0)},
      {"tanh(s + 1)", std::tanh(s + 1.0)},
      {"tanh(-s - 1)", -std::tanh(s + 1.0)},
      {"coth(s + 1)", 1.0 / std::tanh(s + 1.0)},
      {"coth(-1 - s)", -1.0 / std::tanh(s + 1.0)},
      {"tanh(0.5)", std::tanh(0.5)},
      {"coth(0.5)", 1 / std::tanh(0.5)},
      {"1e1 s", 10.0 * s},
      {".5s", 0.5 * s},
      {"2.e-1(s)", 0.2 * s},
      {" \t( s )\n", s},
  };
  for (const auto& each : cases) {
    // A handful of roundings; sizes up to 36.
    EXPECT_LT(std::abs(Structure(each.formula).response({}, 2) - each.value), 40 * eps * (1 + std::abs(each.value)))
        << each.formula;
  }
}

// The principal value of a power of a negative multiple of s turns by -90 degrees times the order.
TEST(Structure, PowersArePrincipalValues) {
  const Structure power("(T s)^a");
  const std::vector<double> parameters{-3, 0.7};
  EXPECT_LT(relative_error(power.response(parameters, 2), std::pow(Complex(0, -6), 0.7)), 20 * eps);
  EXPECT_LT(relative_error(Structure("(s/T)^a").response(parameters, 2), std::pow(Complex(0, -2.0 / 3), 0.7)),
            20 * eps);
  EXPECT_LT(relative_error(Structure("(T/s)^a").response(parameters, 2), std::pow(Complex(0, 1.5), 0.7)), 20 * eps);
  EXPECT_EQ(power.response(std::vector<double>{0, 0.7}, 2), 0.0);
}

TEST(Structure, ParametersAreNumberedByAppearance) {
  const Structure structure("K exp(-L s)/(T s^a + K)");
  EXPECT_EQ(structure.parameter_names(), (std::vector<std::string>{"K", "L", "T", "a"}));
  EXPECT_EQ(structure.parameter_index("T"), 2u);
  EXPECT_EQ(structure.formula(), "K exp(-L s)/(T s^a + K)");
  expect_invalid_argument([&] { (void)structure.parameter_index("x"); }, {"'x'", "K, L, T, a"});
  expect_invalid_argument([] { (void)Structure("s").parameter_index("x"); }, {"it has none"});
}

// The text that shows the grouping means the same, and shows it: what it gives back parses to itself.
TEST(Structure, GroupedTextMeansTheSame) {
  const auto grouped = [](const char* formula) { return frac::Structure(formula).grouped(); };
  EXPECT_EQ(grouped("K/(T s + 1) exp(-L s)"), "(K/(T s + 1)) exp(-L s)");
  EXPECT_EQ(grouped("a/b/c"), "(a/b)/c");
  EXPECT_EQ(grouped("a/b*c"), "(a/b) c");
  EXPECT_EQ(grouped("-a^2"), "-a^2");
  EXPECT_EQ(grouped("a - (b - c)"), "a - (b - c)");
  EXPECT_EQ(grouped("1/(Q s^-n)"), "1/(Q s^(-n))");
  EXPECT_EQ(grouped("1/2 * s"), "(1/2) s");
  const std::vector<double> parameters{1.3, 0.7, 0.4, 2.1, 0.9, 1.7};
  for (const char* formula : {"K/(T s + 1) exp(-L s)", "a/b/c*d s^e", "(K/s)^a + (s/w)^-b", "R0 + R1/(1 + (T s)^n)^m",
                              "-(-a - b s)*3", "sqrt(T s) tanh(sqrt(T s))/2*s", "1/(a*2 + s)^2 - -b"}) {
    const frac::Structure given(formula), again(given.grouped());
    EXPECT_EQ(again.grouped(), given.grouped()) << formula;
    ASSERT_EQ(again.parameter_names(), given.parameter_names()) << given.grouped();
    const std::span<const double> values(parameters.data(), given.parameter_names().size());
    // The same operations but for products in another order: some units in the last place.
    EXPECT_LT(std::abs(again.response(values, 1.7) / given.response(values, 1.7) - 1.0), 1e-14) << given.grouped();
  }
}

TEST(Structure, RolesFollowFromThePlace) {
  const auto coefficient = ParameterRole::coefficient;
  const auto order = ParameterRole::order;
  const auto delay = ParameterRole::delay;
  const struct {
    const char* formula;
    std::vector<ParameterRole> roles;
    std::vector<bool> in_sum;
  } cases[] = {
      {"K exp(-L s)/(T s^a + 1)", {coefficient, delay, coefficient, order}, {false, false, true, true}},
      {"K s^p", {coefficient, order}, {false, false}},
      {"K s^(p + q)", {coefficient, order, order}, {false, false, false}},
      {"K s^p + d", {coefficient, order, coefficient}, {true, true, true}},
      {"K/(1 + (T s)^a)^b", {coefficient, coefficient, order, order}, {false, true, true, false}},
      {"K exp(-s/v)", {coefficient, coefficient}, {false, false}},
      {"exp(-(L1 + 2 L2) s)", {delay, delay}, {true, true}},
      {"exp(-L s/2 + k)", {delay, coefficient}, {true, true}},
      {"exp(-sqrt(tau s))", {coefficient}, {false}},
      {"exp(-A s^2)", {coefficient}, {false}},
      {"W tanh((tau s)^0.5)", {coefficient, coefficient}, {false, false}},
      {"a s^a", {order}, {false}},
  };
  for (const auto& each : cases) {
    EXPECT_EQ(Structure(each.formula).parameter_roles(), each.roles) << each.formula;
    EXPECT_EQ(Structure(each.formula).parameter_in_sum(), each.in_sum) << each.formula;
  }
}

TEST(Structure, KnowsWhetherItIsOfFractionalOrder) {
  for (const char* formula : {"s^0.5", "1/(T s^a + 1)", "sqrt(s)", "(1 + s)^b", "1/(1 + (T s)^1.5)", "sqrt(1 + s)"}) {
    EXPECT_TRUE(Structure(formula).has_fractional_order()) << formula;
  }
  for (const char* formula : {"s^2", "K exp(-L s)/(T s + 1)", "(1 + s)^-3", "s^(4/2)", "sqrt(K) s", "K^0.5/(s + 1)"}) {
    EXPECT_FALSE(Structure(formula).has_fractional_order()) << formula;
  }
}

// Values over 26 decades, for the lumped model against long double: sums of same-signed parts lose a few eps only.
TEST(Structure, HoldsOverTwentySixDecades) {
  const Structure structure("R0 + R1/(1 + R1 Q1 s^n1)");
  const std::vector<double> parameters{0.1, 2, 0.5, 0.8};
  for (const double omega : log_grid(1e-13, 1e13, 53)) {
    const LongComplex reference = 0.1L + 2.0L / (1.0L + 2.0L * 0.5L * power_of_s(0.8, omega));
    EXPECT_LT(relative_error(structure.response(parameters, omega), Complex(reference)), 20 * eps) << omega;
  }
}

// tanh and coth saturate where exp would overflow, and keep their digits near 0.
TEST(Structure, HyperbolicFunctionsHoldOverTwentySixDecades) {
  const Structure warburg("tanh((tau s)^0.5)/(tau s)^0.5");
  const Structure blocked("coth(sqrt(s)) tanh(sqrt(s))");
  for (const double omega : log_grid(1e-13, 1e13, 53)) {
    const LongComplex root = std::sqrt(3.0L) * power_of_s(0.5, omega);
    // For Re root > 30 tanh is 1 in long double; for |root| < 1e-4 the series 1 - z^2/3 is exact to z^4/7.5 = 1e-17.
    LongComplex reference = std::abs(root) < 1e-4L ? 1.0L - root * root / 3.0L : std::tanh(root) / root;
    if (root.real() > 30) reference = 1.0L / root;
    EXPECT_LT(relative_error(warburg.response(std::vector<double>{3}, omega), Complex(reference)), 20 * eps) << omega;
    EXPECT_LT(relative_error(blocked.response({}, omega), 1), 20 * eps) << omega;
  }
}

TEST(Structure, DivisionSurvivesLargeAndSmallDenominators) {
  // Both squares of the denominator leave the range of double.
  EXPECT_LT(relative_error(Structure("(s^20 + 1)/(s^19 + 1)").response({}, 1e10), Complex(0, 1e10)), 40 * eps);
  EXPECT_LT(
      relative_error(Structure("(s^-19)/(s^-20 + s^-19)").response({}, 1e-9), Complex(0, 1e-9) / Complex(1, 1e-9)),
      40 * eps);
}

TEST(Structure, IsNotFiniteAtAPole) {
  EXPECT_FALSE(std::isfinite(std::abs(Structure("1/(s^2 + 4)").response({}, 2))));
  EXPECT_FALSE(std::isfinite(std::abs(Structure("sqrt(K) s").response(std::vector<double>{-1}, 2))));
}

TEST(Structure, GridGivesTheSameAsSingleFrequencies) {
  const Structure structure("K exp(-L s)/(T s^a + 1) + R tanh(s^0.4) (s + 2)^b");
  const std::vector<double> parameters{2, 0.1, 0.7, 1.3, 0.4, 0.6};
  const std::vector<double> omega = log_grid(1e-3, 1e3, 53);  // 53: no multiple of a block
  std::vector<Complex> value(omega.size());
  std::vector<Complex> plain_value(omega.size());
  std::vector<Complex> gradient(omega.size() * 6);
  structure.response_and_gradient(parameters, omega, frac::ExactRealisation{}, value, gradient);
  structure.response(parameters, omega, frac::ExactRealisation{}, plain_value);
  for (std::size_t i = 0; i < omega.size(); ++i) {
    std::vector<Complex> row(6);
    EXPECT_EQ(structure.response_and_gradient(parameters, omega[i], frac::ExactRealisation{}, row), value[i]);
    EXPECT_EQ(structure.response(parameters, omega[i]), value[i]);
    EXPECT_EQ(plain_value[i], value[i]);
    for (std::size_t p = 0; p < 6; ++p) EXPECT_EQ(row[p], gradient[p * omega.size() + i]);
  }
}

// One structure serves any number of threads at a time.
TEST(Structure, EvaluatesAlikeOnManyThreads) {
  const Structure structure("K exp(-L s)/(T s^a + 1)");
  const std::vector<double> omega = log_grid(1e-3, 1e3, 100);
  const std::vector<double> parameters{2, 0.1, 0.7, 1.3};
  const frac::Realisation realisations[] = {frac::ExactRealisation{}, frac::GrunwaldLetnikovRealisation{1e-3, 50}};
  std::vector<std::vector<Complex>> results(64, std::vector<Complex>(omega.size()));
  frac::parallel_for(results.size(), 4,
                     [&](std::size_t i) { structure.response(parameters, omega, realisations[i % 2], results[i]); });
  for (std::size_t i = 0; i < results.size(); ++i) EXPECT_EQ(results[i], results[i % 2]);
}

// Powers of s go through the realisation, s itself and (c s)^q included; the delay stays exact.
TEST(Structure, RealisationReplacesEachPowerOfS) {
  const double omega = 0.7;
  for (const frac::Realisation& realisation : {frac::Realisation(frac::OustaloupRealisation{{1e-2, 1e2}, 5}),
                                               frac::Realisation(frac::GrunwaldLetnikovRealisation{0.05, 40})}) {
    const auto power = [&](double order) { return frac::power_response(realisation, order, omega).value; };
    const Complex expected = std::polar(1.0, -0.2 * omega) * (3.0 * power(1) + 1.0) /
                             (std::pow(2.0, 1.3) * power(1.3) + power(0.5) + 4.0 * power(2));
    const Structure structure("exp(-0.2 s) (3 s + 1)/((2 s)^1.3 + sqrt(s) + (2 s)^2)*1");
    EXPECT_LT(relative_error(structure.response({}, omega, realisation), expected), 20 * eps);
    const auto same = frac::FractionalTransferFunction::parse("exp(-0.2 s) (3 s + 1)/((2 s)^1.3 + sqrt(s) + (2 s)^2)");
    EXPECT_LT(relative_error(same.response(omega, realisation), expected), 20 * eps);
  }
}

TEST(Structure, RefusesPowersThatARealisationCannotExpress) {
  const frac::Realisation realisation = frac::OustaloupRealisation{{1e-2, 1e2}, 5};
  const std::vector<double> parameters{1, 1, 0.5, 0.5};
  const Structure havriliak_negami("K/(1 + (T s)^a)^b");
  EXPECT_NO_THROW((void)havriliak_negami.response(parameters, 1));
  expect_invalid_argument([&] { (void)havriliak_negami.response(parameters, 1, realisation); },
                          {"(1 + (T s)^a)^b", "oustaloup", "only the exact"});
  expect_invalid_argument([&] { (void)Structure("sqrt(1 + s)").response({}, 1, realisation); }, {"sqrt(1 + s)"});
  EXPECT_NO_THROW((void)Structure("(1 + s^0.5)^2").response({}, 1, realisation));
  expect_invalid_argument([&] { (void)Structure("s^21").response({}, 1, realisation); }, {"order = 21"});
}

TEST(Structure, RefusesWrongLengthsAndFrequencies) {
  const Structure structure("K s^p");
  const std::vector<double> parameters{1, 2};
  const std::vector<double> omega{1, 2, 3};
  std::vector<Complex> three(3);
  std::vector<Complex> six(6);
  const frac::Realisation exact;
  expect_invalid_argument([&] { (void)structure.response(std::vector<double>{1}, 1); }, {"1 parameter values", "2"});
  expect_invalid_argument([&] { structure.response(parameters, omega, exact, six); }, {"6 places for values", "3"});
  expect_invalid_argument([&] { structure.response_and_gradient(parameters, omega, exact, three, three); },
                          {"3 places for derivatives", "6"});
  expect_invalid_argument([&] { (void)structure.response(parameters, 0); }, {"omega = 0"});
  expect_invalid_argument([&] { (void)structure.response(parameters, infinity); }, {"omega = inf"});
  expect_invalid_argument(
      [&] {
        (void)structure.response(parameters, 40, frac::GrunwaldLetnikovRealisation{0.1, 0});
      },
      {"omega = 40"});
  expect_invalid_argument(
      [&] {
        (void)structure.response(parameters, 1, frac::GrunwaldLetnikovRealisation{0, 0});
      },
      {"sample_time"});
}

}  // namespace
