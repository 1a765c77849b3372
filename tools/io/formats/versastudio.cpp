// SPDX-License-Identifier: BSD-3-Clause
// Princeton Applied Research VersaStudio (.par): sections in angle brackets; <SegmentN> names its columns after
// "Definition=" and holds the rows.  Columns of a second voltage input, Z2, are left alone.
#include <algorithm>

#include "io/column_name.hpp"
#include "io/data_error.hpp"
#include "io/fields.hpp"
#include "io/formats/format.hpp"

namespace io {
namespace {

constexpr std::string_view definition = "Definition=";

bool has_frequency(const TextLayout& layout) {
  return std::any_of(layout.columns.begin(), layout.columns.end(), [](const TextLayout::Column& column) {
    return column_meaning(column.name).quantity == Quantity::frequency;
  });
}

}  // namespace

std::optional<Recognised> read_versastudio(const Source& source) {
  const std::string& text = *source.text;
  if (!text.starts_with('<') || text.find("<Segment") == std::string::npos) return std::nullopt;
  Recognised found{"VersaStudio", {}, {}, "ohm"};
  LineReader lines(text);
  std::string segment;
  for (std::string_view line; lines.next(line);) {
    if (line.starts_with("<Segment")) segment = line.substr(1, line.find('>') - 1);
    if (line.starts_with("</Segment")) segment.clear();
    if (segment.empty() || !line.starts_with(definition)) continue;
    TextLayout layout{source.text, named_columns(line.substr(definition.size()), ',', lines.number())};
    layout.separator = ',';
    // The last name is a 0 that no field belongs to.
    if (layout.columns.size() > 1 && layout.columns.back().name == "0") layout.columns.pop_back();
    layout.begin = layout.end = lines.after();
    layout.first_line = lines.number() + 1;
    while (lines.next(line) && !line.starts_with('<')) layout.end = std::min(lines.after(), text.size());
    if (!has_frequency(layout) || layout.begin >= layout.end) {
      found.notes.push_back(segment + " holds no spectrum");
      segment.clear();
      continue;
    }
    found.sweeps.push_back({segment, std::move(layout)});
    segment.clear();
  }
  if (found.sweeps.empty())
    throw DataError(source.file, 0, 0, "is a VersaStudio file without a spectrum; expected a segment with a frequency");
  return found;
}

}  // namespace io
