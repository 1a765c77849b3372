// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace frac::detail {

/// Shortest decimal text that reads back as the same double, independent of the locale.
[[nodiscard]] std::string number_text(double value);

}  // namespace frac::detail
