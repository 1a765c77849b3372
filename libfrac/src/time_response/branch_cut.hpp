// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>

#include "poles/laplace_image.hpp"

namespace frac::detail {

/// The ray arg s = angle, in (pi/2, 3 pi/2), along which the branch cut runs.  half_width is that of the strip of ln s
/// about it that holds no pole and where e^{st} does not grow: the trapezoidal rule in ln|s| with step h has an error
/// of e^{-2 pi half_width/h}.
struct BranchCut {
  double angle;
  double half_width;
};

/// The ray in the middle between the imaginary axis and the negative one, where all poles may lie.
[[nodiscard]] BranchCut cut_beside_negative_axis();

/// Poles that the strip must not hold: all of them, or only multiple ones and those close to each other.
enum class Avoided { all, crowded };

/// The negative axis, where nothing oscillates, unless its strip is narrower than `enough` and another ray's wider by
/// the factor `advantage`.
[[nodiscard]] BranchCut best_cut(const LaplaceImage& image, double enough, double advantage,
                                 Avoided avoided = Avoided::all);

/// Exponent 2 pi half_width/step that a rule needs to err by e^-digits beside a pole of that multiplicity, where it
/// errs by (2 pi/step)^(multiplicity-1) times what it does at a simple one.
[[nodiscard]] double digits_beside_pole(double digits, double half_width, int multiplicity);

/// The largest multiplicity of the poles, 1 without any.
[[nodiscard]] int largest_multiplicity(const LaplaceImage& image);

/// The trapezoidal rule in ln s along a cut, for lags of at least `earliest`.  A simple pole may lie in its strip, even
/// on the cut.  The rule then misses the share 1/(1 - e^{-w}) of the residue of that pole, w = 2 pi i (ln s -
/// node)/step: all of it where the pole lies well before the cut, almost nothing where it lies well beyond.  The share
/// follows from the residues of 1/(e^w - 1) at the nodes and at the pole.
class CutRule {
 public:
  /// @param tolerance  what the rule errs by, relative to its largest parts
  CutRule(const LaplaceImage& image, double earliest, double tolerance);
  /// Along a cut beside which there are no poles.
  CutRule(const BranchCut& cut, double earliest, double tolerance);

  [[nodiscard]] double angle() const noexcept { return cut_.angle; }
  [[nodiscard]] double step() const noexcept { return step_; }
  /// ln s of node k by falling |s|; from k = 0 on those that have not decayed at the earliest lag.
  [[nodiscard]] std::complex<double> node(int k) const { return {upper_ - k * step_, cut_.angle}; }
  /// The share of its residue that a pole adds to what the quadrature rule gives.  It is analytic within every circle
  /// about the pole that holds no node.
  [[nodiscard]] std::complex<double> share(std::complex<double> log_s) const;
  /// The same at the middle of cluster k: exactly 1 or 0 where the rule does not see it.
  [[nodiscard]] std::complex<double> share_of(const RootCluster& pole) const;
  /// Distance to the nearest node, in ln s.
  [[nodiscard]] double distance(std::complex<double> log_s) const;

 private:
  CutRule(const BranchCut& cut, double earliest, double tolerance, int multiplicity);

  BranchCut cut_;
  double step_;
  double upper_;
};

}  // namespace frac::detail
