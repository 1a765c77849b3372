// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace frac::detail {

/// Priors weigh against the residuals by the noise that these tell, so that the solution moves until that stays.
/// @param found   what the curvature says of the solution with the priors weighed by `weight`
/// @param solved  what it says of the solution with the weight that is handed to it
template <class Found, class Solved>
[[nodiscard]] Found weighed_by_noise(Found found, double weight, const Solved& solved) {
  constexpr double least = 1e-9;  // of the data: noise of exact data, which priors still complete
  constexpr double settled = 1e-4;
  constexpr int most_rounds = 20;
  for (int round = 0; round < most_rounds && found.loss_unit >= 0; ++round) {
    const double noise = std::max(std::sqrt(found.loss_unit), least);
    if (std::abs(noise - weight) <= settled * noise) break;
    weight = noise;
    found = solved(noise);
  }
  return found;
}

}  // namespace frac::detail
