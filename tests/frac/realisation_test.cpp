// SPDX-License-Identifier: BSD-3-Clause
#include "frac/realisation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/expect_invalid_argument.hpp"
#include "support/relative_error.hpp"

namespace {

using support::expect_invalid_argument;
using support::log_grid;
using support::relative_error;
using Complex = std::complex<double>;

constexpr double eps = 2.2e-16;

const frac::Realisation all_realisations[] = {frac::ExactRealisation{}, frac::OustaloupRealisation{{1e-3, 1e3}, 9},
                                              frac::GrunwaldLetnikovRealisation{1e-3, 0},
                                              frac::GrunwaldLetnikovRealisation{1e-3, 300}};

TEST(Realisation, ExactPowerOfAWholeOrderIsExact) {
  const auto power = [](double order, double omega) {
    return frac::power_response(frac::ExactRealisation{}, order, omega).value;
  };
  EXPECT_EQ(power(0, 3.7), Complex(1, 0));
  EXPECT_EQ(power(1, 3.7), Complex(0, 3.7));
  EXPECT_EQ(power(2, 3.7), Complex(-(3.7 * 3.7), 0));
  EXPECT_EQ(power(-1, 3.7), Complex(0, -1 / 3.7));
  EXPECT_EQ(power(-2, 2.0), Complex(-0.25, 0));
  EXPECT_EQ(power(3, 2.0), Complex(0, -8));
  EXPECT_EQ(power(4, 3.0), Complex(81, 0));
}

// omega^q e^{j q pi/2} in long double.  The power is good to an eps or so, the phase too.
TEST(Realisation, ExactPowerHoldsOverTwentySixDecades) {
  for (const double order : {-2.6, -0.5, 0.1, 0.5, 0.9, 1.3, 2.2, 3.999}) {
    for (const double omega : log_grid(1e-13, 1e13, 105)) {
      const std::complex<long double> reference =
          std::polar(std::pow(static_cast<long double>(omega), static_cast<long double>(order)),
                     static_cast<long double>(order) * std::numbers::pi_v<long double> / 2);
      EXPECT_LT(relative_error(frac::power_response(frac::ExactRealisation{}, order, omega).value, Complex(reference)),
                4 * eps);
    }
  }
}

// Five-point difference with step d: error d^4/30 of the fifth derivative, |ln(j omega)|^5 at most 12^5 within these
// bands, and rounding eps/d; with d = 1e-3 both stay below 1e-8.
TEST(Realisation, DerivativeByTheOrderAgreesWithDifferences) {
  const double d = 1e-3;
  for (const frac::Realisation& realisation : all_realisations) {
    for (const double order : {-1.7, -0.45, 0.3, 0.77, 1.5, 2.6}) {
      for (const double omega : {1e-4, 0.02, 1.0, 30.0, 3000.0}) {
        const auto value = [&](double shift) { return frac::power_response(realisation, order + shift, omega).value; };
        const Complex difference = (8.0 * (value(d) - value(-d)) - (value(2 * d) - value(-2 * d))) / (12 * d);
        const Complex exact = frac::power_response(realisation, order, omega).by_order;
        EXPECT_LT(std::abs(difference - exact), 1e-8 * (std::abs(exact) + std::abs(value(0))))
            << frac::to_string(realisation) << ", order " << order << ", omega " << omega;
      }
    }
  }
}

// The whole part of an Oustaloup power is exact; a Gruenwald-Letnikov difference of order 1 is (1 - e^{-jx})/h.
TEST(Realisation, WholeOrdersOfTheRealisations) {
  EXPECT_EQ(frac::power_response(all_realisations[1], 2, 5.0).value, Complex(-25, 0));
  const Complex difference = (1.0 - std::polar(1.0, -0.005)) / 1e-3;
  // 1 - e^{-jx} as written here loses 1/x = 200 eps.
  EXPECT_LT(relative_error(frac::power_response(all_realisations[2], 1, 5.0).value, difference), 500 * eps);
  EXPECT_LT(relative_error(frac::power_response(all_realisations[3], 1, 5.0).value, difference), 500 * eps);
}

TEST(Realisation, NamesAreThoseOfTheCommandLine) {
  EXPECT_EQ(frac::to_string(all_realisations[0]), "exact");
  EXPECT_EQ(frac::to_string(all_realisations[1]), "oustaloup");
  EXPECT_EQ(frac::to_string(all_realisations[2]), "grunwald-letnikov");
}

TEST(Realisation, RefusesMembersOutOfRange) {
  const auto validate = [](const frac::Realisation& realisation) { frac::validate(realisation); };
  for (const frac::Realisation& realisation : all_realisations) EXPECT_NO_THROW(validate(realisation));
  expect_invalid_argument([&] { validate(frac::OustaloupRealisation{{-1, 1}, 5}); }, {"band = -1 to 1"});
  expect_invalid_argument([&] { validate(frac::OustaloupRealisation{{1, 2}, -5}); }, {"poles = -5"});
  expect_invalid_argument([&] { validate(frac::GrunwaldLetnikovRealisation{0, 5}); }, {"sample_time = 0"});
  expect_invalid_argument([&] { validate(frac::GrunwaldLetnikovRealisation{INFINITY, 5}); }, {"sample_time = inf"});
  expect_invalid_argument(
      [&] {
        validate(frac::GrunwaldLetnikovRealisation{1, 10'000'001});
      },
      {"memory_length = 10000001"});
}

TEST(Realisation, RefusesOrdersAndFrequenciesOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto power = [](const frac::Realisation& realisation, double order, double omega) {
    (void)frac::power_response(realisation, order, omega);
  };
  for (const frac::Realisation& realisation : all_realisations) {
    expect_invalid_argument([&] { power(realisation, nan, 1); }, {"order = nan"});
    expect_invalid_argument([&] { power(realisation, 0.5, 0); }, {"omega = 0"});
    expect_invalid_argument([&] { power(realisation, 0.5, -1); }, {"omega = -1"});
    expect_invalid_argument([&] { power(realisation, 0.5, nan); }, {"omega = nan"});
  }
  EXPECT_NO_THROW(power(all_realisations[0], 30, 1));
  expect_invalid_argument([&] { power(all_realisations[1], 30, 1); }, {"order = 30"});
  expect_invalid_argument([&] { power(all_realisations[2], -30, 1); }, {"order = -30"});
  expect_invalid_argument([&] { power(all_realisations[2], 0.5, 3142); }, {"omega = 3142"});
  EXPECT_NO_THROW(power(all_realisations[2], 0.5, std::numbers::pi / 1e-3));
}

}  // namespace
