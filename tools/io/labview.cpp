// SPDX-License-Identifier: BSD-3-Clause
#include "io/labview.hpp"

#include <algorithm>
#include <vector>

#include "io/csv_line.hpp"
#include "io/fields.hpp"
#include "io/number.hpp"

namespace io {
namespace {

constexpr std::string_view end_of_header = "***End_of_Header***";

class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  std::string_view next() {
    const auto end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++taken_;
    return line;
  }
  /// Lines taken so far.
  [[nodiscard]] std::size_t taken() const { return taken_; }

 private:
  std::string_view rest_;
  std::size_t taken_ = 0;
};

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const auto end = std::min(line.find(separator, begin), line.size());
    fields.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return fields;
}

// What the head of the file says of all segments, and that of a segment of its channels.
struct Tags {
  char separator = '\t';
  bool comma_is_point = false;
  bool many_axes = false, no_axis = false;
  std::vector<std::string> units, dimensions, axis_units, origins, steps;

  void read(std::string_view line) {
    const auto fields = split(line, separator);
    const std::string_view tag = fields.front(), value = fields.size() > 1 ? fields[1] : "";
    const std::vector<std::string> values(fields.begin() + 1, fields.end());
    if (tag == "Decimal_Separator") comma_is_point = value == ",";
    if (tag == "X_Columns") {
      many_axes = value == "Multi";
      no_axis = value == "No";
    }
    if (tag == "Y_Unit_Label") units = values;
    if (tag == "X_Dimension") dimensions = values;
    if (tag == "X_Unit_Label") axis_units = values;
    if (tag == "X0") origins = values;
    if (tag == "Delta_X") steps = values;
  }
  [[nodiscard]] std::string number(std::string_view field) const {
    std::string text(field);
    if (comma_is_point) std::replace(text.begin(), text.end(), ',', '.');
    return text;
  }
  [[nodiscard]] std::optional<double> first(const std::vector<std::string>& values) const {
    return values.empty() ? std::nullopt : parse_number(number(values.front()));
  }
  [[nodiscard]] std::string axis() const {
    const auto first_of = [](const std::vector<std::string>& all) { return all.empty() ? std::string() : all.front(); };
    const std::string dimension = first_of(dimensions), unit = first_of(axis_units);
    if (dimension == "Time") return unit.empty() ? "time_s" : "time[" + unit + "]";
    if (dimension == "Frequency") return unit.empty() ? "f_Hz" : "f[" + unit + "]";
    return "X_Value" + (unit.empty() ? "" : "[" + unit + "]");
  }
};

/// Fields of the line of names that are written, and what they are called.
struct Columns {
  std::vector<std::size_t> fields;
  std::vector<std::string> names;
};

Columns columns_of(const std::vector<std::string_view>& heading, const Tags& tags) {
  Columns columns;
  std::size_t channel = 0;
  for (std::size_t i = 0; i < heading.size(); ++i) {
    const std::string_view name = heading[i];
    if (name.empty() || name == "Comment") continue;
    const bool is_axis = name == "X_Value" || (tags.many_axes && name.starts_with("X_Value "));
    if (is_axis && tags.no_axis) continue;
    columns.fields.push_back(i);
    if (is_axis) {
      columns.names.push_back(columns.fields.size() == 1 ? tags.axis() : std::string(name));
      continue;
    }
    const std::string unit = channel < tags.units.size() ? tags.units[channel] : "";
    columns.names.push_back(std::string(name) + (unit.empty() ? "" : "[" + unit + "]"));
    ++channel;
  }
  return columns;
}

/// Leaves out the axes that are in every row as the first one.
void leave_out_equal_axes(Columns& columns, std::vector<std::vector<std::string>>& rows) {
  for (std::size_t c = columns.names.size(); c-- > 1;) {
    if (!columns.names[c].starts_with("X_Value")) continue;
    if (!std::all_of(rows.begin(), rows.end(), [&](const auto& row) { return row[c] == row[0]; })) continue;
    columns.names.erase(columns.names.begin() + static_cast<std::ptrdiff_t>(c));
    for (auto& row : rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(c));
  }
}

std::string table_of(const Columns& columns, const std::vector<std::vector<std::string>>& rows, const Tags& tags) {
  std::string text;
  const auto add = [&](const std::vector<std::string>& fields) {
    for (std::size_t i = 0; i < fields.size(); ++i) text += (i == 0 ? "" : ",") + csv_field(fields[i]);
    text += '\n';
  };
  const auto origin = tags.first(tags.origins), step = tags.first(tags.steps);
  const bool counted = tags.no_axis && step && *step > 0;
  auto names = columns.names;
  if (counted) names.insert(names.begin(), tags.axis());
  add(names);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    auto row = rows[i];
    if (counted) row.insert(row.begin(), format_number(origin.value_or(0) + static_cast<double>(i) * *step));
    add(row);
  }
  return text;
}

}  // namespace

std::optional<LabviewSegment> labview_segment(std::string_view text) {
  if (!text.starts_with("LabVIEW Measurement")) return std::nullopt;
  Lines lines(text);
  Tags head;
  lines.next();
  for (bool is_head = true; is_head && !lines.at_end();) {
    const std::string_view line = lines.next();
    is_head = !line.starts_with(end_of_header);
    // The separator stands behind the tag that names it.
    if (line.starts_with("Separator")) head.separator = line.find("Comma") != std::string_view::npos ? ',' : '\t';
    if (is_head) head.read(line);
  }
  LabviewSegment found{"", 0};
  while (!lines.at_end()) {
    Tags tags = head;
    bool has_head = false, is_special = false;
    std::string_view heading;
    while (!lines.at_end() && heading.empty()) {
      const std::string_view line = lines.next();
      if (line.starts_with("***Start_Special***")) is_special = true;
      if (line.starts_with("***End_Special***")) {
        is_special = false;
        continue;
      }
      if (is_special || trimmed(line).empty()) continue;
      if (line.starts_with(end_of_header)) {
        has_head = true;
        continue;
      }
      if (line.starts_with("X_Value") || has_head)
        heading = line;
      else
        tags.read(line);
    }
    const std::size_t before = lines.taken() - 1;
    Columns columns = columns_of(split(heading, tags.separator), tags);
    std::vector<std::vector<std::string>> rows;
    while (!lines.at_end()) {
      const std::string_view line = lines.next();
      const auto fields = split(line, tags.separator);
      if (std::all_of(fields.begin(), fields.end(), [](std::string_view field) { return field.empty(); })) break;
      std::vector<std::string> row;
      for (const std::size_t field : columns.fields)
        row.push_back(field < fields.size() ? tags.number(fields[field]) : "");
      rows.push_back(std::move(row));
    }
    if (rows.empty() || columns.names.empty()) continue;
    if (++found.segments > 1) continue;
    leave_out_equal_axes(columns, rows);
    // Errors tell lines: those of the file.
    found.text = std::string(before, '\n') + table_of(columns, rows, tags);
  }
  if (found.segments == 0) return std::nullopt;
  return found;
}

}  // namespace io
