// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/structure.hpp"

namespace frac::detail {

/// Two parts of a formula that may change places: exchanging the parameters of each pair leaves the model as it is, as
/// with the arcs of R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2).  Pairs are in order of appearance; the first of each
/// pair belongs to the part whose name comes first.
struct Interchange {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  bool single_powers;  // the parts are products, such as b1 s^a1 and b2 s^a2, and no sums
};

[[nodiscard]] std::vector<Interchange> interchanges(const Structure& structure);

/// The model with its labels in a fixed order, from the part named first: rising orders of
/// single powers, rising time constants of other parts, rising values of the first parameter of those that have
/// neither.  Parts that a fixed value, a start, a prior or an order tells
/// apart keep their labels, and so do parts one of which has a value beyond the limits of the other.
[[nodiscard]] std::vector<double> with_labels_in_order(const Structure& structure,
                                                       std::span<const ParameterConstraint> constraints,
                                                       std::vector<double> parameters);

}  // namespace frac::detail
