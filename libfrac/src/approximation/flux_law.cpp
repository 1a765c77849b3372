// SPDX-License-Identifier: BSD-3-Clause
#include "flux_law.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace frac::detail {

FluxLaw::FluxLaw(double half_width) : half_width_(half_width) {
  double arithmetic = 1;
  double geometric = std::exp(-half_width);
  mean_ = {1};
  difference_ = {std::sqrt(-std::expm1(-2 * half_width))};
  // The mean converges quadratically: what is left of the difference is its square.
  while (difference_.back() > 1e-9) {
    difference_.push_back((arithmetic - geometric) / 2);
    const double next = (arithmetic + geometric) / 2;
    geometric = std::sqrt(arithmetic * geometric);
    arithmetic = next;
    mean_.push_back(arithmetic);
  }
}

// v at F/K = share.  a tan(am(share K)) by Gauss's descending transformation (Abramowitz and Stegun 16.4); above one
// half v(1 - share) = 1/v(share), which keeps full precision where the amplitude comes close to pi/2.
double FluxLaw::scaled_tangent(double share) const {
  if (share > 0.5) return 1 / scaled_tangent(1 - share);
  double amplitude = std::ldexp(share * std::numbers::pi / 2, static_cast<int>(mean_.size()) - 1);
  for (std::size_t n = mean_.size() - 1; n > 0; --n) {
    amplitude = (amplitude + std::asin(difference_[n] / mean_[n] * std::sin(amplitude))) / 2;
  }
  return std::exp(-half_width_ / 2) * std::tan(amplitude);
}

double FluxLaw::position(double share) const {
  const double v = scaled_tangent(std::abs(share));
  return std::copysign(std::asinh(v * std::sqrt(v * v + 2 * std::cosh(half_width_))), share);
}

std::vector<double> FluxLaw::band_grid(int count) const {
  // On the slit the same function appears as w = v e^(-half_width/2), and the side that faces the negative axis is
  // 0 <= w <= 1.
  const double tip = std::exp(half_width_ / 2);
  double below = 0.5;
  double above = 1;
  for (int i = 0; i < 50; ++i) {
    const double middle = (below + above) / 2;
    (scaled_tangent(middle) < tip ? below : above) = middle;
  }
  std::vector<double> grid(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double w = scaled_tangent(below * i / (count - 1)) / tip;
    grid[static_cast<std::size_t>(i)] = std::asinh(2 * std::sinh(half_width_) * w / (1 + w * w));
  }
  grid.back() = half_width_;
  return grid;
}

}  // namespace frac::detail
