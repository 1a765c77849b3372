// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "frac/cancellation.hpp"

namespace frac::detail {

/// A function's value and derivative, both times the same positive factor, which may differ from point to point.
struct ValueAndSlope {
  std::complex<double> value;
  std::complex<double> slope;
};

// A zero of multiplicity m at distance d makes |f'/f| about m/d: steps of length below 0.7 |f/f'| at both ends cannot
// pass one unseen.
template <typename Function>
double phase_change(const Function& f, std::complex<double> from, std::complex<double> to, const ValueAndSlope& at_from,
                    const ValueAndSlope& at_to, int depth) {
  const double change = std::arg(at_to.value / at_from.value);
  const double length = std::abs(to - from);
  if (std::abs(change) < 1 && std::abs(at_from.slope) * length < 0.7 * std::abs(at_from.value) &&
      std::abs(at_to.slope) * length < 0.7 * std::abs(at_to.value)) {
    return change;
  }
  throw_if_cancelled();
  if (depth == 0 || !std::isfinite(change)) return std::numeric_limits<double>::quiet_NaN();
  const std::complex<double> middle = (from + to) / 2.0;
  const ValueAndSlope at_middle = f(middle);
  const double first_half = phase_change(f, from, middle, at_from, at_middle, depth - 1);
  if (std::isnan(first_half)) return first_half;
  return first_half + phase_change(f, middle, to, at_middle, at_to, depth - 1);
}

/// Change of arg f along the closed polygon over 2 pi: the zeros inside less the poles, for f that gives ValueAndSlope
/// and is analytic about the path.  NaN where the path runs into a zero.
template <typename Function>
[[nodiscard]] double winding_number(const Function& f, const std::vector<std::complex<double>>& polygon) {
  double total = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::complex<double> from = polygon[i];
    const std::complex<double> to = polygon[(i + 1) % polygon.size()];
    total += phase_change(f, from, to, f(from), f(to), 40);
    if (std::isnan(total)) break;
  }
  return total / (2 * std::numbers::pi);
}

}  // namespace frac::detail
