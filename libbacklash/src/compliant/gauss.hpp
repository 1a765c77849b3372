// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

namespace backlash::detail {

/// Nodes and weights of Gauss on [-1, 1], 12 of them: pieces of flights are polynomials of degree 18 and exponentials
/// that turn by less than some radians, whose squares it integrates to rounding.
struct GaussRule {
  std::array<double, 6> node{0.1252334085114689, 0.3678314989981802, 0.5873179542866175,
                             0.7699026741943047, 0.9041172563704749, 0.9815606342467193};
  std::array<double, 6> weight{0.2491470458134028, 0.2334925365383548, 0.2031674267230659,
                               0.1600783285433462, 0.1069393259953184, 0.0471753363865118};
};

/// Calls visit(t, weight) at the nodes on [0, length]; the weights are those of an integral over half of the length.
template <class Visit>
void visit_gauss_nodes(double length, const Visit& visit) {
  static constexpr GaussRule rule;
  for (std::size_t i = 0; i < rule.node.size(); ++i)
    for (const double sign : {-1.0, 1.0}) visit(0.5 * length * (1 + sign * rule.node[i]), rule.weight[i]);
}

}  // namespace backlash::detail
