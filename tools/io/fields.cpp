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

/// Where a field ends that begins here in double quotes, which may hold separators; the place itself where none does.
std::size_t after_quotes(std::string_view line, std::size_t place, char separator) {
  const std::size_t first = std::min(line.find_first_not_of(' ', place), line.size());
  if (first == line.size() || line[first] != '"') return place;
  for (std::size_t quote = line.find('"', first + 1); quote < line.size(); quote = line.find('"', quote + 1)) {
    const std::size_t after = separator == ' ' ? quote + 1 : line.find_first_not_of(" \r", quote + 1);
    if (after >= line.size() || line[after] == separator || (separator == ' ' && is_blank(line[after])))
      return quote + 1;
  }
  return place;
}

/// "(Hz)" as against "(1.5)".
bool is_unit_in_brackets(std::string_view word) {
  return word.size() > 2 && (word.front() == '(' || word.front() == '[') &&
         std::string_view("0123456789.+-").find(word[1]) == std::string_view::npos;
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
      const std::size_t end = blank_from(line, after_quotes(line, 0, separator));
      if (!fields.empty() && is_unit_in_brackets(line.substr(0, end)))
        fields.back() = {fields.back().data(), static_cast<std::size_t>(line.data() + end - fields.back().data())};
      else
        fields.push_back(unquoted(line.substr(0, end)));
      line.remove_prefix(word_from(line, end));
    }
    return;
  }
  // Character by character: fields are too short for a search to pay.
  const bool has_quotes = line.find('"') != std::string_view::npos;
  const char* const end = line.data() + line.size();
  for (const char* begin = line.data();;) {
    const char* stop = begin;
    if (has_quotes) stop = line.data() + after_quotes(line, static_cast<std::size_t>(begin - line.data()), separator);
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
    if (comma == std::string::npos || comma + 1 == text.size()) return false;
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
