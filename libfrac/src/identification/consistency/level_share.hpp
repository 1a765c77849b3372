// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace frac::detail {

// Each test gets this share of the level.  A seventh would do if weights and poles were known.  They are estimated from
// the same residuals, which makes alarms up to 1.4 times as frequent (measured, see the benchmark validity_rates).
inline constexpr double share_of_level = 0.1;

}  // namespace frac::detail
