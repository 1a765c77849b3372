// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "backlash/jump_frequency.hpp"

namespace report {

/// Similarity constant of the jump at each restitution; NaN where this criterion shows no jump.
[[nodiscard]] std::vector<double> jump_constants(backlash::JumpCriterion criterion,
                                                 const std::vector<double>& restitutions, int threads);

struct Mean {
  double value;      // NaN where nothing was averaged
  std::size_t used;  // count
};

/// Mean of the values that are no NaN.
[[nodiscard]] Mean mean_of(const std::vector<double>& values);

}  // namespace report
