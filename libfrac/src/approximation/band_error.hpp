// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
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

/// Returns the coordinate at which `f` is largest: the largest of the values at `points`, which rise, or the maximum
/// that Brent's method finds between its neighbours.  Its place is good to half the digits of a double, which leaves
/// the value good to all of them.
/// @param values  of f at the points
template <typename Real, typename Function>
[[nodiscard]] Real refined_maximum(const std::vector<Real>& points, const std::vector<Real>& values,
                                   const Function& f) {
  const auto place = static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
  constexpr int bits = 24;
  const auto [at, negative] = boost::math::tools::brent_find_minima(
      [&](Real each) -> Real { return -f(each); }, points[place == 0 ? 0 : place - 1],
      points[std::min(place + 1, points.size() - 1)], bits);
  return -negative > values[place] ? at : points[place];
}

/// Measures `ratio`, a function of a coordinate of the band, at rising points; the largest relative deviation is
/// refined between its neighbours.
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
