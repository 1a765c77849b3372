// SPDX-License-Identifier: BSD-3-Clause
#include "report/jump_constants.hpp"

#include <cmath>
#include <limits>

#include "frac/parallel_for.hpp"

namespace report {

std::vector<double> jump_constants(backlash::JumpCriterion criterion, const std::vector<double>& restitutions,
                                   int threads) {
  std::vector<double> constants(restitutions.size(), std::numeric_limits<double>::quiet_NaN());
  frac::parallel_for(constants.size(), threads, [&](std::size_t i) {
    const auto jump = backlash::jump_similarity_constant(restitutions[i], criterion);
    if (jump.similarity_constant) constants[i] = *jump.similarity_constant;
  });
  return constants;
}

Mean mean_of(const std::vector<double>& values) {
  double sum = 0;
  std::size_t used = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value;
    ++used;
  }
  return {used > 0 ? sum / static_cast<double>(used) : std::numeric_limits<double>::quiet_NaN(), used};
}

}  // namespace report
