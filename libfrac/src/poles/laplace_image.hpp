// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "power_sum_roots.hpp"

namespace frac::detail {

/// d ln|N/D| / d ln|s| of the terms that dominate at |s| = e^log_radius.
[[nodiscard]] double dominant_slope(const std::vector<PowerTerm>& numerator, const std::vector<PowerTerm>& denominator,
                                    double log_radius);

/// Y(s) = numerator/denominator, both sums of real powers, on the Riemann surface of ln s, with its poles in the upper
/// half up to arg s = 3 pi/2.
class LaplaceImage {
 public:
  LaplaceImage(std::vector<PowerTerm> numerator, std::vector<PowerTerm> denominator);

  [[nodiscard]] const std::vector<PowerTerm>& numerator() const noexcept { return numerator_; }
  [[nodiscard]] const std::vector<PowerTerm>& denominator() const noexcept { return denominator_; }
  [[nodiscard]] const PowerSumRoots& poles() const noexcept { return poles_; }

  /// Y e^exponent at s = e^zeta, without overflow on the way.
  [[nodiscard]] std::complex<double> value(std::complex<double> zeta, std::complex<double> exponent = 0) const;

  /// Distance of cluster k from the next, or from its own conjugate, in ln s.
  [[nodiscard]] double clearance(std::size_t k) const noexcept { return clearance_[k]; }

  /// ln of the largest numerator term over the largest denominator term at |s| = e^log_radius.
  [[nodiscard]] double log_magnitude(double log_radius) const;
  /// d ln|Y| / d ln|s| of the terms that dominate there.
  [[nodiscard]] double slope(double log_radius) const;
  /// ln|s| below which one term dominates each sum.
  [[nodiscard]] double lowest_corner() const noexcept { return lowest_corner_; }
  [[nodiscard]] double highest_corner() const noexcept { return highest_corner_; }
  /// The lowest ln|s| that a step response up to `latest` notices at a relative tolerance: that of the record, or a
  /// corner below it that adds to the response.  An order near 0 has corners so low that nothing ever does.
  [[nodiscard]] double lowest_noticed(double latest, double tolerance) const;

  /// Terms c s^q with q <= limit that Y has at the origin, and the numerator of what remains; their leading terms
  /// cancel exactly.
  struct OriginExpansion {
    std::vector<PowerTerm> terms;
    std::vector<PowerTerm> remainder;  // over the same denominator; may be empty
  };
  [[nodiscard]] OriginExpansion origin_expansion(double limit) const;

  struct Sum {
    double value = 0;
    double rounding = 0;  // bound of the error in units of the rounding unit
  };
  /// Sum over pole k and, unless it is its own, its conjugate of the residues of Y(s) weight.  weight(zeta, offset) is
  /// taken at ln s = zeta + offset, zeta the middle of the cluster, analytic there and real on the real axis;
  /// |d ln weight / d ln s| is about `weight_rate`.
  template <typename Weight>
  [[nodiscard]] Sum residue(std::size_t k, const Weight& weight, double weight_rate) const;

 private:
  std::vector<PowerTerm> numerator_;
  std::vector<PowerTerm> denominator_;
  PowerSumRoots poles_;
  std::vector<double> clearance_;  // of each cluster from the next, in ln s
  double lowest_corner_ = 0;
  double highest_corner_ = 0;
};

template <typename Weight>
LaplaceImage::Sum LaplaceImage::residue(std::size_t k, const Weight& weight, double weight_rate) const {
  const RootCluster& pole = poles_.clusters[k];
  const double copies = pole.is_conjugate ? 1 : 2;
  Sum sum;
  const auto add_simple = [&](std::complex<double> offset, double clearance) {
    const std::complex<double> zeta = pole.log_s + offset;
    const ScaledSum top = scaled_sum(numerator_, zeta);
    const ScaledSum bottom = scaled_sum(denominator_, zeta);
    const std::complex<double> part =
        top.value / bottom.slope * std::exp(top.scale - bottom.scale + zeta) * weight(pole.log_s, offset);
    // The rounding of the sum shifts the root, and with it weight and slope.
    const double shift = bottom.magnitude / std::abs(bottom.slope) * (1 + weight_rate + 1 / clearance);
    sum.value += copies * part.real();
    sum.rounding += copies * std::abs(part) * (4 + 2 * shift + 2 * top.magnitude / std::abs(top.value));
  };
  if (pole.multiplicity == 1) {
    add_simple(0, clearance_[k]);
    return sum;
  }
  // A circle about the cluster, wide against its spread, small against the way to the next pole and against the length
  // over which the weight changes: 64 points then leave nothing of the next orders.
  const double widest = std::min(0.5 * clearance_[k], std::min(0.3, 3 / weight_rate));
  if (widest < 4 * pole.spread && !pole.members.empty()) {
    // No such circle: the weight tells the members from each other.
    for (std::size_t i = 0; i < pole.members.size(); ++i) {
      double clearance = clearance_[k];
      for (std::size_t j = 0; j < pole.members.size(); ++j) {
        if (j != i) clearance = std::min(clearance, std::abs(pole.members[i] - pole.members[j]));
      }
      add_simple(pole.members[i], clearance);
    }
    return sum;
  }
  const bool coincide = pole.spread == 0;
  // The parts on it cancel least where the weight changes by e; coefficients in doubt want it wide.
  const double narrow = pole.is_exact ? 1 / weight_rate : widest;
  const double radius = std::max(std::min(widest, narrow), 4 * pole.spread);
  const double scale = scaled_sum(denominator_, pole.log_s).scale;
  // How far the rounding of the coefficients may move the members apart; nothing where they coincide exactly.
  double unsure = 0;
  if (coincide && !pole.is_exact) {
    const TaylorStart start = taylor_start(denominator_, pole.log_s, pole.multiplicity);
    for (std::size_t j = start.rounding.size(); j-- > 0;) unsure = unsure * radius + start.rounding[j];
  }
  constexpr int points = 64;
  for (int i = 0; i < points; ++i) {
    const std::complex<double> offset = std::polar(radius, 2 * std::numbers::pi * (i + 0.5) / points);
    const std::complex<double> zeta = pole.log_s + offset;
    const ScaledSum top = scaled_sum(numerator_, zeta);
    std::complex<double> bottom;
    double bottom_scale = scale;
    double relative_rounding = 0;
    if (coincide) {
      const DeflatedSum rest = deflated_sum(denominator_, pole.log_s, offset, pole.multiplicity);
      bottom = rest.value;
      relative_rounding = (4 * rest.magnitude + unsure) / std::abs(bottom);
    } else {
      const ScaledSum whole = scaled_sum(denominator_, zeta);
      bottom = whole.value;
      bottom_scale = whole.scale;
      relative_rounding = whole.magnitude / std::abs(bottom);
    }
    const std::complex<double> part = top.value / bottom * std::exp(top.scale - bottom_scale + zeta) *
                                      weight(pole.log_s, offset) * offset / static_cast<double>(points);
    sum.value += copies * part.real();
    sum.rounding += copies * std::abs(part) * (8 + weight_rate + relative_rounding);
  }
  return sum;
}

}  // namespace frac::detail
