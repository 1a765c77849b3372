// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>

namespace io {

/// A comparison of one of several quantities with a number, e.g. "im<0".  Operators: < <= > >= == !=.
class Condition {
 public:
  /// @param quantities  allowed names;  @param allowed  the same for people, with an example
  /// @throws std::invalid_argument  naming what was found and what is allowed.
  Condition(std::string_view text, std::initializer_list<std::string_view> quantities, const std::string& allowed);

  /// Which of the quantities is compared, by its place among them.
  [[nodiscard]] std::size_t quantity() const noexcept { return quantity_; }
  [[nodiscard]] bool holds(double operand) const;
  /// As given, without blanks.
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  enum class Comparison { less, less_equal, greater, greater_equal, equal, not_equal };

  std::string text_;
  std::size_t quantity_;
  Comparison comparison_;
  double bound_;
};

/// One comparison on a point of a frequency response, e.g. "im<0", "omega >= 10", "magnitude!=0".
/// Quantities: re, im, magnitude (unit of the data), omega (rad/s), f (Hz).
class PointFilter {
 public:
  /// @throws std::invalid_argument  as Condition.
  explicit PointFilter(std::string_view text);
  [[nodiscard]] bool operator()(double omega, std::complex<double> value) const;
  [[nodiscard]] const std::string& text() const noexcept { return condition_.text(); }

 private:
  Condition condition_;
};

/// One comparison on a sample over time, e.g. "t<40".  Quantities: t (s), input, output (units of the data).
class SampleFilter {
 public:
  /// @throws std::invalid_argument  as Condition.
  explicit SampleFilter(std::string_view text);
  [[nodiscard]] bool operator()(double time, double input, double output) const;

 private:
  Condition condition_;
};

}  // namespace io
