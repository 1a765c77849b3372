// SPDX-License-Identifier: BSD-3-Clause
// Scribner ZPlot and ZView (.z): settings, the names of the columns, "End Comments", rows.  A file of several sweeps
// repeats all of it.
#include "io/fields.hpp"
#include "io/formats/format.hpp"

namespace io {

std::optional<Recognised> read_zview(const Source& source) {
  const std::string& text = *source.text;
  if (text.find("End Comments") == std::string::npos) return std::nullopt;
  Recognised found{"ZView", {}, {}, "ohm"};
  LineReader lines(text);
  std::string_view names;
  std::size_t names_line = 0;
  std::vector<std::string_view> fields;
  bool within_rows = false;
  for (std::string_view line; lines.next(line);) {
    const auto content = trimmed(line);
    if (content == "End Comments") {
      if (names.empty())
        throw DataError(source.file, lines.number(), 1, "found 'End Comments' with no names of columns above");
      TextLayout layout{source.text, named_columns(names, separator_of(trimmed(names)), names_line)};
      layout.separator = separator_of(trimmed(names));
      layout.begin = layout.end = lines.after();
      layout.first_line = lines.number() + 1;
      found.sweeps.push_back({"sweep " + std::to_string(found.sweeps.size() + 1), std::move(layout)});
      within_rows = true;
      continue;
    }
    if (content.empty()) continue;
    names = line;
    names_line = lines.number();
    if (!within_rows) continue;
    split_by(content, separator_of(content), fields);
    within_rows = holds_a_number({fields.front()}) || has_decimal_commas({fields.front()});
    if (within_rows) std::get<TextLayout>(found.sweeps.back().content).end = std::min(lines.after(), text.size());
  }
  std::erase_if(found.sweeps, [](const Sweep& sweep) {
    const auto& layout = std::get<TextLayout>(sweep.content);
    return layout.begin >= layout.end;
  });
  if (found.sweeps.empty())
    throw DataError(source.file, lines.number(), 0, "holds no rows below 'End Comments'; the file is cut off");
  for (auto& sweep : found.sweeps) settle_decimal_commas(std::get<TextLayout>(sweep.content), found);
  return found;
}

}  // namespace io
