// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "frac/approximation/approximate.hpp"
#include "frac/realisation.hpp"
#include "frac/structure.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/relative_error.hpp"

namespace {

using frac::LadderRealisation;
using support::expect_invalid_argument;
using support::log_grid;
using support::relative_error;
using Complex = std::complex<double>;

frac::PowerResponse power(const LadderRealisation& realisation, double order, double omega) {
  return frac::power_response(realisation, order, omega);
}

Complex exact(double order, double omega) {
  return frac::power_response(frac::ExactRealisation{}, order, omega).value;
}

double largest_error(const LadderRealisation& realisation, double order) {
  double largest = 0;
  for (const double omega : log_grid(realisation.band().lower, realisation.band().upper, 1000)) {
    largest = std::max(largest, relative_error(power(realisation, order, omega).value, exact(order, omega)));
  }
  return largest;
}

// The header allows a third above the least largest error, or 1e-7.
TEST(LadderRealisation, ErrorIsCloseToThatOfTheMinimaxLadder) {
  struct Choice {
    frac::FrequencyBand band;
    int poles;
  };
  for (const auto& [band, poles] : {Choice{{1e-2, 1e3}, 6},
                                    {{1e-3, 1e3}, 15},
                                    {{1e-6, 1e6}, 20},
                                    {{2, 9}, 4},
                                    {{1, 3.2}, 8},
                                    {{1e-2, 1e2}, 24},
                                    {{0.1, 10}, 15}}) {
    const LadderRealisation realisation(band, poles);
    for (const double order : {-2.3, -0.5, 0.003, 0.1, 0.35, 0.5, 0.77, 0.98, 0.9999, 1.5}) {
      const double least = frac::approximate(order, band, frac::PoleCount{poles}).error.max_relative;
      const double error = largest_error(realisation, order);
      EXPECT_LT(error, std::max(1.34 * least, 1e-7)) << "order " << order << ", " << poles << " poles";
      // The least largest error is itself found to 1.5 %.
      if (least > 1e-6) {
        EXPECT_GT(error, 0.98 * least);
      }
    }
  }
}

// Five-point difference with step d: error d^4/30 of the fifth derivative.  Inside the band that of H is that of
// (j omega)^order, |ln(j omega)|^5 < 8^5; outside the poles add terms of like size.  Rounding is eps/d of |H|.
TEST(LadderRealisation, DerivativeByTheOrderAgreesWithDifferences) {
  const LadderRealisation realisation({1e-3, 1e3}, 9);
  const double d = 1e-3;
  for (const double order : {-1.7, -0.45, 0.3, 0.77, 1.5, 2.6}) {
    for (const double omega : {1e-4, 0.02, 1.0, 30.0, 3000.0}) {
      const auto value = [&](double shift) { return power(realisation, order + shift, omega).value; };
      const Complex difference = (8.0 * (value(d) - value(-d)) - (value(2 * d) - value(-2 * d))) / (12 * d);
      const Complex by_order = power(realisation, order, omega).by_order;
      EXPECT_LT(std::abs(difference - by_order), 1e-7 * (std::abs(by_order) + std::abs(value(0))))
          << "order " << order << ", omega " << omega;
    }
  }
}

// At whole orders the ladder is exact, and the realised power approaches it from both sides: at 1 - h the error is that
// of the ladder, about 2 sin(pi h) 1e-4 here, and the power itself moves by h |ln(j omega)|, at most 8 h.
TEST(LadderRealisation, IsContinuousAtWholeOrders) {
  const LadderRealisation realisation({1e-3, 1e3}, 15);
  for (const double whole : {-1.0, 0.0, 1.0, 2.0}) {
    for (const double omega : {1e-3, 0.2, 1.0, 1e3}) {
      EXPECT_EQ(power(realisation, whole, omega).value, exact(whole, omega));
      for (const double h : {1e-3, 1e-6, 1e-12}) {
        // 1e-8 is the interpolation in the order.
        EXPECT_LT(relative_error(power(realisation, whole + h, omega).value, exact(whole, omega)), 9 * h + 1e-8);
        EXPECT_LT(relative_error(power(realisation, whole - h, omega).value, exact(whole, omega)), 9 * h + 1e-8);
      }
    }
  }
}

// Next to order 1 a pole goes to infinity; the derivative stays that of (j omega)^order to the error of the ladder.
TEST(LadderRealisation, DerivativeStaysFiniteNextToOrderOne) {
  const LadderRealisation realisation({1e-3, 1e3}, 15);
  for (const double from_one : {1e-3, 1e-6, 1e-9, 1e-12}) {
    for (const double omega : log_grid(1e-3, 1e3, 13)) {
      const Complex by_order = power(realisation, 1 - from_one, omega).by_order;
      const Complex expected = exact(1, omega) * Complex(std::log(omega), std::numbers::pi / 2);
      // 2 pi 1.3e-4 is the slope of the error 2 sin(pi a) exp(-pi^2 15/(ln 1e6 + 4 ln 2)); half as much again for this
      // not being the minimax ladder, and the power's own curvature |ln(j omega)|^2 < 60.
      EXPECT_LT(std::abs(by_order - expected), omega * (1.3e-3 + 60 * from_one)) << from_one << " " << omega;
    }
  }
}

TEST(LadderRealisation, OrderAndItsNegativeAreReciprocal) {
  const LadderRealisation realisation({1e-3, 1e3}, 9);
  for (const double omega : log_grid(1e-5, 1e5, 21)) {
    const Complex product = power(realisation, 0.3, omega).value * power(realisation, -0.3, omega).value;
    EXPECT_LT(std::abs(product - 1.0), 1e-15);
  }
}

TEST(LadderRealisation, ServesInAStructure) {
  const LadderRealisation realisation({1e-4, 1e4}, 30);
  const frac::Structure structure("K/(T s^a + 1)");
  const double parameters[] = {2, 0.7, 0.6};
  Complex gradient[3];
  Complex exact_gradient[3];
  for (const double omega : {1e-3, 0.4, 20.0}) {
    const Complex value = structure.response_and_gradient(parameters, omega, realisation, gradient);
    const Complex reference =
        structure.response_and_gradient(parameters, omega, frac::ExactRealisation{}, exact_gradient);
    // Thirty poles over eight decades: 2 exp(-pi^2 30/21.2) = 2e-6.
    EXPECT_LT(relative_error(value, reference), 3e-6);
    for (int i = 0; i < 3; ++i) EXPECT_LT(relative_error(gradient[i], exact_gradient[i]), 3e-5) << i;
  }
}

TEST(LadderRealisation, ComparesAndIsNamed) {
  const LadderRealisation one({1, 10}, 2);
  EXPECT_EQ(one, LadderRealisation({1, 10}, 2));
  EXPECT_FALSE(one == LadderRealisation({1, 10}, 3));
  EXPECT_EQ(frac::to_string(frac::Realisation(one)), "ladder");
  EXPECT_NO_THROW(frac::validate(frac::Realisation(one)));
}

TEST(LadderRealisation, RefusesWhatIsOutOfRange) {
  expect_invalid_argument([] { (void)LadderRealisation({2, 1}, 3); }, {"ladder", "band = 2 to 1"});
  expect_invalid_argument([] { (void)LadderRealisation({NAN, 1}, 3); }, {"band = nan to 1"});
  expect_invalid_argument([] { (void)LadderRealisation({1, 3}, 3); }, {"0.5 to 24 decades"});
  expect_invalid_argument([] { (void)LadderRealisation({1, 1e25}, 3); }, {"0.5 to 24 decades"});
  expect_invalid_argument([] { (void)LadderRealisation({1, 100}, 0); }, {"poles = 0"});
  // (ln 100 + 4 ln 2)/pi^2 ln(2e8) = 14.3.
  expect_invalid_argument([] { (void)LadderRealisation({1, 100}, 16); }, {"poles = 16", "1 to 15"});
  expect_invalid_argument([] { (void)frac::power_response(LadderRealisation({1, 100}, 2), 21, 1); }, {"order = 21"});
}

}  // namespace
