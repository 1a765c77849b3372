// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "local_solve.hpp"

namespace frac::detail {

/// Bounded Levenberg-Marquardt on normal equations, without a loss, for scouts.  They are judged from afar, so that
/// digits which normal equations lose are of no account, and they are so many and so short that problems of Ceres would
/// take half as long again as the model.
/// Beside a parameter that presses against its bound the others may stop short of the minimum: a step is judged by what
/// it would gain beyond the bound.
[[nodiscard]] LocalSolution normal_solve(const Residuals& residuals, const std::vector<double>& start,
                                         const LocalOptions& options);

}  // namespace frac::detail
