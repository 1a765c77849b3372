// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "io/column_name.hpp"
#include "io/fields.hpp"
#include "io/formats/format.hpp"

namespace io {

std::string_view without_brackets(std::string_view unit) {
  const bool has_brackets =
      unit.size() > 2 && ((unit.front() == '[' && unit.back() == ']') || (unit.front() == '(' && unit.back() == ')'));
  return has_brackets ? trimmed(unit.substr(1, unit.size() - 2)) : unit;
}

std::vector<TextLayout::Column> named_columns(std::string_view names, char separator, std::size_t line,
                                              std::string_view units) {
  std::vector<std::string_view> fields, below;
  split_by(trimmed(names), separator, fields);
  if (!units.empty()) split_by(trimmed(units), separator, below);
  std::vector<TextLayout::Column> columns;
  // Counts on from name to name, because a file may have very many.
  std::size_t place = 1;
  const char* counted = names.data();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    place += characters({counted, static_cast<std::size_t>(fields[i].data() - counted)});
    counted = fields[i].data();
    std::string name(fields[i]);
    if (i < below.size()) below[i] = without_brackets(below[i]);
    const bool has_unit = i < below.size() && !below[i].empty() && below[i] != "-" && below[i] != "#";
    if (has_unit && column_meaning(name).unit.empty()) name += " / " + std::string(below[i]);
    columns.push_back({std::move(name), line, place});
  }
  return columns;
}

void settle_decimal_commas(TextLayout& layout, Recognised& found) {
  if (layout.separator == ',') return;
  LineReader lines(std::string_view(*layout.text).substr(0, layout.end));
  lines.skip_to(layout.begin);
  std::vector<std::string_view> fields;
  for (std::string_view line; lines.next(line);) {
    if (trimmed(line).empty() || is_comment(trimmed(line))) continue;
    split_by(trimmed(line), layout.separator, fields);
    break;
  }
  if (!has_decimal_commas(fields)) return;
  layout.text = std::make_shared<const std::string>(with_decimal_points(*layout.text, layout.begin, layout.end));
  const std::string note = "numbers have decimal commas";
  if (std::find(found.notes.begin(), found.notes.end(), note) == found.notes.end()) found.notes.push_back(note);
}

}  // namespace io
