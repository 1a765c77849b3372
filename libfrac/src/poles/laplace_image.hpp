// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
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
  using Weight = std::function<std::complex<double>(std::complex<double> zeta, std::complex<double> offset)>;
  /// Sum of the residues of Y(s) weight(s) at pole k and at its conjugate; a real pole counts once.
  /// @param weight       called as weight(zeta, offset) for ln s = zeta + offset, zeta the middle of the cluster;
  ///                     analytic there and real on the real axis
  /// @param weight_rate  about |d ln weight / d ln s|
  [[nodiscard]] Sum residue(std::size_t k, const Weight& weight, double weight_rate) const;

 private:
  PowerProduct numerator_;
  PowerProduct denominator_;
  PowerSumRoots poles_;
  std::vector<double> clearance_;  // of each cluster, in ln s
  double lowest_corner_ = 0;
  double highest_corner_ = 0;
};

}  // namespace frac::detail
