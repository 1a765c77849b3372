// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace frac::detail {

/// Why a formula cannot be read at a character outside the grammar, and what to write instead: Greek letters, signs of
/// typeset mathematics, brackets, backslashes.  Empty where nothing is known of it.
[[nodiscard]] std::string spelling_hint(std::string_view formula, std::size_t position);

}  // namespace frac::detail
