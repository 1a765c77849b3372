// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "identification/residuals/frequency_problem.hpp"
#include "identification/statistics/confidence.hpp"

namespace frac::detail {

/// What the fitted component is blind to (a real constant in an imaginary part) is estimated from the other one, the
/// rest held, with intervals that carry the errors of the rest.
/// @param found     of the fit that `result` describes
/// @param cost      of that fit
/// @param fit_rest  the fit to the other component
void recover_unseen(FitResult& result, const Confidence& found, FrequencyProblem& problem, double cost,
                    const std::function<FitResult(const FitOptions&)>& fit_rest);

}  // namespace frac::detail
