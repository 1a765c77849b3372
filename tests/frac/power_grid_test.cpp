// SPDX-License-Identifier: BSD-3-Clause
#include "realisation/power_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "special/exact_power.hpp"

namespace {

using frac::detail::PowerGrid;

/// Within `reach` decades of 1.
std::vector<double> wide_grid(double reach) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> decades(-reach, reach);
  std::vector<double> omega{1, 2, 0.5, std::nextafter(1.0, 0), std::nextafter(1.0, 2), std::sqrt(0.5)};
  for (int i = 0; i < 500; ++i) omega.push_back(std::pow(10, decades(generator)));
  return omega;
}

// Against long double powers.  The product order times the rest of the logarithm (at most 1/2, in units of ln 2) and
// the logarithm itself are each off by 2^-54 of it, the exponential and the last product by 3 units of 2^-53: (3 +
// |order| ln 2) 2^-53.
TEST(PowerGrid, PowersAreRightToAFewUnitsOfTheLastPlace) {
  // 20 * 14 decades stay within the range of double.
  const std::vector<double> omega = wide_grid(14);
  PowerGrid grid;
  grid.prepare(omega);
  std::vector<double> power(omega.size());
  for (const double order : {0.1, -0.3, 0.7, 1.3, -1.9, 2.2, 2.5708, 3.999, -4.0, 12.3, 20.0, 1e-9}) {
    grid.powers(order, 0, power);
    for (std::size_t i = 0; i < omega.size(); ++i) {
      const long double exact = std::pow(static_cast<long double>(omega[i]), static_cast<long double>(order));
      const double error = static_cast<double>(std::abs(power[i] / exact - 1));
      EXPECT_LE(error, (3 + std::abs(order) * 0.7) * 0x1p-53) << omega[i] << "^" << order;
    }
  }
}

TEST(PowerGrid, TakesAnyPartOfTheGridAndANewGrid) {
  const std::vector<double> omega{0.1, 3, 7, 20};
  PowerGrid grid;
  grid.prepare(omega);
  std::vector<double> part(2);
  grid.powers(0.6, 1, part);
  EXPECT_NEAR(part[0], std::pow(3, 0.6), 1e-15);
  EXPECT_NEAR(part[1], std::pow(7, 0.6), 2e-15);
  const std::vector<double> other{0.1, 3, 7, 21};
  grid.prepare(other);
  grid.powers(0.6, 2, part);
  EXPECT_NEAR(part[1], std::pow(21, 0.6), 4e-15);
  EXPECT_EQ(grid.log_omega()[3], std::log(21.0));
}

TEST(PowerGrid, IsExactWhereRealPowerIsAndOverflowsLikeIt) {
  const std::vector<double> omega = wide_grid(300);
  PowerGrid grid;
  grid.prepare(omega);
  std::vector<double> power(omega.size());
  for (const double order : {-1.0, 0.0, 0.5, 1.0, 2.0, 20.0, -20.0}) {
    grid.powers(order, 0, power);
    for (std::size_t i = 0; i < omega.size(); ++i) {
      const double expected = frac::detail::real_power(omega[i], order);
      if (std::abs(order) > 2 && std::isnormal(expected)) continue;
      EXPECT_EQ(power[i], expected) << omega[i] << "^" << order;
    }
  }
}

}  // namespace
