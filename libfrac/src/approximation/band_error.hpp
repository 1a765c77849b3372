// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "frac/cancellation.hpp"

namespace frac::detail {

/// How far a ratio H/G departs from 1 on a band.
template <typename Real>
struct BandError {
  Real relative = 0;  // largest |H/G - 1|; infinite where the ratio is not a number
  Real place = 0;     // coordinate at which it is reached
  Real decibels = 0;  // largest |20 log10 |H/G||
  Real degrees = 0;   // largest |arg(H/G)|
};

/// Height of the parabola through a value and its neighbours; the value itself where that has no summit.
template <typename Real>
[[nodiscard]] Real summit(const std::vector<Real>& points, const std::vector<Real>& values, std::size_t at) {
  if (at == 0 || at + 1 == values.size()) return values[at];
  const Real before = (values[at] - values[at - 1]) / (points[at] - points[at - 1]);
  const Real after = (values[at + 1] - values[at]) / (points[at + 1] - points[at]);
  const Real curvature = (after - before) / (points[at + 1] - points[at - 1]);
  const Real slope = before + curvature * (points[at] - points[at - 1]);
  const Real height = values[at] - slope * slope / (4 * curvature);
  return curvature < 0 && std::isfinite(height) ? height : values[at];
}

/// Returns the coordinate at which `f` is largest: of the values at `points`, which rise, or between them.  Turns of
/// equal height are common, and the highest point need not lie in the highest turn: every turn whose parabola may be
/// the highest is searched by Brent's method between its neighbours.  Its place is good to half the digits of a double,
/// which leaves the value good to all of them.
/// @param values  of f at the points
template <typename Real, typename Function>
[[nodiscard]] Real refined_maximum(const std::vector<Real>& points, const std::vector<Real>& values,
                                   const Function& f) {
  const auto highest = static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
  if (!std::isfinite(values[highest])) return points[highest];
  Real best = values[highest];
  Real place = points[highest];
  std::vector<std::pair<Real, std::size_t>> turns;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool rises = i == 0 || values[i] > values[i - 1];
    const bool falls = i + 1 == values.size() || values[i] >= values[i + 1];
    if (rises && falls) turns.emplace_back(summit(points, values, i), i);
  }
  std::sort(turns.rbegin(), turns.rend());
  // Of ten points to a turn, as cos x, the parabola misses (pi/10)^4/24 of its height.
  constexpr double between = 1e-3;
  for (const auto& [height, i] : turns) {
    if (height + Real(between) * std::abs(height) < best) break;
    constexpr int bits = 24;
    const auto [at, negative] =
        boost::math::tools::brent_find_minima([&](Real each) -> Real { return -f(each); }, points[i == 0 ? 0 : i - 1],
                                              points[std::min(i + 1, points.size() - 1)], bits);
    if (-negative > best) {
      best = -negative;
      place = at;
    }
  }
  return place;
}

/// Measures `ratio`, a function of a coordinate of the band, at rising points and, for the largest relative deviation,
/// between them.
template <typename Real, typename Ratio>
[[nodiscard]] BandError<Real> band_error(const std::vector<Real>& points, const Ratio& ratio) {
  const auto relative = [&](Real at) -> Real {
    const Real size = std::abs(ratio(at) - Real{1});
    return std::isnan(size) ? std::numeric_limits<Real>::infinity() : size;
  };
  BandError<Real> error;
  std::vector<Real> deviation;
  deviation.reserve(points.size());
  for (const Real at : points) {
    throw_if_cancelled();
    const std::complex<Real> value = ratio(at);
    const Real size = std::abs(value - Real{1});
    deviation.push_back(std::isnan(size) ? std::numeric_limits<Real>::infinity() : size);
    error.decibels = std::max(error.decibels, std::abs(20 * std::log10(std::abs(value))));
    error.degrees = std::max(error.degrees, std::abs(std::arg(value)) * 180 / std::numbers::pi_v<Real>);
  }
  error.place = refined_maximum(points, deviation, relative);
  error.relative = relative(error.place);
  return error;
}

}  // namespace frac::detail
