// SPDX-License-Identifier: BSD-3-Clause
#include "exact_power.hpp"

#include <cmath>
#include <numbers>

namespace frac::detail {

std::complex<double> quarter_turns(double order) {
  // Both subtractions are exact, so only the last angle, at most pi/4, is rounded.
  const double within_turn = order - 4 * std::nearbyint(order / 4);
  const double quarter = std::nearbyint(within_turn);
  const double angle = (within_turn - quarter) * (std::numbers::pi / 2);
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  if (quarter == 0) return {c, s};
  if (quarter == 1) return {0 - s, c};
  if (quarter == -1) return {s, -c};
  return {-c, 0 - s};
}

double real_power(double omega, double order) {
  if (order == 2) return omega * omega;
  if (order == 1) return omega;
  if (order == 0) return 1;
  if (order == -1) return 1 / omega;
  if (order == 0.5) return std::sqrt(omega);
  return std::pow(omega, order);
}

}  // namespace frac::detail
