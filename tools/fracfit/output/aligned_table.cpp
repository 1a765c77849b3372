// SPDX-License-Identifier: BSD-3-Clause
#include "output/aligned_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "output/terminal.hpp"

namespace fracfit {

namespace {

// A word longer than `width` has a line of its own.
std::vector<std::string> broken(const std::string& text, std::size_t width) {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > width) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

}  // namespace

std::string paragraph(const std::string& text, std::size_t indent) {
  std::string result;
  for (const std::string& line : broken(text, terminal_width() - indent))
    result += (result.empty() ? "" : std::string(indent, ' ')) + line + "\n";
  return result;
}

AlignedTable::AlignedTable(std::vector<std::string> heading, Last last) : last_(last) {
  rows_.push_back(std::move(heading));
}

void AlignedTable::add(std::vector<std::string> row) {
  rows_.push_back(std::move(row));
}

std::string AlignedTable::text() const {
  const std::size_t numbers = rows_.front().size() - (last_ == Last::remark ? 1 : 0);
  std::vector<std::size_t> width(numbers, 0);
  std::size_t used = 3;
  for (std::size_t i = 0; i < numbers; ++i) {
    for (const auto& row : rows_) width[i] = std::max(width[i], row[i].size());
    used += width[i] + 2;
  }
  constexpr std::size_t narrowest = 24;
  const std::size_t room = std::max(narrowest, terminal_width() - std::min(terminal_width(), used));
  std::string text;
  const auto add_line = [&](std::string line) {
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  for (const auto& row : rows_) {
    std::string line = " ";
    for (std::size_t i = 0; i < numbers; ++i) {
      const std::string gap(width[i] - row[i].size(), ' ');
      line += i == 0 ? " " + row[i] + gap : "  " + gap + row[i];
    }
    if (last_ == Last::number) {
      add_line(line);
      continue;
    }
    const std::string margin(line.size(), ' ');
    for (const std::string& remark : broken(row.back(), room)) {
      add_line(line + "  " + remark);
      line = margin;
    }
  }
  return text;
}

std::string short_number(double value, int digits) {
  if (std::isnan(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value == 0 ? 0 : value);  // no "-0"
  return text;
}

namespace {

double leading_place(double number) {
  return std::floor(std::log10(std::abs(number)));
}

/// Down to a place of ten, zeros at the end included, but six digits at most and two at least.
std::string shown_to(double place, double number) {
  if (number == 0) return "0";
  if (!std::isfinite(number)) return short_number(number);
  const double leading = leading_place(number), digits = std::clamp(leading - place + 1, 2.0, 6.0);
  char text[32];
  if (leading < -4 || leading > 5) {
    std::snprintf(text, sizeof text, "%.*e", static_cast<int>(digits) - 1, number);
  } else {
    const double last = leading + 1 - digits;
    const double unit = last > 0 ? std::pow(10, last) : 1,
                 rounded = last > 0 ? unit * std::round(number / unit) : number;
    std::snprintf(text, sizeof text, "%.*f", static_cast<int>(std::max(-last, 0.0)), rounded);
  }
  return text;
}

}  // namespace

ShownInterval shown_interval(double value, double lower, double upper) {
  const double half = (upper - lower) / 2;
  if (!(half > 0 && std::isfinite(half))) return {short_number(value), short_number(lower), short_number(upper)};
  const double place = leading_place(half) - 1;
  return {shown_to(place, value), shown_to(place, lower), shown_to(place, upper)};
}

}  // namespace fracfit
