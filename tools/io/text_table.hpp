// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/data_error.hpp"

namespace io {

/// "# key: value" lines in their order.
using Metadata = std::vector<std::pair<std::string, std::string>>;

/// Value of the first entry with that key, or empty.
[[nodiscard]] std::optional<std::string_view> find_value(const Metadata& metadata, std::string_view key);

/// Where the rows of a table stand in a text, for files that are more than a table.
struct TextLayout {
  struct Column {
    std::string name;      // with its unit
    std::size_t line = 1;  // of the name in the file
    std::size_t column = 1;
  };
  std::shared_ptr<const std::string> text;  // whole file as UTF-8
  std::vector<Column> columns;
  char separator = '\t';           // ' ' for any number of blanks
  std::size_t begin = 0, end = 0;  // bytes of the rows
  std::size_t first_line = 1;      // line number of the byte at begin
  Metadata metadata = {};
};

/// A text file of columns: separators comma, semicolon, tab or blanks; '#' starts a comment line; the header row names
/// the columns and may itself be a comment directly above the data.  Windows line ends and the encodings of
/// decoded_text.hpp are accepted.
class TextTable {
 public:
  struct Field {
    std::string_view text;  // without surrounding blanks and quotes
    std::size_t line;
    std::size_t column;
  };
  struct Row {
    std::size_t line;
    std::string_view text;
    std::span<const std::string_view> fields;

    /// Place of a field in its line, in characters from 1.
    [[nodiscard]] std::size_t column_of(std::size_t field) const;
  };

  /// @param file  path, or "-" for standard input
  /// @throws DataError  missing, a folder, unreadable, empty, no header row, or no data row.
  explicit TextTable(std::string file);
  /// The same of a text that has been read. @param file  for messages
  TextTable(std::string file, std::shared_ptr<const std::string> text);
  /// @throws DataError  no data row.
  TextTable(std::string file, TextLayout layout);
  TextTable(const TextTable&) = delete;
  TextTable& operator=(const TextTable&) = delete;

  /// Some of the columns as a table of its own.  The first call cuts all rows into fields; from then on a narrow table
  /// costs what its own columns cost.  Not to be called from several threads at once.
  [[nodiscard]] std::shared_ptr<const TextTable> narrowed(const std::vector<std::size_t>& columns) const;
  /// The rows that have the same label in a column as a table of their own, by label.
  [[nodiscard]] std::map<std::string, std::shared_ptr<const TextTable>> parted(
      std::size_t column, const std::function<std::string(std::string_view)>& label) const;

  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] const Metadata& metadata() const noexcept { return metadata_; }
  [[nodiscard]] const std::vector<Field>& header() const noexcept { return header_; }
  /// The file ends within a row, without a line end and with fewer fields than the header: that row is left out.
  [[nodiscard]] bool is_cut_off() const noexcept { return is_cut_off_; }
  /// At least the number of data rows, for reserving space.
  [[nodiscard]] std::size_t row_estimate() const noexcept { return row_estimate_; }
  /// Calls body for each data row; each has as many fields as the header.
  /// @throws DataError  a row with another number of fields.
  void for_each_row(const std::function<void(const Row&)>& body) const;

 private:
  struct CutRow {
    std::size_t line;
    std::string_view text;
    std::vector<std::string_view> fields;
  };
  TextTable() = default;
  // All columns of some rows.
  [[nodiscard]] std::shared_ptr<TextTable> with_rows(std::shared_ptr<const std::vector<CutRow>> rows) const;
  // Fields that are empty at the end of a line are fields too.
  void add_empty_fields(std::string_view line, std::vector<std::string_view>& fields) const;
  void take_header(std::string_view line, std::string_view names, std::size_t number);
  void leave_out_a_row_cut_off();

  std::string file_;
  TextLayout layout_;
  std::string_view content_;  // of layout_.text
  char separator_ = ',';
  Metadata metadata_;
  std::vector<Field> header_;
  std::size_t data_position_ = 0;  // byte at which the data rows begin
  std::size_t data_line_ = 0;      // and the number of that line
  std::size_t row_estimate_ = 0;
  bool is_cut_off_ = false;
  mutable std::shared_ptr<const std::vector<CutRow>> cut_rows_;
  std::vector<std::size_t> taken_;  // columns of cut_rows_ that are those of a narrow table
};

/// The names of its columns for a message, separated by commas; of very many the first.
[[nodiscard]] std::string column_list(const TextTable& table);

}  // namespace io
