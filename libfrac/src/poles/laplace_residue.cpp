// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>

#include "laplace_image.hpp"
#include "scaled_sum.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

// Adds up the residues of numerator/denominator weight at the members of a cluster of poles.
class ClusterResidue {
 public:
  ClusterResidue(const PowerProduct& numerator, const PowerProduct& denominator, const RootCluster& pole,
                 const LaplaceImage::Weight& weight, double weight_rate)
      : numerator_(numerator), denominator_(denominator), pole_(pole), weight_(weight), weight_rate_(weight_rate) {}

  [[nodiscard]] LaplaceImage::Sum sum() const { return sum_; }

  // A simple pole at `offset` from the middle of the cluster.
  void add_simple(Complex offset, double clearance) {
    const Complex zeta = pole_.log_s + offset;
    const ScaledSum top = scaled_sum(numerator_, zeta);
    const ScaledSum bottom = scaled_sum(denominator_, zeta);
    const Complex part =
        top.value / bottom.slope * std::exp(top.scale - bottom.scale + zeta) * weight_(pole_.log_s, offset);
    // The rounding of the sum shifts the root, and with it weight and slope.
    const double shift = bottom.magnitude / std::abs(bottom.slope) * (1 + weight_rate_ + 1 / clearance);
    sum_.value += copies_ * part.real();
    sum_.rounding += copies_ * std::abs(part) * (4 + 2 * shift + 2 * top.magnitude / std::abs(top.value));
  }

  // A circle about several poles, wide against their spread, small against the way to the next pole and against the
  // length over which the weight changes: 64 points then leave nothing of the next orders.
  void add_circle(Complex middle, int multiplicity, double spread, double clearance) {
    const double radius = radius_of(multiplicity, spread, clearance);
    const bool coincide = spread == 0 && !is_factored_;
    const double scale = scaled_sum(denominator_, pole_.log_s).scale;
    // How far the rounding of the coefficients may move the members apart; nothing where they coincide exactly.
    double unsure = 0;
    if (coincide && !pole_.is_exact) {
      const TaylorStart start = taylor_start(denominator_.terms, pole_.log_s, multiplicity);
      for (std::size_t j = start.rounding.size(); j-- > 0;) unsure = unsure * radius + start.rounding[j];
    }
    // The rule errs by the powers of both ratios.
    const double ratio = is_factored_ ? std::max(spread / radius, radius / clearance) : 0.5;
    const int points = std::max(64, static_cast<int>(std::ceil(-40 / std::log(ratio))));
    for (int i = 0; i < points; ++i) {
      const Complex turn = std::polar(radius, 2 * std::numbers::pi * (i + 0.5) / points);
      const Complex offset = middle + turn;
      const Complex zeta = pole_.log_s + offset;
      const ScaledSum top = scaled_sum(numerator_, zeta);
      Complex bottom;
      double bottom_scale = scale;
      double relative_rounding = 0;
      if (coincide) {
        const DeflatedSum rest = deflated_sum(denominator_.terms, pole_.log_s, offset, multiplicity);
        bottom = rest.value;
        relative_rounding = (4 * rest.magnitude + unsure) / std::abs(bottom);
      } else {
        const ScaledSum whole = scaled_sum(denominator_, zeta);
        bottom = whole.value;
        bottom_scale = whole.scale;
        relative_rounding = whole.magnitude / std::abs(bottom);
      }
      const Complex part = top.value / bottom * std::exp(top.scale - bottom_scale + zeta) *
                           weight_(pole_.log_s, offset) * turn / static_cast<double>(points);
      sum_.value += copies_ * part.real();
      sum_.rounding += copies_ * std::abs(part) * (8 + weight_rate_ + relative_rounding);
    }
  }

 private:
  [[nodiscard]] double radius_of(int multiplicity, double spread, double clearance) const {
    const double widest = std::min(0.5 * clearance, std::min(0.3, 3 / weight_rate_));
    const double farthest = std::min({0.7 * clearance, 0.9, 3 / weight_rate_});
    // The parts on the circle cancel least where |weight/offset^m| hardly varies.  A wide circle is better where
    // rounding of the coefficients hides where the members lie.
    const double flat = is_factored_ ? multiplicity / weight_rate_ : 1 / weight_rate_;
    const double narrow = pole_.is_exact || is_factored_ ? flat : widest;
    return std::max(std::min(widest, narrow), is_factored_ ? std::min(4 * spread, farthest) : 4 * spread);
  }

  const PowerProduct& numerator_;
  const PowerProduct& denominator_;
  const RootCluster& pole_;
  const LaplaceImage::Weight& weight_;
  double weight_rate_;
  bool is_factored_ = denominator_.is_factored();
  double copies_ = pole_.is_conjugate ? 1 : 2;
  LaplaceImage::Sum sum_ = {};
};

}  // namespace

LaplaceImage::Sum LaplaceImage::residue(std::size_t k, const Weight& weight, double weight_rate) const {
  const RootCluster& pole = poles_.clusters[k];
  ClusterResidue residue(numerator_, denominator_, pole, weight, weight_rate);
  if (pole.multiplicity == 1) {
    residue.add_simple(0, clearance_[k]);
    return residue.sum();
  }
  const double widest = denominator_.is_factored() ? std::min({0.7 * clearance_[k], 0.9, 3 / weight_rate}) / 1.5
                                                   : std::min({0.5 * clearance_[k], 0.3, 3 / weight_rate}) / 4;
  if (pole.members.empty() || widest >= pole.spread) {
    residue.add_circle(0, pole.multiplicity, pole.spread, clearance_[k]);
    return residue.sum();
  }
  // The weight changes between the members, so that no circle about all of them will do: each has its own.
  for (std::size_t i = 0; i < pole.members.size(); ++i) {
    const auto [offset, multiplicity] = pole.members[i];
    double clearance = clearance_[k];
    for (std::size_t j = 0; j < pole.members.size(); ++j) {
      if (j != i) clearance = std::min(clearance, std::abs(offset - pole.members[j].offset));
    }
    if (multiplicity == 1) {
      residue.add_simple(offset, clearance);
    } else {
      residue.add_circle(offset, multiplicity, 0, clearance);
    }
  }
  return residue.sum();
}

}  // namespace frac::detail
