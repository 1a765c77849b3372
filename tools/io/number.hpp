// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace io {

/// Shortest decimal text that reads back as the same double; "nan", "inf" and "-inf" for the rest.
[[nodiscard]] std::string format_number(double value);
void append_number(std::string& text, double value);

/// The whole text as a double, independent of the locale; nan and inf are accepted, a number beyond the range of a
/// double gives an infinity.  Empty when the text is no number.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// Whether parse_number() takes the text, several times faster where it is a plain decimal number.
[[nodiscard]] bool is_number(std::string_view text);

/// The whole text as a whole number >= 0, in digits (2000) or as a number that is one exactly (2e3) and below 2^53.
[[nodiscard]] std::optional<std::uint64_t> parse_count(std::string_view text);

}  // namespace io
