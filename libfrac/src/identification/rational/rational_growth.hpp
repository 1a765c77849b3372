// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "rational_problem.hpp"

namespace frac::detail {

/// n ln(cost/n) + k ln n of a fit (Schwarz 1978), costs of rounding counted as rounding.
[[nodiscard]] double schwarz(const RationalProblem& problem, const RationalFit& fit);

/// What the search for the places of poles costs beside schwarz(), whose k ln n knows of one place only: 2 ln of the
/// number of places that the data tell apart.  These are the e-folds of the band for a real pole, and the points for a
/// pair, which can be as narrow as the distance between two of them and then meets their noise.
[[nodiscard]] double price_of_search(const RationalProblem& problem, const RationalShape& shape);

/// Rational fits of rising order, each started from the ones before with one or two poles more.
class RationalGrowth {
 public:
  /// @param excess  zeros that each member has more than poles
  RationalGrowth(const RationalProblem& problem, bool delayed, std::size_t excess = 0);

  /// Grows by one order.
  void extend();
  [[nodiscard]] const std::vector<RationalFit>& members() const { return members_; }  // by order, from 0

 private:
  const RationalProblem& problem_;
  std::size_t excess_;
  std::vector<RationalFit> members_;
};

/// The fit without what does not pay for itself by schwarz(): zeros beyond the band or far below it, one zero more than
/// poles, poles that are integrators.
[[nodiscard]] RationalFit without_idle_parts(const RationalProblem& problem, const RationalFit& fit);

/// The best of each order that was tried, simplest first, grown until neither of the last two orders paid by schwarz()
/// and price_of_search().
struct RationalLadder {
  std::vector<RationalFit> fits;
  std::size_t chosen = 0;
};
[[nodiscard]] RationalLadder grow_rational(const RationalProblem& problem, std::size_t fewest_poles,
                                           std::size_t most_poles, bool delayed);

/// That many zeros and poles.
[[nodiscard]] RationalFit fit_rational(const RationalProblem& problem, std::size_t zeros, std::size_t poles,
                                       bool delayed);

}  // namespace frac::detail
