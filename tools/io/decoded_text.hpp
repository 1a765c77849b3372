// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

namespace io {

/// Bytes of a text file as UTF-8.
struct DecodedText {
  std::shared_ptr<const std::string> text;
  std::string note;  ///< which encoding was found, or which sheet of a workbook; empty for UTF-8
  bool is_of_workbook = false;
};

/// Takes away a byte-order mark, turns UTF-16 (with a mark, or told by its zero bytes) into UTF-8, and takes what is no
/// UTF-8 as Latin-1.  Of a workbook it is the text of a sheet, see workbook.hpp,
/// of a LabVIEW measurement file that of a segment, see labview.hpp.  Never fails: half a character at the
/// end, as in a file cut off, becomes a question mark.
[[nodiscard]] DecodedText decoded(std::shared_ptr<const std::string> bytes);

}  // namespace io
