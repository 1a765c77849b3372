// SPDX-License-Identifier: BSD-3-Clause
#include "output/document.hpp"

#include <algorithm>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>

#include "frac/cancellation.hpp"
#include "io/csv_line.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"
#include "io/shard_file.hpp"
#include "io/unit_name.hpp"
#include "io/version.hpp"
#include "output/aligned_table.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

void append_csv(std::string& text, const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) {
    io::append_number(text, *number);
  } else if (const auto* whole = std::get_if<std::int64_t>(&cell)) {
    text += std::to_string(*whole);
  } else if (const auto* flag = std::get_if<bool>(&cell)) {
    text += *flag ? "true" : "false";
  } else {
    text += io::csv_field(std::get<std::string>(cell));
  }
}

std::string shown(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return short_number(*number);
  if (const auto* flag = std::get_if<bool>(&cell)) return *flag ? "yes" : "no";
  if (const auto* text = std::get_if<std::string>(&cell)) return io::printable(*text);
  return std::to_string(std::get<std::int64_t>(cell));
}

/// The cells of a row for people.
std::vector<std::string> shown(const std::vector<Cell>& cells, const std::vector<Rows::Interval>& intervals) {
  std::vector<std::string> row;
  for (const Cell& cell : cells) row.push_back(shown(cell));
  for (const auto& [value, lower, upper] : intervals) {
    const auto number = [&](std::size_t column) { return std::get<double>(cells[column]); };
    const ShownInterval digits = shown_interval(number(value), number(lower), number(upper));
    row[value] = digits.value;
    // A value that is known exactly has no interval.
    const bool has_none = number(lower) == number(upper);
    row[lower] = has_none ? "" : digits.lower;
    row[upper] = has_none ? "" : digits.upper;
  }
  return row;
}

/// An entry of the head for people: whole numbers stay as they are, as a seed does.
std::string shown(const std::string& entry) {
  const auto number = io::parse_number(entry);
  return number && entry.find_first_of(".e") != std::string::npos ? short_number(*number) : io::printable(entry);
}

template <class Use>
void for_each_row(const Rows& rows, const Use& use) {
  std::vector<Cell> cells;
  constexpr std::size_t rows_between_looks = 4096;  // some milliseconds
  for (std::size_t i = 0; i < rows.count; ++i) {
    cells.clear();
    if (i % rows_between_looks == 0) frac::throw_if_cancelled();
    rows.fill(i, cells);
    use(cells);
  }
}

std::string csv_text(const Document& document, const std::string& command) {
  std::string text = csv_head(document, command) + csv_rows(document.rows);
  if (document.shard.count > 1) text += io::checksum_line(io::Fingerprint(text));
  return text;
}

std::string json_text(const Document& document, const std::string& command) {
  Json json = origin(command);
  json.update(object_of(document.head));
  json["rows"] = array_of(document.rows);
  return json.dump() + "\n";
}

// The words of a column's name, of which the unit is one.
std::vector<std::string> words_of(const std::string& column) {
  const auto [name, unit] = io::unit_apart(column);
  std::vector<std::string> words;
  std::istringstream stream{std::string(name)};
  for (std::string word; std::getline(stream, word, '_');) words.push_back(word);
  if (!unit.empty()) words.emplace_back(unit);
  return words;
}

// A column's name in lines, broken between its words.
std::vector<std::string> heading_lines(const std::string& name, std::size_t width) {
  std::vector<std::string> lines(1);
  for (const std::string& word : words_of(name)) {
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > width) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

std::string table_text(const Document& document) {
  std::string text;
  std::size_t key_width = 0;
  for (const auto& [key, value] : document.head) key_width = std::max(key_width, key.size());
  for (const auto& [key, value] : document.head) {
    text += key + std::string(key_width + 2 - key.size(), ' ') + paragraph(shown(value), key_width + 2);
  }
  std::vector<std::vector<std::string>> rows;
  for_each_row(document.rows,
               [&](const std::vector<Cell>& cells) { rows.push_back(shown(cells, document.rows.intervals)); });
  constexpr std::size_t narrowest = 9;
  std::vector<std::vector<std::string>> headings;
  std::size_t height = 1;
  for (std::size_t i = 0; i < document.rows.columns.size(); ++i) {
    std::size_t width = narrowest;
    for (const auto& row : rows) width = std::max(width, row[i].size());
    headings.push_back(heading_lines(document.rows.columns[i], width));
    height = std::max(height, headings.back().size());
  }
  const auto heading = [&](std::size_t line) {
    std::vector<std::string> names;
    names.reserve(headings.size());
    for (const auto& lines : headings) names.push_back(line < lines.size() ? lines[line] : "");
    return names;
  };
  AlignedTable table(heading(0));
  for (std::size_t line = 1; line < height; ++line) table.add(heading(line));
  for (auto& row : rows) table.add(std::move(row));
  return text + (text.empty() ? "" : "\n") + table.text();
}

}  // namespace

std::string csv_head(const Document& document, const std::string& command) {
  std::string text = "# fracfit: " + std::string(io::version()) + "\n# command: " + command + "\n";
  io::Metadata head = document.head;
  if (document.shard.count > 1) head.emplace_back(io::shard_key, io::text_of(document.shard));
  for (auto& [key, value] : head) {
    std::replace_if(
        value.begin(), value.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    text += "# " + key + ": " + value + "\n";
  }
  for (std::size_t i = 0; i < document.rows.columns.size(); ++i) text += (i > 0 ? "," : "") + document.rows.columns[i];
  return text + "\n";
}

std::string csv_rows(const Rows& rows) {
  std::string text;
  for_each_row(rows, [&](const std::vector<Cell>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) text += ',';
      append_csv(text, cells[i]);
    }
    text += '\n';
  });
  return text;
}

Json array_of(const Rows& rows) {
  Json array = Json::array();
  for_each_row(rows, [&](const std::vector<Cell>& cells) {
    Json& row = array.push_back(Json::object());
    for (std::size_t i = 0; i < cells.size(); ++i)
      row[rows.columns[i]] = std::visit([](const auto& value) { return Json(value); }, cells[i]);
  });
  return array;
}

std::string text_of(const Document& document, const std::string& format, const std::string& command) {
  if (format == "json") return json_text(document, command);
  return format == "table" ? table_text(document) : csv_text(document, command);
}

Document document_of(const std::string& csv) {
  Document document;
  auto rows = std::make_shared<std::vector<std::vector<std::string>>>();
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# ")) {
      const auto colon = line.find(": ");
      const std::string key = line.substr(2, colon - 2);
      if (key != "fracfit" && key != "command") document.head.emplace_back(key, line.substr(colon + 2));
    } else if (document.rows.columns.empty()) {
      document.rows.columns = io::split_csv_line(line).value();
    } else {
      rows->push_back(io::split_csv_line(line).value());
    }
  }
  document.rows.count = rows->size();
  document.rows.fill = [rows](std::size_t i, std::vector<Cell>& cells) {
    for (const std::string& field : (*rows)[i]) {
      if (const auto number = io::parse_number(field)) {
        cells.emplace_back(*number);
      } else {
        cells.emplace_back(field);
      }
    }
  };
  return document;
}

}  // namespace fracfit
