// SPDX-License-Identifier: BSD-3-Clause
#include "io/fields.hpp"

#include <algorithm>
#include <cmath>

#include "frac/cancellation.hpp"
#include "io/number.hpp"

namespace io {
namespace {

// Compared one by one, as find_first_of() would look each character up in a list.
bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

/// The first blank from a place on, or the end.
std::size_t blank_from(std::string_view text, std::size_t place) {
  while (place < text.size() && !is_blank(text[place])) ++place;
  return place;
}

/// The first other character from a place on, or the end.
std::size_t word_from(std::string_view text, std::size_t place) {
  while (place < text.size() && is_blank(text[place])) ++place;
  return place;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(word_from(text, 0));
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view unquoted(std::string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front())
    return trimmed(text.substr(1, text.size() - 2));
  return text;
}

char separator_of(std::string_view line) {
  for (const char separator : {'\t', ';', ','})
    if (line.find(separator) != std::string_view::npos) return separator;
  return ' ';
}

void split_by(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator == ' ') {
    for (line = trimmed(line); !line.empty();) {
      const std::size_t end = blank_from(line, 0);
      fields.push_back(unquoted(line.substr(0, end)));
      line.remove_prefix(word_from(line, end));
    }
    return;
  }
  // Character by character: fields are too short for a search to pay.
  const char* const end = line.data() + line.size();
  for (const char* begin = line.data();;) {
    const char* stop = begin;
    while (stop != end && *stop != separator) ++stop;
    fields.push_back(unquoted({begin, static_cast<std::size_t>(stop - begin)}));
    if (stop == end) return;
    begin = stop + 1;
  }
}

bool append_numbers(std::string_view line, std::vector<double>& numbers) {
  const std::size_t before = numbers.size();
  for (line = trimmed(line); !line.empty();) {
    const std::size_t end = blank_from(line, 0);
    const auto number = parse_number(line.substr(0, end));
    if (!number || !std::isfinite(*number)) {
      numbers.resize(before);
      return false;
    }
    numbers.push_back(*number);
    line.remove_prefix(word_from(line, end));
  }
  return true;
}

bool holds_a_number(const std::vector<std::string_view>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](std::string_view field) { return parse_number(field).has_value(); });
}

bool is_comment(std::string_view trimmed_line) {
  return trimmed_line.starts_with('#');
}

std::size_t characters(std::string_view text) {
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  return text.size() - static_cast<std::size_t>(std::count_if(text.begin(), text.end(), continues));
}

std::size_t column_in(std::string_view line, std::string_view field) {
  return 1 + characters(line.substr(0, static_cast<std::size_t>(field.data() - line.data())));
}

bool LineReader::next(std::string_view& line) {
  frac::throw_if_cancelled();
  if (next_ >= text_.size()) return false;
  begin_ = next_;
  const auto end = std::min(text_.find(line_end_, begin_), text_.size());
  line = text_.substr(begin_, end - begin_);
  if (line.ends_with('\r')) line.remove_suffix(1);
  next_ = end + 1;
  ++number_;
  return true;
}

LineReader::LineReader(std::string_view text) : text_(text) {
  if (text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos) line_end_ = '\r';
}

bool has_decimal_commas(const std::vector<std::string_view>& fields) {
  return std::any_of(fields.begin(), fields.end(), [](std::string_view field) {
    if (parse_number(field)) return false;
    std::string text(field);
    const auto comma = text.find(',');
    if (comma == std::string::npos) return false;
    text[comma] = '.';
    return parse_number(text).has_value();
  });
}

std::string with_decimal_points(std::string_view text, std::size_t begin, std::size_t end) {
  std::string result(text);
  for (std::size_t i = begin; i < end; ++i) {
    if (result[i] == ',')
      result[i] = '.';
    else if (result[i] == '.')
      result[i] = '\'';
  }
  return result;
}

}  // namespace io
