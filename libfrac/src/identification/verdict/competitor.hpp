// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "frac/identification/identify.hpp"

namespace frac::detail {

/// A ranked candidate with what a verdict needs beside.
struct Competitor {
  RankedFit ranked;
  std::vector<double> residual;  // weighted
  /// What FamilyMembers says of a member of a family.
  double departed = std::numeric_limits<double>::infinity();
  std::size_t relaxations = 0;
  bool approximates = false;
  bool stands_in = false;      // for an unstable member of its family, which takes part in the verdict
  bool passive = false;        // a sum of passive elements, which takes no part in it
  bool is_such_a_sum = false;  // a preset that is the same model as one of these
  /// What find_integer_limits() says, when it is asked for: comparing formulas takes some milliseconds.
  std::function<double()> from_integer_limit = [] { return std::numeric_limits<double>::infinity(); };

  [[nodiscard]] bool is_fractional() const { return ranked.model_class == ModelClass::fractional; }
  [[nodiscard]] double parameters() const { return static_cast<double>(ranked.fit.free_parameters); }
};

}  // namespace frac::detail
