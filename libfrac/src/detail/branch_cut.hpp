#pragma once

#include "laplace_image.hpp"

namespace frac::detail {

/// A ray arg s = angle in (pi/2, 3 pi/2) to which the branch cut is turned, and the half width of the strip of ln s
/// about it that holds no pole and no growth of e^{st}: the trapezoidal rule in ln|s| with step h errs by e^{-2 pi
/// width/h}.
struct BranchCut {
  double angle;
  double half_width;
};

/// The negative axis, where nothing oscillates, unless its strip is narrower than `enough` and another ray's wider by
/// the factor `advantage`.
[[nodiscard]] BranchCut best_cut(const LaplaceImage& image, double enough, double advantage);

}  // namespace frac::detail
