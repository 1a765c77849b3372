// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loss_factor.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "base/check.hpp"

namespace backlash {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

double loss_factor(const TwoMassSystem& system, std::complex<double> minus_inverse_n1, double omega) {
  return minus_inverse_n1.imag() / ((system.mass1() + system.mass2()) * omega * omega);
}

double frequency_ratio(const TwoMassSystem& system, double force_amplitude, double omega) {
  return omega * std::sqrt(system.mass2() * system.clearance() / force_amplitude);
}

double symmetric_loss_factor(double restitution) {
  return least_loss_factor(restitution, 2);
}

double least_loss_factor(double restitution, double impacts_per_period) {
  detail::require_restitution(restitution);
  // That of infinitely many is 0.
  if (impacts_per_period != infinity) detail::require_positive("impacts per period", "", impacts_per_period);
  return pi / (2 * impacts_per_period) * (1 - restitution) / (1 + restitution);
}

std::optional<double> restitution_from_loss_factor(double loss_factor) {
  const double share = 4 * loss_factor / pi;
  if (!(share >= 0 && share <= 1)) return std::nullopt;
  return (1 - share) / (1 + share);
}

}  // namespace backlash
