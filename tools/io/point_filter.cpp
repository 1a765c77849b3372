#include "io/point_filter.hpp"

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

PointFilter::PointFilter(std::string_view text) : text_(without_blanks(text)) {
  const auto begin = text_.find_first_of("<>=!");
  const auto end = begin == std::string::npos ? begin : text_.find_first_not_of("<>=!", begin);
  const auto fail = [&](const std::string& found) {
    throw std::invalid_argument(
        "--where " + quoted(text) + ": " + found +
        "; expected a comparison of re, im, magnitude, omega (rad/s) or f (Hz) with a number, such as im<0");
  };
  if (begin == std::string::npos) fail("no comparison found");
  if (end == std::string::npos) fail("no number after the comparison");
  const std::string_view whole = text_;
  const std::string_view quantity = whole.substr(0, begin);
  const std::string_view comparison = whole.substr(begin, end - begin);

  constexpr std::array<std::pair<std::string_view, Quantity>, 5> quantities{{{"re", Quantity::re},
                                                                             {"im", Quantity::im},
                                                                             {"magnitude", Quantity::magnitude},
                                                                             {"omega", Quantity::omega},
                                                                             {"f", Quantity::frequency}}};
  constexpr std::array<std::pair<std::string_view, Comparison>, 6> comparisons{{{"<", Comparison::less},
                                                                                {"<=", Comparison::less_equal},
                                                                                {">", Comparison::greater},
                                                                                {">=", Comparison::greater_equal},
                                                                                {"==", Comparison::equal},
                                                                                {"!=", Comparison::not_equal}}};
  const auto lookup = [&](const auto& table, std::string_view name, std::string_view what) {
    for (const auto& [spelling, meaning] : table)
      if (spelling == name) return meaning;
    fail("unknown " + std::string(what) + " " + quoted(name));
    return table.front().second;
  };
  quantity_ = lookup(quantities, quantity, "quantity");
  comparison_ = lookup(comparisons, comparison, "comparison");
  const auto bound = parse_number(whole.substr(end));
  if (!bound || std::isnan(*bound)) fail(quoted(whole.substr(end)) + " is no number");
  bound_ = *bound;
}

bool PointFilter::operator()(double omega, std::complex<double> value) const {
  const auto operand = [&] {
    switch (quantity_) {
      case Quantity::re:
        return value.real();
      case Quantity::im:
        return value.imag();
      case Quantity::magnitude:
        return std::abs(value);
      case Quantity::omega:
        break;
      case Quantity::frequency:
        return omega / (2 * std::numbers::pi);
    }
    return omega;
  }();
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

}  // namespace io
