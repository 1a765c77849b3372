// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace io {

/// Without blanks, tabs and carriage returns at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// The same, without a pair of quotes around it too.
[[nodiscard]] std::string_view unquoted(std::string_view text);

/// Tab, semicolon or comma, the first of them that the line holds; else a blank.
[[nodiscard]] char separator_of(std::string_view line);
/// The fields of a line, unquoted; a separator within double quotes is none.  A blank as separator stands for any number
/// of them, and a unit in brackets belongs to the name before it: "Freq (Hz)" is one field.
void split_by(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// Appends all words of a line as numbers.  Returns false, and appends nothing, if one is no finite number.
[[nodiscard]] bool append_numbers(std::string_view line, std::vector<double>& numbers);

[[nodiscard]] bool holds_a_number(const std::vector<std::string_view>& fields);
[[nodiscard]] bool is_comment(std::string_view trimmed_line);

/// Length in characters of UTF-8.
[[nodiscard]] std::size_t characters(std::string_view text);
/// Place of a field in its line, in characters from 1.
[[nodiscard]] std::size_t column_in(std::string_view line, std::string_view field);

/// The lines of a text one after another, whichever line ends it has.
class LineReader {
 public:
  explicit LineReader(std::string_view text);
  /// False at the end of the text.
  bool next(std::string_view& line);
  /// Goes on with the line that begins at this byte.
  void skip_to(std::size_t byte) { next_ = byte; }
  [[nodiscard]] std::size_t number() const { return number_; }  ///< of the last line, from 1
  [[nodiscard]] std::size_t begin() const { return begin_; }    ///< its first byte
  [[nodiscard]] std::size_t after() const { return next_; }     ///< first byte of the line after it

 private:
  std::string_view text_;
  char line_end_ = '\n';
  std::size_t number_ = 0, begin_ = 0, next_ = 0;
};

/// One of the fields is a number with a decimal comma, and none without it.
[[nodiscard]] bool has_decimal_commas(const std::vector<std::string_view>& fields);
/// The text with decimal points in place of the commas from begin to end.  What was a point there, such as one between
/// thousands, becomes an apostrophe, so that it is refused as a number.
[[nodiscard]] std::string with_decimal_points(std::string_view text, std::size_t begin, std::size_t end);

}  // namespace io
