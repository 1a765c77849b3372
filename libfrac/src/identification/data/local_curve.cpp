// SPDX-License-Identifier: BSD-3-Clause
#include "local_curve.hpp"

#include <algorithm>
#include <cmath>

namespace frac::detail {

LocalCurve local_curve(std::span<const double> log_omega, std::span<const std::size_t> usable, std::size_t point) {
  constexpr std::size_t on_a_side = 2, at_an_end = 3;
  // Each stands in its place if all are usable.
  const bool in_place = point < usable.size() && usable[point] == point;
  const auto below =
      in_place ? point
               : static_cast<std::size_t>(std::lower_bound(usable.begin(), usable.end(), point) - usable.begin());
  const std::size_t above = below + (below < usable.size() && usable[below] == point ? 1 : 0);
  const std::size_t right_most = usable.size() - above;
  const bool inside = below >= on_a_side && right_most >= on_a_side;
  const std::size_t wanted = inside ? 2 * on_a_side : at_an_end;
  const std::size_t left = std::min(below, std::max(on_a_side, wanted - std::min(wanted, right_most)));
  const std::size_t right = std::min(right_most, wanted - std::min(wanted, left));
  LocalCurve curve;
  for (std::size_t i = below - left; i < below; ++i) curve.neighbour[curve.count++] = usable[i];
  for (std::size_t i = above; i < above + right; ++i) curve.neighbour[curve.count++] = usable[i];
  double square = 1;
  for (std::size_t i = 0; i < curve.count; ++i) {
    double over = 1, under = 1;
    for (std::size_t k = 0; k < curve.count; ++k) {
      if (k == i) continue;
      over *= log_omega[point] - log_omega[curve.neighbour[k]];
      under *= log_omega[curve.neighbour[i]] - log_omega[curve.neighbour[k]];
    }
    curve.weight[i] = over / under;
    square += curve.weight[i] * curve.weight[i];
  }
  curve.noise = std::sqrt(square);
  return curve;
}

}  // namespace frac::detail
