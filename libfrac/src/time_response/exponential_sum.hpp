// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "poles/laplace_image.hpp"

namespace frac::detail {

/// weight e^{rate t}.
template <typename Weight>
struct ExponentialTerm {
  std::complex<double> rate;
  Weight weight;
  bool is_direct = false;  // see ExponentialSum
};
using Exponential = ExponentialTerm<std::complex<double>>;

/// y is the function of time whose Laplace transform is `image`.  For lags of at least `earliest` its j-fold integral
/// is
///   sum_(i<=j) constants_i t^(j-i)/(j-i)! + Re sum weight rate^-j (e^{rate t} - 1 - ... - (rate t)^j/j!).
/// Nodes that have decayed before `earliest` leave only the constants beyond the first.
///
/// A direct term contributes Re weight (e^{rate t} - 1) to the m-fold integral.  Terms that decay within the horizon
/// may be direct where only that integral counts: integrated m times they would leave polynomials much larger than the
/// response.  These are part of the first m constants then.
struct ExponentialSum {
  std::vector<Exponential> terms;
  std::vector<double> constants;
  double size = 0;  // largest |y| of some instants of the horizon, of its m-fold integral over latest^m
};

enum class FastTerms { integrated, direct };

/// On earliest <= t <= latest, within `tolerance` of the largest |y| there; where parts of the sum are larger and
/// cancel they are made as much more accurate, down to rounding.  The image is s^q, q > -2, at the origin.
/// @param integrations  m, if what counts is the m-fold integral of y, in which fast terms weigh less
/// @param constants     how many are wanted, one at least
/// @param fast          of fast terms, in the m-fold integral
[[nodiscard]] ExponentialSum exponential_sum(const LaplaceImage& image, double earliest, double latest,
                                             double tolerance, std::size_t integrations, std::size_t constants,
                                             FastTerms fast = FastTerms::integrated);

/// Size of what a term contributes to the m-fold integral by the end of the horizon, over latest^m.
[[nodiscard]] double effect(double weight, double rate, double latest, std::size_t integrations);

/// Where constants are read from the image: ln s at `count` points of the positive axis at the scale of the horizon,
/// away from poles.
[[nodiscard]] std::vector<double> log_anchors(const std::vector<RootCluster>& poles, double latest, std::size_t count);

}  // namespace frac::detail
