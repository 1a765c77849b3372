// SPDX-License-Identifier: BSD-3-Clause
#include "io/point_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "io/data_error.hpp"
#include "io/number.hpp"

namespace io {
namespace {

std::string without_blanks(std::string_view text) {
  std::string result;
  for (const char c : text)
    if (c != ' ' && c != '\t') result += c;
  return result;
}

}  // namespace

Condition::Condition(std::string_view text, std::initializer_list<std::string_view> quantities, std::string allowed)
    : text_(without_blanks(text)), allowed_(std::move(allowed)) {
  const auto begin = text_.find_first_of("<>=!");
  const auto end = begin == std::string::npos ? begin : text_.find_first_not_of("<>=!", begin);
  const auto fail = [&](const std::string& found) {
    throw std::invalid_argument("--where " + quoted(text_) + ": " + found + "; expected a comparison of " + allowed_);
  };
  if (begin == std::string::npos) fail("no comparison found");
  if (begin == 0) fail("nothing before the comparison");
  if (end == std::string::npos) fail("no number after the comparison");
  const std::string_view whole = text_;
  const std::string_view comparison = whole.substr(begin, end - begin);
  name_ = whole.substr(0, begin);
  const auto* const quantity = std::find(quantities.begin(), quantities.end(), name_);
  if (quantity != quantities.end()) quantity_ = static_cast<std::size_t>(quantity - quantities.begin());

  constexpr std::array<std::pair<std::string_view, Comparison>, 6> comparisons{{{"<", Comparison::less},
                                                                                {"<=", Comparison::less_equal},
                                                                                {">", Comparison::greater},
                                                                                {">=", Comparison::greater_equal},
                                                                                {"==", Comparison::equal},
                                                                                {"!=", Comparison::not_equal}}};
  const auto* const meant =
      std::find_if(comparisons.begin(), comparisons.end(), [&](const auto& each) { return each.first == comparison; });
  if (meant == comparisons.end()) fail("unknown comparison " + quoted(comparison));
  comparison_ = meant->second;
  const std::string_view right = whole.substr(end);
  const auto bound = parse_number(right);
  bound_ = bound.value_or(0);
  if (bound && !std::isnan(*bound)) return;
  const bool compares_words = comparison_ == Comparison::equal || comparison_ == Comparison::not_equal;
  if (quantity_ || !compares_words || right.find_first_of("<>=!") != std::string_view::npos)
    fail(quoted(right) + " is no number");
  word_ = right;
}

bool Condition::holds(double operand) const {
  switch (comparison_) {
    case Comparison::less:
      return operand < bound_;
    case Comparison::less_equal:
      return operand <= bound_;
    case Comparison::greater:
      return operand > bound_;
    case Comparison::greater_equal:
      return operand >= bound_;
    case Comparison::equal:
      return operand == bound_;
    case Comparison::not_equal:
      return operand != bound_;
  }
  return false;
}

bool Condition::holds(std::string_view field) const {
  if (!word_.empty()) return (without_blanks(field) == word_) == (comparison_ == Comparison::equal);
  const auto number = parse_number(field);
  return number ? holds(*number) : comparison_ == Comparison::not_equal;
}

std::optional<std::size_t> Condition::column_in(const TextTable& table) const {
  if (quantity_) return std::nullopt;
  for (std::size_t i = 0; i < table.header().size(); ++i)
    if (without_blanks(table.header()[i].text) == name_) return i;
  throw std::invalid_argument("--where " + quoted(text_) + ": unknown quantity " + quoted(name_) +
                              "; expected a comparison of " + allowed_ + ", or of a column of " + table.file() + ": " +
                              column_list(table));
}

PointFilter::PointFilter(std::string_view text)
    : condition_(text, {"re", "im", "magnitude", "omega", "f"},
                 "re, im, magnitude, omega (rad/s) or f (Hz) with a number, such as im<0") {}

bool PointFilter::operator()(double omega, std::complex<double> value) const {
  const std::array<double, 5> quantities{value.real(), value.imag(), std::abs(value), omega,
                                         omega / (2 * std::numbers::pi)};
  return !condition_.quantity() || condition_.holds(quantities[*condition_.quantity()]);
}

SampleFilter::SampleFilter(std::string_view text)
    : condition_(text, {"t", "input", "output"}, "t (s), input or output with a number, such as t<40") {}

bool SampleFilter::operator()(double time, double input, double output) const {
  const std::array<double, 3> quantities{time, input, output};
  return !condition_.quantity() || condition_.holds(quantities[*condition_.quantity()]);
}

bool RowFilter::operator()(const TextTable::Row& row) const {
  return std::all_of(conditions_.begin(), conditions_.end(),
                     [&](const auto& each) { return each.second.holds(row.fields[each.first]); });
}

}  // namespace io
