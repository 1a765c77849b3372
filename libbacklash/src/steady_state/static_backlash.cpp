// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/static_backlash.hpp"

#include <cmath>
#include <numbers>

#include "base/check.hpp"

namespace backlash {

std::complex<double> static_backlash(double gain, double clearance, double amplitude) {
  detail::require_positive("gain", "", gain);
  detail::require_not_negative("clearance", "m", clearance);
  detail::require_positive("amplitude", "m", amplitude);
  constexpr double pi = std::numbers::pi;
  const double ratio = clearance / amplitude;
  if (ratio >= 2) return 0;
  const double u = 1 - ratio;
  // 1 - u^2 without cancellation at large amplitudes.
  const double root = std::sqrt(ratio * (2 - ratio));
  // pi/2 + asin u, without cancellation where the output only just begins to move (u -> -1).
  const double angle = std::atan2(root, -u);
  return {gain / pi * (angle + u * root), -2 * gain * ratio * (1 - ratio / 2) / pi};
}

std::vector<std::complex<double>> static_describing_function(double mass1, double mass2, double clearance,
                                                             double force_amplitude, const std::vector<double>& omega) {
  detail::require_positive("mass1", "kg", mass1);
  detail::require_positive("mass2", "kg", mass2);
  detail::require_not_negative("clearance", "m", clearance);
  detail::require_positive("force_amplitude", "N", force_amplitude);
  detail::require_frequency_grid(omega);
  std::vector<std::complex<double>> result;
  result.reserve(omega.size());
  for (const double w : omega) {
    const double amplitude = force_amplitude / (mass1 + mass2) / w / w;
    result.push_back(-static_backlash(1, clearance, amplitude) / ((mass1 + mass2) * w * w));
  }
  return result;
}

}  // namespace backlash
