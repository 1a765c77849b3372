// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace io {

/// The text as one field of comma-separated values: in quotes, with its quotes doubled, where it holds a comma or a
/// quote, or would otherwise be taken for a comment.  Line breaks become blanks, so that a row is one line.
[[nodiscard]] std::string csv_field(std::string_view text);

/// The fields of one line, quotes removed; empty when a quote is not closed or does not end its field.
[[nodiscard]] std::optional<std::vector<std::string>> split_csv_line(std::string_view line);

}  // namespace io
