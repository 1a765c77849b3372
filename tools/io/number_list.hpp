// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

namespace io {

/// Comma list "10,20,30" of finite numbers.
/// @param what  name of the quantity for messages, e.g. "--force"
/// @throws std::invalid_argument  empty, or an entry that is no finite number.
[[nodiscard]] std::vector<double> parse_list(std::string_view text, std::string_view what);

/// Grid "from:to:count" (equal steps), "from:to:countlog" (equal ratios, from > 0), or a comma list taken as it is.
/// Both ends are hit exactly.
/// @throws std::invalid_argument  as parse_list, or from >= to, count < 2 or above ten million, from <= 0 with log.
[[nodiscard]] std::vector<double> parse_grid(std::string_view text, std::string_view what);

}  // namespace io
