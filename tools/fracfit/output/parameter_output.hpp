// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "frac/identification/derived.hpp"
#include "frac/identification/fit.hpp"
#include "output/aligned_table.hpp"
#include "output/json.hpp"

namespace fracfit {

// What outputs of fits of every kind say alike of a parameter.

/// An estimate in the cells of a table, with the digits that its interval warrants; "-" for what it has not.
struct EstimateCells {
  std::string value, standard_error, interval;
};
template <class Estimate>
[[nodiscard]] EstimateCells estimate_cells(const Estimate& estimate, bool has_interval) {
  if (!has_interval) return {short_number(estimate.value), "-", "-"};
  const ShownInterval shown = shown_interval(estimate.value, estimate.ci95_lower, estimate.ci95_upper);
  return {shown.value, short_number(estimate.standard_error, 2), shown.lower + " .. " + shown.upper};
}
/// "lower .. upper", likewise.
[[nodiscard]] std::string interval(double lower, double upper);
/// Why an estimate has no interval worth the name; empty where it has one, or where data without noise know of none.
template <class Estimate>
[[nodiscard]] std::string parameter_state(const Estimate& estimate, bool without_noise = false) {
  if (estimate.fixed) return "fixed";
  if (estimate.at_bound) return "at its bound";
  return estimate.identified || without_noise ? "" : "not identified";
}

/// Units of parameters as far as they follow from their formula and the unit of its value, see frac::parameter_units().
class ParameterUnits {
 public:
  /// @param value_unit  as the file has it; empty where it has none
  ParameterUnits(const std::string& formula, const std::string& value_unit);
  /// "1" for a pure number; empty where none follows, as for names that are not in the formula.
  [[nodiscard]] std::string of(const std::string& name) const;
  /// For people, who need none for a pure number.
  [[nodiscard]] std::string shown(const std::string& name) const;

 private:
  std::map<std::string, std::string> units_;
};

/// A message with what would help, in the words of the command line.
[[nodiscard]] std::string with_advice(std::string message, const std::vector<frac::Advice>& advice);

/// A row for each parameter, with its unit where one of them has any.
/// @param title  of the column of their names
[[nodiscard]] std::string estimate_table(const std::string& title,
                                         const std::vector<frac::ParameterEstimate>& estimates,
                                         const ParameterUnits& units, bool without_noise);
/// A line with the limits that someone has given, but for those of a coefficient that is positive or free of sign;
/// empty where there are none.
[[nodiscard]] std::string remark_on_limits(const std::vector<frac::ParameterEstimate>& estimates);
[[nodiscard]] Json parameter_json(const frac::ParameterEstimate& parameter, const ParameterUnits& units);

/// "a = 0.5 +- 0.1" or "R1 = 10 +- 5 %".
[[nodiscard]] std::string prior_text(const frac::PriorEstimate& prior);
/// A table, or nothing where there are none.
[[nodiscard]] std::string prior_table(const std::vector<frac::PriorEstimate>& priors);

/// One line each, below the name of the table; empty where there are none.
[[nodiscard]] std::string derived_table(const std::vector<frac::DerivedEstimate>& derived, bool without_noise);

}  // namespace fracfit
