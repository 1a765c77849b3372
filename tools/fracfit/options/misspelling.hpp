// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fracfit {

/// " (did you mean WORD?)" with the known word that differs in the fewest letters (left out, put in, replaced or
/// swapped with the next), if these are few; empty otherwise.
[[nodiscard]] std::string suggestion(std::string_view text, const std::vector<std::string>& known);

}  // namespace fracfit
