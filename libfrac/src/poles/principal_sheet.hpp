// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/stability.hpp"

namespace frac::detail {

/// Margin of arg s about pi/2 within which rounding of the coefficients decides.
inline constexpr double axis_width = 1e-9;

/// analyse_stability() without the roots on other sheets, which are expensive where orders have a small common divisor.
[[nodiscard]] StabilityAnalysis analyse_principal_sheet(const FractionalTransferFunction& model);

}  // namespace frac::detail
