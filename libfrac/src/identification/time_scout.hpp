// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/identification/time_fit.hpp"

namespace frac::detail {

/// Where a quick local solve from the starts in the constraints ended: some iterations of simulations good to 1e-6.
struct Scouted {
  std::vector<double> parameters;
  double cost;  // as in FitResult; infinite where the start has no finite response
};
/// @param options  every free parameter has a start
[[nodiscard]] Scouted scouted(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options);

}  // namespace frac::detail
