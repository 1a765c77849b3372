// SPDX-License-Identifier: BSD-3-Clause
#include "io/data_error.hpp"

#include <algorithm>

namespace io {
namespace {

std::string place(const std::string& file, std::size_t line, std::size_t column) {
  std::string text = file;
  if (line > 0) text += ":" + std::to_string(line);
  if (line > 0 && column > 0) text += ":" + std::to_string(column);
  return text + ": ";
}

// Length in bytes of the UTF-8 character at the start of the text.  0 if there is none, or if it is a control
// character.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return first < 0x20 || first == 0x7f ? 0 : 1;
  const std::size_t length = first >= 0xc2 && first < 0xe0   ? 2
                             : first >= 0xe0 && first < 0xf0 ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  const bool is_control = first == 0xc2 && byte(1) < 0xa0;  // U+0080 to U+009F
  return is_control ? 0 : length;
}

}  // namespace

DataError::DataError(const std::string& file, std::size_t line, std::size_t column, const std::string& message)
    : std::runtime_error(place(file, line, column) + message), file_(file), line_(line), column_(column) {}

std::string printable(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character_length(text.substr(i));
    result += length == 0 ? "?" : text.substr(i, length);
    i += std::max<std::size_t>(length, 1);
  }
  return result;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 40;
  return "'" + printable(text.substr(0, longest)) + (text.size() > longest ? "...'" : "'");
}

std::string shortened_list(const std::vector<std::string>& names) {
  return shortened_list(names, names.size());
}

std::string shortened_list(const std::vector<std::string>& first, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < std::min(count, names_shown); ++i) text += (i > 0 ? ", " : "") + printable(first[i]);
  return count > names_shown ? text + " and " + std::to_string(count - names_shown) + " more" : text;
}

}  // namespace io
