// SPDX-License-Identifier: BSD-3-Clause
#include "frac/approximation/oustaloup.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "frac/realisation.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/observed_order.hpp"
#include "support/relative_error.hpp"

namespace {

using support::expect_invalid_argument;
using support::log_grid;
using support::relative_error;
using Complex = std::complex<double>;

constexpr double eps = 2.2e-16;

// (j omega)^order from the definition, in long double.
Complex exact_power(double order, double omega) {
  const long double angle = static_cast<long double>(order) * std::numbers::pi_v<long double> / 2;
  return Complex(std::polar(std::pow(static_cast<long double>(omega), static_cast<long double>(order)), angle));
}

double largest_error(const frac::ZeroPoleGain& system, double order, frac::FrequencyBand band) {
  double largest = 0;
  for (const double omega : log_grid(band.lower, band.upper, 2000)) {
    largest = std::max(largest, relative_error(system.response(omega), exact_power(order, omega)));
  }
  return largest;
}

class OustaloupAtOrder : public testing::TestWithParam<double> {};

TEST_P(OustaloupAtOrder, RootsAreThePublishedLadder) {
  const double a = GetParam();
  const frac::FrequencyBand band{1e-2, 1e3};
  const int n = 7;
  const frac::ZeroPoleGain system = frac::oustaloup(a, band, n);
  ASSERT_EQ(system.zeros.size(), 7u);
  ASSERT_EQ(system.poles.size(), 7u);
  EXPECT_EQ(system.integer_order, 0);
  EXPECT_NEAR(system.gain, std::pow(1e3, a), 4 * eps * std::pow(1e3, a));
  for (int i = 0; i < n; ++i) {
    const auto index = static_cast<std::size_t>(i);
    // The logarithms are at most 7, so that their rounding shifts a root by 7 eps or so.
    EXPECT_NEAR(system.zeros[index] / (-1e-2 * std::pow(1e5, (i + 0.5 - a / 2) / n)), 1, 40 * eps);
    EXPECT_NEAR(system.poles[index] / (-1e-2 * std::pow(1e5, (i + 0.5 + a / 2) / n)), 1, 40 * eps);
  }
}

TEST_P(OustaloupAtOrder, ZerosAndPolesInterlaceOnTheNegativeAxis) {
  const frac::ZeroPoleGain system = frac::oustaloup(GetParam(), {1e-4, 1e4}, 20);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_LT(system.zeros[i], 0);
    EXPECT_LT(system.poles[i], system.zeros[i]);
    if (i > 0) {
      EXPECT_LT(system.zeros[i], system.poles[i - 1]);
    }
  }
}

// A dense ladder is wb^a prod over d ln p of factors that integrate to (s + wb)^a/(1 + s/wh)^a, so that on the lower
// edge H/(j wb)^a = (1 - j)^a.  A ladder of finite density is the midpoint rule for that integral, with the error
// rung^2/24 times the step of the integrand's slope over the band, at most a, and the far edge contributes 1e-12.
TEST_P(OustaloupAtOrder, EdgeErrorTendsToItsLimitAndNotToZero) {
  const double a = GetParam();
  const frac::FrequencyBand band{1e-6, 1e6};
  const double limit = std::abs(std::pow(Complex(1, -1), a) - 1.0);
  const auto distance = [&](int poles) {
    const Complex value = frac::oustaloup(a, band, poles).response(band.lower);
    return std::abs(relative_error(value, exact_power(a, band.lower)) - limit);
  };
  const double rung = std::log(1e12) / 480;
  EXPECT_LT(distance(480), rung * rung / 24 * a);
  // The next term of the midpoint rule is smaller by rung^2, 1e-2 at the coarser step.
  EXPECT_NEAR(support::observed_order(distance(240), distance(480)), 2, 0.02);
}

// In the middle of a band of 12 decades the edges shift the phase by a (1e-6 + 1e-6) at most, and 5 poles per decade
// leave a ripple of 2 sin(pi a) exp(-pi^2 5/ln 10) < 1e-9.  Over two decades around the middle the edges make 2e-5 a.
TEST_P(OustaloupAtOrder, PhaseIsFlatInsideTheBand) {
  const double a = GetParam();
  const frac::ZeroPoleGain system = frac::oustaloup(a, {1e-6, 1e6}, 60);
  for (const double omega : log_grid(0.1, 10, 101)) {
    EXPECT_NEAR(std::arg(system.response(omega)), a * std::numbers::pi / 2, 2e-5 * a);
  }
}

TEST_P(OustaloupAtOrder, OrderAndItsNegativeAreReciprocal) {
  const frac::ZeroPoleGain there = frac::oustaloup(GetParam(), {1e-3, 1e3}, 9);
  const frac::ZeroPoleGain back = frac::oustaloup(-GetParam(), {1e-3, 1e3}, 9);
  for (const double omega : log_grid(1e-5, 1e5, 41)) {
    // 18 factors in each, a few roundings per factor.
    EXPECT_LT(relative_error(there.response(omega) * back.response(omega), 1), 200 * eps);
  }
}

