// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "frac/identification/joint_fit.hpp"

namespace frac::detail {

/// A fit of each curve alone, one entry per curve; none where a curve does not determine all parameters or the search
/// found nothing.  A few curves are searched from everywhere, the others from where those ended, and from everywhere
/// only where that leaves far more than it did in those.
[[nodiscard]] std::vector<std::optional<FitResult>> fit_alone(const std::vector<JointCurve>& curves,
                                                              const Structure& structure,
                                                              const JointFitOptions& options);

}  // namespace frac::detail
