// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/approximation/approximate.hpp"

namespace frac::detail {

/// Partial fractions of `system` without its whole power of s; all its poles are simple.
[[nodiscard]] ParallelForm parallel_form(const ZeroPoleGain& system);

}  // namespace frac::detail
