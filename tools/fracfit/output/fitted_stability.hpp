// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "frac/identification/fit.hpp"
#include "frac/stability.hpp"

namespace fracfit {

/// Stability of a fitted model; nothing where it is no ratio of sums of powers of s.
[[nodiscard]] std::optional<frac::StabilityAnalysis> fitted_stability(const frac::FitResult& fit);

/// A sentence with the poles right of the imaginary axis, for whoever runs the model in time; empty where there are
/// none.
[[nodiscard]] std::string remark_on_stability(const std::optional<frac::StabilityAnalysis>& analysis);

}  // namespace fracfit
