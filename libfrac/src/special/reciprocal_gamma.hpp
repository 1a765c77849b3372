// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace frac::detail {

/// 1/Gamma(x), entire: 0 at 0, -1, -2, ...
[[nodiscard]] double reciprocal_gamma(double x);

[[nodiscard]] long double reciprocal_gamma(long double x);

}  // namespace frac::detail
