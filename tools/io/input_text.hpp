// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace io {

/// All bytes of a file; "-" is standard input.  What can be read only once, such as a pipe, a terminal or the
/// shell's <(command), is kept, so that every later reader gets the same bytes.  Safe to use from several threads.
/// @throws DataError  missing, a folder, or unreadable.
[[nodiscard]] std::shared_ptr<const std::string> input_text(const std::string& file);

/// Its lines without their line ends.  A last line without one was cut off while it was written and is left out.
[[nodiscard]] std::vector<std::string> whole_lines(std::string_view text);

}  // namespace io
