// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fracfit {

[[nodiscard]] bool output_is_terminal();

/// Characters of a line on standard output: those of the terminal, 80 where it is none or does not tell.
[[nodiscard]] std::size_t terminal_width();

/// Whether standard output is a terminal that shows colours, and none of NO_COLOR and TERM=dumb asks for none.
[[nodiscard]] bool shows_colours();

/// A text for people with its words that warn in red and its verdicts in bold.  Nothing else changes.
[[nodiscard]] std::string in_colours(std::string_view text);

}  // namespace fracfit
