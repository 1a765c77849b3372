// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace io {

/// A sheet of a workbook as Excel and others write it (.xlsx, Office Open XML), as the text of a table.
struct Sheet {
  std::string text;  // fields with commas between them and quotes where they need them, a line per row
  std::string name;
  std::size_t sheets;  // of the workbook
};

/// The first sheet that has cells; none where the bytes are no workbook, or a damaged one, or this program was built
/// without libzip.  Numbers stand as the file stores them, with their point; of formulas the value that was saved.
[[nodiscard]] std::optional<Sheet> first_sheet(std::string_view bytes);

}  // namespace io
