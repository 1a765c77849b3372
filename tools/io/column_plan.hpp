// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/column_name.hpp"
#include "io/frequency_response_file.hpp"
#include "io/text_table.hpp"

namespace io {

enum class ValueForm {
  real_imaginary,
  real_tangent,
  magnitude_phase,
  magnitude_tangent,
  imaginary_alone,
  magnitude_alone,
  phase_alone
};

// Which column feeds what.
struct ColumnPlan {
  std::size_t frequency = 0;
  ValueForm form = ValueForm::real_imaginary;
  std::size_t first = 0;   // real part or magnitude, or what stands alone
  std::size_t second = 0;  // imaginary part, phase or tangent of its angle, or what stands alone
  std::optional<std::size_t> spread;
  bool spread_is_weight = false;
};

[[nodiscard]] bool holds_values(Quantity quantity);

// "re_a" -> label "a", "magnitude_db_a" -> label "a" and the meaning of "magnitude_db".
[[nodiscard]] std::pair<std::string, ColumnMeaning> labelled(const ColumnMeaning& meaning);

// A number in one spelling, other texts as they are.
[[nodiscard]] std::string key_label(std::string_view text);

[[nodiscard]] std::optional<std::size_t> position_of(const TextTable& table, const std::string& name);

// Finds out from the names of the columns what they hold.
class Planner {
 public:
  // With a label, columns that belong to other curves are ignored.
  Planner(const TextTable& table, const std::string& label, const MeasurementOptions& how,
          std::vector<std::string>& notes);
  [[nodiscard]] ColumnPlan plan(const FrequencyResponseReadOptions& options);
  [[nodiscard]] const ColumnMeaning& meaning(std::size_t column) const { return meanings_[column]; }
  /// The only understood frequency column, if there is one.
  [[nodiscard]] std::optional<std::size_t> frequency() const;
  /// Names as an instrument gives them, e.g. "Zreal/Zimag"; empty where all names are of the common kind.
  [[nodiscard]] std::string values_of_instrument(const ColumnPlan& plan) const;
  /// See FrequencyResponseFile.
  [[nodiscard]] std::string other_sign(const ColumnPlan& plan) const;

 private:
  [[nodiscard]] std::string_view bare_name(std::size_t column) const;

  // The caller says which column is what; the name of the column may give its unit.
  void take_columns(const std::string& columns);

  // A file may hold impedance and admittance; the impedance is read.
  void keep_one_symbol();
  void take_frequency_unit(const std::string& unit);
  // A frequency without a unit, where no other column is one, is in hertz: f as against omega.
  void take_hertz();
  // "impedance" without a unit beside a phase, where nothing else is a value, is the magnitude.
  void take_bare_impedance();
  // A phase without a unit, and a magnitude beside it that may be in dB: Bode's relation tells where it is clear.
  void tell_open_units();
  [[noreturn]] void fail_at(std::size_t column, const std::string& message) const;
  [[noreturn]] void fail_missing(const std::string& what, const std::string& expected) const;
  [[nodiscard]] std::vector<std::size_t> columns_with(Quantity quantity) const;

  // The only column of that quantity, if there is one.  Refuses two, because it is open which is meant.
  [[nodiscard]] std::optional<std::size_t> single(Quantity quantity) const;
  [[nodiscard]] std::size_t frequency_column() const;
  void find_value_columns(ColumnPlan& plan, const FrequencyResponseReadOptions& options) const;
  void find_spread_column(ColumnPlan& plan, const FrequencyResponseReadOptions& options) const;
  [[nodiscard]] std::size_t column_named(const std::string& name) const;
  void note_ignored() const;

  const TextTable& table_;
  std::vector<std::string>& notes_;
  std::vector<ColumnMeaning> meanings_;
  std::vector<std::size_t> used_;
};

}  // namespace io
