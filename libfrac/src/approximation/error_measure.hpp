// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/approximation/approximate.hpp"

namespace frac::detail {

/// Error of `system`, without its whole power of s, as a stand-in for s^fractional_order on the band.
[[nodiscard]] ApproximationError measured_error(const ZeroPoleGain& system, double fractional_order,
                                                FrequencyBand band);

}  // namespace frac::detail
