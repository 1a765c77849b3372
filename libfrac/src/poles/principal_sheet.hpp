// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/stability.hpp"

namespace frac::detail {

/// analyse_stability() without the roots on other sheets, which are expensive where orders have a small common divisor.
[[nodiscard]] StabilityAnalysis analyse_principal_sheet(const FractionalTransferFunction& model);

}  // namespace frac::detail
