// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/approximation/approximate.hpp"

namespace frac::detail {

/// Partial fractions of `system` without its whole power of s, all of whose poles are simple.
/// @param system_error  largest relative error of `system` as a stand-in for s^fractional_order on the band
[[nodiscard]] ParallelForm parallel_form(const ZeroPoleGain& system, double fractional_order, FrequencyBand band,
                                         double system_error);

}  // namespace frac::detail
