// SPDX-License-Identifier: BSD-3-Clause
#include "branch_cut.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "special/phi_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
// Residues of poles d apart in ln s are as large as 1/d and known to rounding/d^2.
constexpr double crowd = 0.1;

}  // namespace

BranchCut best_cut(const LaplaceImage& image, double enough, double advantage, Avoided avoided) {
  const std::vector<RootCluster>& poles = image.poles().clusters;
  const auto half_width = [&](double angle) {
    double width = std::min(angle - pi / 2, 1.5 * pi - angle);
    for (std::size_t k = 0; k < poles.size(); ++k) {
      const RootCluster& pole = poles[k];
      if (avoided == Avoided::crowded && pole.multiplicity == 1 && image.clearance(k) > crowd) continue;
      width = std::min(width, std::abs(angle - pole.log_s.imag()) - pole.spread);
    }
    return width;
  };
  const BranchCut plain{pi, half_width(pi)};
  if (plain.half_width > enough) return plain;
  BranchCut best = plain;
  // Of integer orders the poles lie alike on either side of pi, and so do the widths.  The ray before pi is then taken,
  // whatever the rounding: close poles beyond it add nothing, those before it large residues of either sign.
  constexpr double rounding = 1e-12;
  for (int i = 1; i < 400; ++i) {
    const double angle = pi / 2 + pi * i / 400;
    const double width = half_width(angle);
    if (width > std::max(advantage * plain.half_width, best.half_width + rounding)) best = {angle, width};
  }
  return best;
}

BranchCut cut_beside_negative_axis() {
  return {0.75 * pi, 0.25 * pi};
}

double digits_beside_pole(double digits, double half_width, int multiplicity) {
  return digits + (multiplicity - 1) * std::log(digits / half_width);
}

int largest_multiplicity(const LaplaceImage& image) {
  int multiplicity = 1;
  for (const RootCluster& pole : image.poles().clusters) multiplicity = std::max(multiplicity, pole.multiplicity);
  return multiplicity;
}

// A complex term costs as much as two real ones.
CutRule::CutRule(const LaplaceImage& image, double earliest, double tolerance)
    : CutRule(best_cut(image, 0.7, 2, Avoided::crowded), earliest, tolerance, largest_multiplicity(image)) {
  // Places the nodes as far from the poles as possible: beside a pole the weight of the node and the share of the
  // residue would both grow and cancel.
  constexpr int shifts = 16;
  const double fastest = upper_;
  double farthest = -1;
  double best = fastest;
  for (int i = 0; i < shifts; ++i) {
    upper_ = fastest + step_ * i / shifts;
    double nearest = step_;
    for (const RootCluster& pole : image.poles().clusters) nearest = std::min(nearest, distance(pole.log_s));
    if (nearest > farthest) {
      farthest = nearest;
      best = upper_;
    }
  }
  upper_ = best;
}

CutRule::CutRule(const BranchCut& cut, double earliest, double tolerance) : CutRule(cut, earliest, tolerance, 1) {}

CutRule::CutRule(const BranchCut& cut, double earliest, double tolerance, int multiplicity) : cut_(cut) {
  const double digits = digits_beside_pole(std::log(1 / tolerance) + 3, cut_.half_width, multiplicity);
  step_ = 2 * pi * 0.97 * cut_.half_width / digits;
  upper_ = std::log(digits / (-std::cos(cut_.angle) * earliest));
}

Complex CutRule::share(Complex log_s) const {
  const Complex w = Complex(0, 2 * pi) * (log_s - node(0)) / step_;
  return w.real() > 0 ? -1.0 / expm1(-w) : std::exp(w) / expm1(w);
}

Complex CutRule::share_of(const RootCluster& pole) const {
  const double beyond = pole.log_s.imag() - cut_.angle;
  if (pole.multiplicity > 1 || std::abs(beyond) > cut_.half_width + step_) return beyond < 0 ? 1 : 0;
  return share(pole.log_s);
}

double CutRule::distance(Complex log_s) const {
  const Complex steps = (log_s - node(0)) / step_;
  return step_ * std::abs(steps - std::round(steps.real()));
}

}  // namespace frac::detail
