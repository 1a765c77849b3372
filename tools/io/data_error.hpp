// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace io {

/// A file that cannot be read or whose content is invalid.  what() is "file:line:column: found ...; expected ...".
class DataError : public std::runtime_error {
 public:
  /// @param line,column  counted from 1, the column in characters; 0 where there is none
  DataError(const std::string& file, std::size_t line, std::size_t column, const std::string& message);

  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] std::size_t line() const noexcept { return line_; }
  [[nodiscard]] std::size_t column() const noexcept { return column_; }

 private:
  std::string file_;
  std::size_t line_;
  std::size_t column_;
};

/// The text with a ? for every control character and every byte that is no UTF-8.
[[nodiscard]] std::string printable(std::string_view text);
/// The text in quotes for a message: unprintable bytes as '?', cut after 40 characters.
[[nodiscard]] std::string quoted(std::string_view text);

/// The first of a list of names for a message, and how many more there are.
[[nodiscard]] std::string shortened_list(const std::vector<std::string>& names);
/// The same of so many names, of which the first names_shown are enough.
[[nodiscard]] std::string shortened_list(const std::vector<std::string>& first, std::size_t count);
inline constexpr std::size_t names_shown = 10;

}  // namespace io
