// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/text_table.hpp"

namespace io {

/// A comparison of a quantity, or else of a column of the file, with a number, e.g. "im<0" or "force_n==40". Operators:
/// < <= > >= == !=.  A column may also be == or != a word, e.g. "regime==periodic".
class Condition {
 public:
  /// @param quantities  names that are no columns
  /// @param allowed     the same for people, with an example
  /// @throws std::invalid_argument  naming what was found and what is allowed.
  Condition(std::string_view text, std::initializer_list<std::string_view> quantities, std::string allowed);

  /// Which of the quantities is compared, by its place among them; empty for a column.
  [[nodiscard]] std::optional<std::size_t> quantity() const noexcept { return quantity_; }
  [[nodiscard]] bool holds(double operand) const;
  /// For a field of the column.  One that holds no number satisfies != alone.
  [[nodiscard]] bool holds(std::string_view field) const;
  /// Place of the column in a table; empty for a quantity.
  /// @throws std::invalid_argument  the table has no such column.
  [[nodiscard]] std::optional<std::size_t> column_in(const TextTable& table) const;
  /// As given, without blanks.
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  enum class Comparison { less, less_equal, greater, greater_equal, equal, not_equal };

  std::string text_;
  std::string allowed_;
  std::string name_;
  std::optional<std::size_t> quantity_;
  Comparison comparison_;
  double bound_;
  std::string word_;  // in place of the bound where that is no number
};

/// One comparison on a point of a frequency response, e.g. "im<0", "omega >= 10", "magnitude!=0".
/// Quantities: re, im, magnitude (unit of the data), omega (rad/s), f (Hz).
class PointFilter {
 public:
  /// @throws std::invalid_argument  as Condition.
  explicit PointFilter(std::string_view text);
  /// True for a condition on a column, which the point does not tell.
  [[nodiscard]] bool operator()(double omega, std::complex<double> value) const;
  [[nodiscard]] const Condition& condition() const noexcept { return condition_; }
  /// Whether it needs the real part.
  [[nodiscard]] bool is_on_real_part() const noexcept {
    const auto quantity = condition_.quantity();
    return quantity && (*quantity == real || *quantity == magnitude);
  }

 private:
  enum Quantity : std::size_t { real, imaginary, magnitude, frequency, hertz };  // as the constructor lists them
  Condition condition_;
};

/// One comparison on a sample over time, e.g. "t<40".  Quantities: t (s), input, output (units of the data).
class SampleFilter {
 public:
  /// @throws std::invalid_argument  as Condition.
  explicit SampleFilter(std::string_view text);
  /// True for a condition on a column, which the sample does not tell.
  [[nodiscard]] bool operator()(double time, double input, double output) const;
  [[nodiscard]] const Condition& condition() const noexcept { return condition_; }

 private:
  Condition condition_;
};

/// Those of the conditions that are on columns of a table, for its rows.
class RowFilter {
 public:
  /// @param filters  PointFilter or SampleFilter
  /// @throws std::invalid_argument  a column that the table does not have.
  template <typename Filter>
  RowFilter(const TextTable& table, const std::vector<Filter>& filters) {
    for (const auto& filter : filters)
      if (const auto column = filter.condition().column_in(table))
        conditions_.emplace_back(*column, filter.condition());
  }
  [[nodiscard]] bool operator()(const TextTable::Row& row) const;

 private:
  std::vector<std::pair<std::size_t, Condition>> conditions_;
};

}  // namespace io
