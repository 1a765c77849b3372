// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "power_sum_roots.hpp"
#include "scaled_sum.hpp"

namespace frac::detail {

[[nodiscard]] inline PowerProduct numerator_of(const FractionalTransferFunction& model) {
  return {model.numerator_factors(), model.numerator()};
}
[[nodiscard]] inline PowerProduct denominator_of(const FractionalTransferFunction& model) {
  return {model.denominator_factors(), model.denominator()};
}

/// G tends to a multiple of s^order there.
[[nodiscard]] inline double order_at_origin(const FractionalTransferFunction& model) {
  return model.numerator().back().order - model.denominator().back().order;
}
[[nodiscard]] inline double order_at_infinity(const FractionalTransferFunction& model) {
  return model.numerator().front().order - model.denominator().front().order;
}

/// d ln|N/D| / d ln|s| of the terms that dominate at |s| = e^log_radius.
[[nodiscard]] double dominant_slope(const PowerProduct& numerator, const PowerProduct& denominator, double log_radius);

/// Y(s) = numerator/denominator, both sums of real powers, on the Riemann surface of ln s, with its poles in the upper
/// half up to arg s = 3 pi/2.
class LaplaceImage {
 public:
  LaplaceImage(PowerProduct numerator, PowerProduct denominator);
  LaplaceImage(std::vector<PowerTerm> numerator, std::vector<PowerTerm> denominator)
      : LaplaceImage(PowerProduct{{}, std::move(numerator)}, PowerProduct{{}, std::move(denominator)}) {}

  [[nodiscard]] const PowerProduct& numerator() const noexcept { return numerator_; }
  [[nodiscard]] const PowerProduct& denominator() const noexcept { return denominator_; }
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
  /// Lowest ln|s| that matters for a step response up to `latest` at a relative tolerance: that of 1/latest, or a
  /// corner below it that still contributes.  Orders near 0 have corners so low that they never do.
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
  /// Sum of the residues of Y(s) weight(s) at pole k and at its conjugate; a real pole counts once.
  /// @param weight       called as weight(zeta, offset) for ln s = zeta + offset, zeta the middle of the cluster;
  ///                     analytic there and real on the real axis
  /// @param weight_rate  about |d ln weight / d ln s|
  template <typename Weight>
  [[nodiscard]] Sum residue(std::size_t k, const Weight& weight, double weight_rate) const;

 private:
  PowerProduct numerator_;
  PowerProduct denominator_;
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
  // A circle about several poles, wide against their spread, small against the way to the next pole and against the
  // length over which the weight changes: 64 points then leave nothing of the next orders.
  const auto add_circle = [&](std::complex<double> middle, int multiplicity, double spread, double clearance) {
    const double widest = std::min(0.5 * clearance, std::min(0.3, 3 / weight_rate));
    const double farthest = std::min({0.7 * clearance, 0.9, 3 / weight_rate});
    const bool is_factored = denominator_.is_factored();
    const bool coincide = spread == 0 && !is_factored;
    // The parts on the circle cancel least where |weight/offset^m| hardly varies.  A wide circle is better where
    // rounding of the coefficients hides where the members lie.
    const double flat = is_factored ? multiplicity / weight_rate : 1 / weight_rate;
    const double narrow = pole.is_exact || is_factored ? flat : widest;
    const double radius = std::max(std::min(widest, narrow), is_factored ? std::min(4 * spread, farthest) : 4 * spread);
    const double scale = scaled_sum(denominator_, pole.log_s).scale;
    // How far the rounding of the coefficients may move the members apart; nothing where they coincide exactly.
    double unsure = 0;
    if (coincide && !pole.is_exact) {
      const TaylorStart start = taylor_start(denominator_.terms, pole.log_s, multiplicity);
      for (std::size_t j = start.rounding.size(); j-- > 0;) unsure = unsure * radius + start.rounding[j];
    }
    // The rule errs by the powers of both ratios.
    const double ratio = is_factored ? std::max(spread / radius, radius / clearance) : 0.5;
    const int points = std::max(64, static_cast<int>(std::ceil(-40 / std::log(ratio))));
    for (int i = 0; i < points; ++i) {
      const std::complex<double> turn = std::polar(radius, 2 * std::numbers::pi * (i + 0.5) / points);
      const std::complex<double> offset = middle + turn;
      const std::complex<double> zeta = pole.log_s + offset;
      const ScaledSum top = scaled_sum(numerator_, zeta);
      std::complex<double> bottom;
      double bottom_scale = scale;
      double relative_rounding = 0;
      if (coincide) {
        const DeflatedSum rest = deflated_sum(denominator_.terms, pole.log_s, offset, multiplicity);
        bottom = rest.value;
        relative_rounding = (4 * rest.magnitude + unsure) / std::abs(bottom);
      } else {
        const ScaledSum whole = scaled_sum(denominator_, zeta);
        bottom = whole.value;
        bottom_scale = whole.scale;
        relative_rounding = whole.magnitude / std::abs(bottom);
      }
      const std::complex<double> part = top.value / bottom * std::exp(top.scale - bottom_scale + zeta) *
                                        weight(pole.log_s, offset) * turn / static_cast<double>(points);
      sum.value += copies * part.real();
      sum.rounding += copies * std::abs(part) * (8 + weight_rate + relative_rounding);
    }
  };
  const double widest = denominator_.is_factored() ? std::min({0.7 * clearance_[k], 0.9, 3 / weight_rate}) / 1.5
                                                   : std::min({0.5 * clearance_[k], 0.3, 3 / weight_rate}) / 4;
  if (pole.members.empty() || widest >= pole.spread) {
    add_circle(0, pole.multiplicity, pole.spread, clearance_[k]);
    return sum;
  }
  // The weight changes between the members, so that no circle about all of them will do: each has its own.
  for (std::size_t i = 0; i < pole.members.size(); ++i) {
    const auto [offset, multiplicity] = pole.members[i];
    double clearance = clearance_[k];
    for (std::size_t j = 0; j < pole.members.size(); ++j) {
      if (j != i) clearance = std::min(clearance, std::abs(offset - pole.members[j].offset));
    }
    if (multiplicity == 1) {
      add_simple(offset, clearance);
    } else {
      add_circle(offset, multiplicity, 0, clearance);
    }
  }
  return sum;
}

}  // namespace frac::detail