// A whole order more is exactly one factor s.
TEST_P(OustaloupAtOrder, WholePartIsExact) {
  const frac::ZeroPoleGain fractional = frac::oustaloup(GetParam(), {1e-3, 1e3}, 9);
  const frac::ZeroPoleGain with_whole = frac::oustaloup(GetParam() + 2, {1e-3, 1e3}, 9);
  EXPECT_EQ(with_whole.integer_order, 2);
  for (const double omega : log_grid(1e-5, 1e5, 41)) {
    // (order + 2) - 2 is rounded at 4 eps, which the gain 1e3^order turns into 7 times as much.
    EXPECT_LT(relative_error(with_whole.response(omega), fractional.response(omega) * -(omega * omega)), 300 * eps);
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, OustaloupAtOrder, testing::Values(0.1, 0.3, 0.5, 0.7, 0.9));

// The figures that the header quotes.
TEST(Oustaloup, EdgeErrorsInPercent) {
  const double orders[] = {0.1, 0.3, 0.5, 0.7, 0.9};
  const double percent[] = {8.7, 27, 46.6, 67, 89};
  for (int i = 0; i < 5; ++i) {
    const frac::FrequencyBand band{1e-4, 1e4};
    const double error = largest_error(frac::oustaloup(orders[i], band, 200), orders[i], band);
    // Half a unit of the last quoted digit.
    EXPECT_NEAR(100 * error, percent[i], i == 0 || i == 2 ? 0.05 : 0.5);
  }
}

// On the inner 4 decades an outer margin of d decades leaves about a 10^-d from each edge, and the ripple is that of
// the attainable limit or above: 2 sin(pi a) exp(-pi^2 N/L).  57 poles over 16 decades: 2 exp(-15.3) = 4.6e-7, edges 2
// * 0.5e-6.
TEST(Oustaloup, ConvergesOnABandInsideItsOwn) {
  const frac::FrequencyBand inner{1e-2, 1e2};
  double previous = 1;
  for (const int margin : {1, 2, 3, 4, 5, 6}) {
    const double factor = std::pow(10.0, margin);
    const frac::ZeroPoleGain system =
        frac::oustaloup(0.5, {inner.lower / factor, inner.upper * factor}, 4 * (4 + 2 * margin));
    const double error = largest_error(system, 0.5, inner);
    EXPECT_LT(error, 0.2 * previous) << margin;
    previous = error;
  }
  EXPECT_LT(largest_error(frac::oustaloup(0.5, {1e-8, 1e8}, 57), 0.5, inner), 1.5e-6);
}

TEST(Oustaloup, RealisationGivesTheResponseOfTheZerosAndPoles) {
  for (const double order : {-1.3, -0.5, 0.0, 0.4, 1.0, 2.2}) {
    const frac::FrequencyBand band{1e-3, 1e4};
    const frac::ZeroPoleGain system = frac::oustaloup(order, band, 11);
    for (const double omega : log_grid(1e-6, 1e7, 30)) {
      const Complex value = frac::power_response(frac::OustaloupRealisation{band, 11}, order, omega).value;
      EXPECT_LT(relative_error(value, system.response(omega)), 200 * eps) << order << " " << omega;
    }
  }
}

TEST(Oustaloup, WideBandsAndManyPolesStayFinite) {
  for (const double order : {0.5, -0.9}) {
    const frac::FrequencyBand band{1e-100, 1e100};
    const frac::ZeroPoleGain system = frac::oustaloup(order, band, 1000);
    for (const double omega : {1e-130, 1e-13, 1.0, 1e13, 1e130}) {
      const Complex value = system.response(omega);
      EXPECT_TRUE(std::isfinite(value.real()) && std::isfinite(value.imag()));
      // 2000 roots, each with the rounding of a logarithm of up to 230.
      EXPECT_LT(relative_error(frac::power_response(frac::OustaloupRealisation{band, 1000}, order, omega).value, value),
                2000 * 230 * eps);
    }
  }
}

TEST(Oustaloup, RefusesWhatItCannotRealise) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  expect_invalid_argument([&] { (void)frac::oustaloup(nan, {1, 2}, 3); }, {"order = nan"});
  expect_invalid_argument([&] { (void)frac::oustaloup(20.5, {1, 2}, 3); }, {"order = 20.5"});
  expect_invalid_argument([&] { (void)frac::oustaloup(0.5, {2, 1}, 3); }, {"band = 2 to 1 rad/s"});
  expect_invalid_argument([&] { (void)frac::oustaloup(0.5, {0, 1}, 3); }, {"band = 0 to 1 rad/s"});
  expect_invalid_argument([&] { (void)frac::oustaloup(0.5, {1, infinity}, 3); }, {"band = 1 to inf"});
  expect_invalid_argument([&] { (void)frac::oustaloup(0.5, {nan, 1}, 3); }, {"band = nan"});
  expect_invalid_argument([&] { (void)frac::oustaloup(0.5, {1, 2}, 0); }, {"poles = 0", "1 to 1000"});
  expect_invalid_argument([&] { (void)frac::oustaloup(0.5, {1, 2}, 1001); }, {"poles = 1001"});
}

}  // namespace
