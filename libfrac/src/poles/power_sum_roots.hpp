// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <string_view>
#include <vector>

#include "formula/power_sum.hpp"

namespace frac::detail {

/// One root of a cluster, or several that coincide.
struct ClusterMember {
  std::complex<double> offset;  // from the middle of the cluster, in ln s
  int multiplicity;
};

/// Roots of a sum of powers that lie together, closer than 1e-3 in ln s, or one root.
struct RootCluster {
  std::complex<double> log_s = 0;  // a root, or the middle of several
  int multiplicity = 0;
  /// Largest distance of a member from log_s, in ln s; 0 where they coincide to rounding.
  double spread = 0;
  /// Its own complex conjugate: real, or a pair about the positive real axis.
  bool is_conjugate = false;
  /// The members coincide exactly, which was shown without rounding: a multiple root of a polynomial on the imaginary
  /// axis, or a root of a factor to a power.
  bool is_exact = false;
  /// Empty for one root and where they coincide to rounding.
  std::vector<ClusterMember> members = {};
};

/// By rising argument, as all lists of clusters are.
[[nodiscard]] inline bool by_argument(const RootCluster& a, const RootCluster& b) {
  return a.log_s.imag() != b.log_s.imag() ? a.log_s.imag() < b.log_s.imag() : a.log_s.real() < b.log_s.real();
}

struct PowerSumRoots {
  std::vector<RootCluster> clusters;  // by rising argument
  /// Every root the argument principle counts was found; if not, `clusters` may lack some.
  bool complete = true;
  /// Why it is not complete, as a part of a sentence.
  std::string_view trouble = "";
};

/// Roots with 0 <= arg s <= largest_argument (rad, may exceed pi: further sheets), by rising argument; those below the
/// real axis are the conjugates.  Counted by the argument principle on rectangles of the ln s plane, halved until each
/// holds one root or one cluster, and polished by Newton's method.
[[nodiscard]] PowerSumRoots power_sum_roots(const std::vector<PowerTerm>& sum, double largest_argument);

/// Roots of a product: those of each factor, as often as its power says.
/// @param together  distance in ln s below which roots of different factors make one cluster
[[nodiscard]] PowerSumRoots power_sum_roots(const PowerProduct& product, double largest_argument,
                                            double together = 1e-3);

/// The same roots, with clusters merged until the partial fractions of the rest are not much larger than their sum.  A
/// circle about a cluster then has no other pole near it.  Roots on the negative axis are not merged with those beside
/// it.
[[nodiscard]] std::vector<RootCluster> without_crowds(std::vector<RootCluster> clusters);

}  // namespace frac::detail
