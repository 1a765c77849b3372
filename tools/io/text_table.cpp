// SPDX-License-Identifier: BSD-3-Clause
#include "io/text_table.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "io/decoded_text.hpp"
#include "io/fields.hpp"
#include "io/input_text.hpp"

namespace io {
namespace {

constexpr const char* expected_header = "expected a header row naming the columns with units, such as f_Hz,re,im";

}  // namespace

std::optional<std::string_view> find_value(const Metadata& metadata, std::string_view key) {
  for (const auto& [name, value] : metadata)
    if (name == key) return value;
  return std::nullopt;
}

std::size_t TextTable::Row::column_of(std::size_t field) const {
  return column_in(text, fields[field]);
}

TextTable::TextTable(std::string file)
    : TextTable(file == "-" ? "standard input" : file, decoded(input_text(file)).text) {}

TextTable::TextTable(std::string file, std::shared_ptr<const std::string> content) : file_(std::move(file)) {
  layout_.text = std::move(content);
  content_ = *layout_.text;
  if (content_.empty()) throw DataError(file_, 0, 0, std::string("is empty; ") + expected_header);
  std::string_view last_comment;  // without the '#'
  std::string_view last_comment_row;
  std::size_t last_comment_line = 0;
  std::vector<std::string_view> fields;
  LineReader lines(content_);
  for (std::string_view line; lines.next(line);) {
    const std::size_t number = lines.number(), begin = lines.begin();
    const auto text = trimmed(line);
    if (text.empty()) continue;
    if (is_comment(text)) {
      if (!header_.empty()) continue;
      last_comment = trimmed(text.substr(1));
      last_comment_row = line;
      last_comment_line = number;
      const auto colon = text.find(':');
      const auto key = trimmed(text.substr(1, colon == std::string_view::npos ? 0 : colon - 1));
      if (!key.empty() && (colon + 1 == text.size() || text[colon + 1] == ' '))
        metadata_.emplace_back(key, trimmed(text.substr(colon + 1)));
      continue;
    }
    if (header_.empty()) {
      split_by(text, separator_of(text), fields);
      if (!holds_a_number(fields)) {
        take_header(line, text, number);
        continue;
      }
      const std::size_t width = fields.size();
      split_by(last_comment, separator_of(last_comment), fields);
      if (last_comment.empty() || holds_a_number(fields) || fields.size() != width)
        throw DataError(file_, number, 1,
                        "found data " + quoted(text) + " with no header row above; " + expected_header +
                            ", or --columns f=1,re=2,im=3");
      take_header(last_comment_row, last_comment, last_comment_line);
    }
    if (line.find(separator_) == std::string_view::npos) separator_ = separator_of(text);
    data_position_ = begin;
    data_line_ = number;
    // Rows are about as long as the first one.
    row_estimate_ = (content_.size() - begin) / std::max<std::size_t>(text.size() / 2, 4) + 1;
    leave_out_a_row_cut_off();
    return;
  }
  if (header_.empty()) throw DataError(file_, 0, 0, std::string("holds no rows; ") + expected_header);
  throw DataError(file_, header_.front().line, 0, "found a header row but no data rows below");
}

TextTable::TextTable(std::string file, TextLayout layout)
    : file_(std::move(file)),
      layout_(std::move(layout)),
      content_(std::string_view(*layout_.text).substr(0, layout_.end)),
      separator_(layout_.separator),
      metadata_(layout_.metadata),
      data_position_(layout_.begin),
      data_line_(layout_.first_line) {
  for (const auto& column : layout_.columns) header_.push_back({column.name, column.line, column.column});
  LineReader lines(content_);
  lines.skip_to(data_position_);
  for (std::string_view line; lines.next(line);) {
    if (trimmed(line).empty() || is_comment(trimmed(line))) continue;
    row_estimate_ = (content_.size() - data_position_) / std::max<std::size_t>(line.size() / 2, 4) + 1;
    if (layout_.end == layout_.text->size()) leave_out_a_row_cut_off();
    return;
  }
  throw DataError(file_, header_.front().line, 0, "found a header row but no data rows below");
}

void TextTable::leave_out_a_row_cut_off() {
  const auto last = content_.find_last_of("\n\r") + 1;
  if (last <= data_position_ || last == content_.size()) return;
  const auto text = trimmed(content_.substr(last));
  if (text.empty() || is_comment(text)) return;
  std::vector<std::string_view> fields;
  split_by(text, separator_, fields);
  if (fields.size() >= header_.size()) return;
  content_ = content_.substr(0, last);
  is_cut_off_ = true;
}

void TextTable::take_header(std::string_view line, std::string_view names, std::size_t number) {
  separator_ = separator_of(names);
  std::vector<std::string_view> fields;
  split_by(names, separator_, fields);
  // Counts on from name to name, because a file may have very many.
  std::size_t column = 1;
  const char* counted = line.data();
  for (const auto field : fields) {
    column += characters({counted, static_cast<std::size_t>(field.data() - counted)});
    counted = field.data();
    header_.push_back({field, number, column});
  }
}

std::shared_ptr<const TextTable> TextTable::narrowed(const std::vector<std::size_t>& columns) const {
  if (!cut_rows_) {
    auto rows = std::make_shared<std::vector<CutRow>>();
    for_each_row([&](const Row& row) {
      rows->push_back({row.line, row.text, {row.fields.begin(), row.fields.end()}});
    });
    cut_rows_ = std::move(rows);
  }
  auto table = with_rows(cut_rows_);
  table->taken_ = columns;
  table->header_.clear();
  for (const auto column : columns) table->header_.push_back(header_[column]);
  return table;
}

std::map<std::string, std::shared_ptr<const TextTable>> TextTable::parted(
    std::size_t column, const std::function<std::string(std::string_view)>& label) const {
  std::map<std::string, std::shared_ptr<std::vector<CutRow>>> parts;
  for_each_row([&](const Row& row) {
    auto& rows = parts[label(row.fields[column])];
    if (!rows) rows = std::make_shared<std::vector<CutRow>>();
    rows->push_back({row.line, row.text, {row.fields.begin(), row.fields.end()}});
  });
  std::map<std::string, std::shared_ptr<const TextTable>> tables;
  for (auto& [name, rows] : parts) tables.emplace(name, with_rows(std::move(rows)));
  return tables;
}

std::shared_ptr<TextTable> TextTable::with_rows(std::shared_ptr<const std::vector<CutRow>> rows) const {
  std::shared_ptr<TextTable> table(new TextTable);
  table->file_ = file_;
  table->layout_.text = layout_.text;
  table->content_ = content_;
  table->metadata_ = metadata_;
  table->header_ = header_;
  table->is_cut_off_ = is_cut_off_;
  table->row_estimate_ = rows->size();
  table->cut_rows_ = std::move(rows);
  table->taken_.resize(header_.size());
  std::iota(table->taken_.begin(), table->taken_.end(), std::size_t{0});
  return table;
}

void TextTable::add_empty_fields(std::string_view line, std::vector<std::string_view>& fields) const {
  while (!line.empty() && (line.back() == '\r' || line.back() == '\n')) line.remove_suffix(1);
  const auto tabs = static_cast<std::size_t>(line.size() - 1 - line.find_last_not_of('\t'));
  fields.resize(std::min(header_.size(), fields.size() + tabs));
}

void TextTable::for_each_row(const std::function<void(const Row&)>& body) const {
  std::vector<std::string_view> fields;
  if (!taken_.empty()) {
    for (const CutRow& row : *cut_rows_) {
      fields.clear();
      for (const auto column : taken_) fields.push_back(row.fields[column]);
      body(Row{row.line, row.text, fields});
    }
    return;
  }
  LineReader lines(content_);
  lines.skip_to(data_position_);
  for (std::string_view line; lines.next(line);) {
    const std::size_t number = data_line_ + lines.number() - 1;
    const auto text = trimmed(line);
    if (text.empty() || is_comment(text)) continue;
    split_by(text, separator_, fields);
    if (fields.size() < header_.size() && separator_ == '\t') {
      if (line.starts_with('\t')) split_by(line, separator_, fields);
      if (fields.size() < header_.size()) add_empty_fields(line, fields);
    }
    if (fields.size() != header_.size()) {
      const std::size_t column =
          fields.size() > header_.size() ? column_in(line, fields[header_.size()]) : characters(line) + 1;
      throw DataError(file_, number, column,
                      "found " + std::to_string(fields.size()) + (fields.size() == 1 ? " field" : " fields") + " in " +
                          quoted(text) + "; expected " + std::to_string(header_.size()) + " as in the header of line " +
                          std::to_string(header_.front().line));
    }
    body(Row{number, line, fields});
  }
}

std::string column_list(const TextTable& table) {
  constexpr std::size_t longest = 300;
  std::string text;
  for (const auto& field : table.header()) {
    if (text.size() > longest) return text + ", ...";
    text += (text.empty() ? "" : ", ") + printable(field.text);
  }
  return text;
}

}  // namespace io
