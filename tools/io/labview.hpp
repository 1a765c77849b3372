// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace io {

/// A segment of a LabVIEW measurement file (.lvm, National Instruments' specification of it) as the text of a table.
struct LabviewSegment {
  std::string text;      // fields with commas between them and quotes where they need them, a line per row
  std::size_t segments;  // of the file
};

/// The first segment that has rows; none where the text is no such file or has no rows.  Its axis becomes the column
/// time_s, f_Hz or X_Value, as X_Dimension and X_Unit_Label tell it, also where the file gives X0 and Delta_X alone;
/// units of channels stand behind their names.  Axes of several channels that are the same become one; comments are
/// left out.
[[nodiscard]] std::optional<LabviewSegment> labview_segment(std::string_view text);

}  // namespace io
