// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "branch_cut.hpp"
#include "poles/laplace_image.hpp"

namespace frac::detail {

/// The original of an image at single instants t > 0 by two methods that judge each other: residues with the integral
/// along a turned branch cut, and a parabola that scales with 1/t.
class InverseLaplace {
 public:
  explicit InverseLaplace(LaplaceImage image);

  [[nodiscard]] const LaplaceImage& image() const noexcept { return y; }

  struct Value {
    double value;           // infinite beyond the range of a double
    double error_estimate;  // from rounding, or the difference of the methods
    bool confirmed;         // they agree within their rounding and no pole is missing
  };
  [[nodiscard]] Value operator()(double t) const;

 private:
  struct Estimate {
    double value;
    double rounding;
  };
  [[nodiscard]] Estimate by_cut(double t) const;
  [[nodiscard]] Estimate by_parabola(double t) const;

  LaplaceImage y;
  BranchCut cut;
  LaplaceImage::OriginExpansion early;
  // With more terms, those that vanish for t > 0 among them: late responses to relative accuracy.
  LaplaceImage::OriginExpansion late;
};

}  // namespace frac::detail
