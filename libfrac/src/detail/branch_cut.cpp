#include "branch_cut.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace frac::detail {

BranchCut best_cut(const LaplaceImage& image, double enough, double advantage) {
  constexpr double pi = std::numbers::pi;
  const auto half_width = [&](double angle) {
    double width = std::min(angle - pi / 2, 1.5 * pi - angle);
    for (const RootCluster& pole : image.poles().clusters) {
      width = std::min(width, std::abs(angle - pole.log_s.imag()) - pole.spread);
    }
    return width;
  };
  const BranchCut plain{pi, half_width(pi)};
  if (plain.half_width > enough) return plain;
  BranchCut best = plain;
  for (int i = 1; i < 400; ++i) {
    const double angle = pi / 2 + pi * i / 400;
    if (half_width(angle) > std::max(advantage * plain.half_width, best.half_width)) best = {angle, half_width(angle)};
  }
  return best;
}

}  // namespace frac::detail
