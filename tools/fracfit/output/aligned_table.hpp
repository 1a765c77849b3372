// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace fracfit {

/// Lines broken between words to fit the terminal, those after the first indented.  Ends with a line end.
[[nodiscard]] std::string paragraph(const std::string& text, std::size_t indent = 0);

/// Columns set flush for people to read: the first to the left, the others to the right.  A last column of remarks is
/// set to the left and broken into lines that fit the terminal.
class AlignedTable {
 public:
  enum class Last { number, remark };
  explicit AlignedTable(std::vector<std::string> heading, Last last = Last::number);
  void add(std::vector<std::string> row);
  [[nodiscard]] std::string text() const;

 private:
  Last last_;
  std::vector<std::vector<std::string>> rows_;
};

/// As many significant digits as asked; "-" for what is not a number.
[[nodiscard]] std::string short_number(double value, int digits = 6);

/// A value and the ends of its interval, with the digits that the interval warrants: to the second of its half width.
struct ShownInterval {
  std::string value, lower, upper;
};
/// @param lower,upper  not a number where there is no interval; the same where it has no width
[[nodiscard]] ShownInterval shown_interval(double value, double lower, double upper);

}  // namespace fracfit
