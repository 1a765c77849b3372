// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "formula/expression.hpp"

namespace frac::detail {

struct PossiblePoles {
  std::vector<double> log_tau;  // rising
  std::size_t left_off;         // the shortest of a series, which are too many
};

/// Places s = -1/tau between two times at which a formula may have a pole, from its operations: a quotient has those of
/// its dividend and the zeros of its divisor, tanh those where its argument is an odd multiple of j pi/2, a sum those
/// of its terms.  Zeros of a sum are sought between its own poles.  Some cancel in the whole: what is no pole of it is
/// in the list as well.
/// @param first,last  ln tau
[[nodiscard]] PossiblePoles possible_poles(const Expression& expression, std::span<const double> parameters,
                                           double first, double last);

}  // namespace frac::detail
