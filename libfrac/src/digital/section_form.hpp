// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/digital/discretise.hpp"

namespace frac::detail {

/// gain prod (s + zeros_i)/(s + poles_i) with s = (1/T) delta/(1 + slope delta), delta = z - 1, in first-order
/// sections: a root at -p lies at delta = -rate, rate = p T/(1 + slope p T).  slope 1/2 is the bilinear rule, 7/8
/// Al-Alaoui's, 1 the backward difference.
class SectionForm {
 public:
  /// @param system  real roots <= 0, as many zeros as poles, poles negative and distinct.
  SectionForm(const ZeroPoleGain& system, double sample_time, double slope);

  [[nodiscard]] DeltaCascade cascade() const;
  [[nodiscard]] ParallelSections parallel() const;

 private:
  using Extended = long double;
  [[nodiscard]] Extended rate(Extended root) const { return root * time_ / (1 + slope_ * root * time_); }
  // rate(zero) - rate(pole) without cancellation.
  [[nodiscard]] Extended between(Extended zero, Extended pole) const {
    return (zero - pole) * time_ / ((1 + slope_ * zero * time_) * (1 + slope_ * pole * time_));
  }

  Extended time_;
  Extended slope_;
  Extended gain_;
  std::vector<Extended> zeros_;  // -zero, by falling size
  std::vector<Extended> poles_;
};

}  // namespace frac::detail
