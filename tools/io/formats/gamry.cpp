// SPDX-License-Identifier: BSD-3-Clause
// Gamry Framework (.DTA): settings and tables "NAME<tab>TABLE", with a line of names, one of units and rows that begin
// with a tab.  Tables ZCURVE hold impedances.
#include "io/fields.hpp"
#include "io/formats/format.hpp"

namespace io {
namespace {

bool begins_table(std::string_view line) {
  const auto tab = line.find('\t');
  return tab != std::string_view::npos && line.substr(tab + 1).starts_with("TABLE");
}

}  // namespace

std::optional<Recognised> read_gamry(const Source& source) {
  LineReader lines(*source.text);
  std::string_view line;
  if (!lines.next(line) || trimmed(line) != "EXPLAIN") return std::nullopt;
  Recognised found{"Gamry ZCURVE", {}};
  for (bool more = lines.next(line); more;) {
    if (!line.starts_with("ZCURVE") || !begins_table(line)) {
      more = lines.next(line);
      continue;
    }
    const std::string name(trimmed(line.substr(0, line.find('\t'))));
    const std::size_t table_line = lines.number();
    std::string_view names, units;
    if (!lines.next(names) || !lines.next(units))
      throw DataError(source.file, lines.number(), 0, "ends within table " + name + "; the file is cut off");
    TextLayout layout{source.text, named_columns(names, '\t', table_line + 1, units)};
    layout.begin = layout.end = lines.after();
    layout.first_line = lines.number() + 1;
    while ((more = lines.next(line)) && line.starts_with('\t')) layout.end = lines.after();
    layout.end = std::min(layout.end, source.text->size());
    if (layout.begin >= layout.end) {
      found.notes.push_back("table " + name + " in line " + std::to_string(table_line) + " holds no rows");
      continue;
    }
    settle_decimal_commas(layout, found);
    found.sweeps.push_back(
        {name + (found.sweeps.empty() ? "" : "-" + std::to_string(found.sweeps.size() + 1)), std::move(layout)});
  }
  if (found.sweeps.empty())
    throw DataError(source.file, 0, 0, "is a Gamry file without an impedance; expected a table ZCURVE with rows");
  return found;
}

}  // namespace io
