// SPDX-License-Identifier: BSD-3-Clause
#include "io/column_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "io/bode_relation.hpp"
#include "io/fields.hpp"
#include "io/number.hpp"

namespace io {

bool holds_values(Quantity quantity) {
  return quantity != Quantity::frequency && quantity != Quantity::other;
}

std::pair<std::string, ColumnMeaning> labelled(const ColumnMeaning& meaning) {
  const bool can_be_db = meaning.quantity == Quantity::magnitude;
  if (!can_be_db && meaning.quantity != Quantity::phase)
    return {meaning.unit, {meaning.quantity, meaning.factor, {}, {}}};
  const auto split = meaning.unit.find('_');
  const std::string head = meaning.unit.substr(0, split);
  const std::string tail = split == std::string::npos ? "" : meaning.unit.substr(split + 1);
  const ColumnMeaning plain = column_meaning((can_be_db ? "magnitude_" : "phase_") + head);
  const bool head_is_unit = can_be_db ? plain.quantity == Quantity::magnitude_db : plain.problem.empty();
  if (head_is_unit) return {tail, plain};
  return {meaning.unit, column_meaning(can_be_db ? "magnitude" : "phase")};
}

std::string key_label(std::string_view text) {
  const auto number = parse_number(text);
  return number ? format_number(*number) : std::string(text);
}

std::optional<std::size_t> position_of(const TextTable& table, const std::string& name) {
  const auto& header = table.header();
  const auto found = std::find_if(header.begin(), header.end(), [&](const auto& field) { return field.text == name; });
  return found == header.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - header.begin()));
}

// "Re(Zwe-ce)/Ohm": what stands in brackets is no unit where one stands behind them.
static std::string unit_in(std::string_view name) {
  const auto bracket = name.rfind(")/");
  return bracket == std::string_view::npos ? column_meaning(name).unit
                                           : column_meaning("re [" + std::string(name.substr(bracket + 2)) + "]").unit;
}

Planner::Planner(const TextTable& table, const std::string& label, const MeasurementOptions& how,
                 std::vector<std::string>& notes)
    : table_(table), notes_(notes) {
  if (!how.columns.empty()) {
    take_columns(how.columns);
    take_frequency_unit(how.frequency_unit);
    take_hertz();
    return;
  }
  for (const auto& field : table.header()) {
    ColumnMeaning meaning = column_meaning(field.text);
    if (!label.empty() && holds_values(meaning.quantity)) {
      const auto [own_label, own_meaning] = labelled(meaning);
      meaning = own_label == label ? own_meaning : ColumnMeaning{Quantity::other, 1, {}, {}};
    }
    meanings_.push_back(std::move(meaning));
  }
  keep_one_symbol();
  take_frequency_unit(how.frequency_unit);
  take_hertz();
  take_bare_impedance();
  tell_open_units();
}

ColumnPlan Planner::plan(const FrequencyResponseReadOptions& options) {
  ColumnPlan plan;
  plan.frequency = frequency_column();
  find_value_columns(plan, options);
  find_spread_column(plan, options);
  used_.push_back(plan.frequency);
  used_.push_back(plan.first);
  used_.push_back(plan.second);
  for (const auto column : {plan.frequency, plan.first, plan.second})
    if (!meanings_[column].assumption.empty() &&
        std::find(notes_.begin(), notes_.end(), meanings_[column].assumption) == notes_.end())
      notes_.push_back(meanings_[column].assumption);
  if (plan.spread) used_.push_back(*plan.spread);
  for (const auto& [column, value] : options.rows)
    if (const auto told_by = position_of(table_, column)) used_.push_back(*told_by);
  note_ignored();
  return plan;
}

std::optional<std::size_t> Planner::frequency() const {
  for (const auto column : columns_with(Quantity::frequency))
    if (meanings_[column].problem.empty()) return column;
  return std::nullopt;
}

std::string Planner::values_of_instrument(const ColumnPlan& plan) const {
  if (meanings_[plan.first].symbol.empty()) return "";
  std::string text(bare_name(plan.first));
  if (plan.second != plan.first) text += "/" + std::string(bare_name(plan.second));
  return text;
}

std::string Planner::other_sign(const ColumnPlan& plan) const {
  if (plan.form != ValueForm::real_imaginary) return "";
  const auto place = [](std::size_t column) { return std::to_string(column + 1); };
  const bool is_negative = meanings_[plan.second].quantity == Quantity::negative_imaginary;
  return std::string("--columns ") + (meanings_[plan.frequency].unit.empty() ? "omega=" : "f=") +
         place(plan.frequency) + ",re=" + place(plan.first) + (is_negative ? ",im=" : ",-im=") + place(plan.second) +
         " reads the other sign";
}

std::string_view Planner::bare_name(std::size_t column) const {
  const std::string_view name = table_.header()[column].text;
  const auto end = std::min({name.find('/'), name.find(" ("), name.find(" ["), name.find("(a)"), name.find("(b)")});
  return trimmed(name.substr(0, end));
}

void Planner::take_columns(const std::string& columns) {
  meanings_.assign(table_.header().size(), {Quantity::other, 1, {}, {}});
  for (const auto& [key, column] : columns_told(columns)) {
    const auto number = parse_count(column);
    const auto place = number ? std::optional(static_cast<std::size_t>(*number) - 1) : position_of(table_, column);
    if (!place || *place >= table_.header().size())
      throw DataError(table_.file(), table_.header().front().line, 0,
                      "has no column " + quoted(column) + " as --columns says; it has " +
                          std::to_string(table_.header().size()) + ": " + column_list(table_));
    const ColumnMeaning named = column_meaning(table_.header()[*place].text);
    ColumnMeaning& meaning = meanings_[*place] = column_meaning(key);
    if (meaning.quantity == Quantity::frequency && named.quantity == Quantity::frequency && !named.unit.empty())
      meaning = named;
    if (meaning.quantity == Quantity::real || meaning.quantity == Quantity::imaginary ||
        meaning.quantity == Quantity::negative_imaginary)
      meaning.unit = unit_in(table_.header()[*place].text);
  }
}

void Planner::keep_one_symbol() {
  const auto has = [&](std::string_view symbol) {
    return std::any_of(meanings_.begin(), meanings_.end(), [&](const auto& each) { return each.symbol == symbol; });
  };
  if (!has("z")) return;
  for (auto& meaning : meanings_)
    if (!meaning.symbol.empty() && meaning.symbol != "z" && meaning.symbol != "w") meaning.quantity = Quantity::other;
}

void Planner::take_frequency_unit(const std::string& unit) {
  if (unit.empty()) return;
  for (auto& meaning : meanings_) {
    if (meaning.quantity != Quantity::frequency) continue;
    if (!meaning.unit.empty() && meaning.problem.empty())
      throw std::invalid_argument("--frequency-unit " + unit + ": the frequency of " + table_.file() +
                                  " has the unit " + quoted(meaning.unit) + " in its name");
    const ColumnMeaning told = column_meaning("f[" + unit + "]");
    if (!told.problem.empty()) throw std::invalid_argument("--frequency-unit " + unit + ": " + told.problem);
    meaning = told;
  }
}

void Planner::take_hertz() {
  if (frequency()) return;
  for (const std::size_t column : columns_with(Quantity::frequency)) {
    ColumnMeaning& meaning = meanings_[column];
    if (!meaning.unit.empty()) continue;
    meaning = column_meaning("f[Hz]");
    meaning.assumption = "column " + quoted(table_.header()[column].text) +
                         " has no unit and is taken as Hz; --frequency-unit rad/s reads the other";
    return;
  }
}

void Planner::take_bare_impedance() {
  const auto has = [&](Quantity quantity) { return !columns_with(quantity).empty(); };
  if (!has(Quantity::phase) || has(Quantity::magnitude) || has(Quantity::magnitude_db) || has(Quantity::real) ||
      has(Quantity::imaginary) || has(Quantity::negative_imaginary))
    return;
  for (std::size_t i = 0; i < meanings_.size(); ++i) {
    const std::string name(table_.header()[i].text);
    ColumnMeaning with_unit = column_meaning(name + " [ohm]");
    if (meanings_[i].quantity != Quantity::other || with_unit.quantity != Quantity::magnitude ||
        with_unit.symbol != "z")
      continue;
    meanings_[i] = std::move(with_unit);
    meanings_[i].unit.clear();
    return;
  }
}

void Planner::tell_open_units() {
  const auto phases = columns_with(Quantity::phase), magnitudes = columns_with(Quantity::magnitude);
  const auto from = frequency();
  if (!from || phases.size() != 1 || magnitudes.size() != 1 || !meanings_[phases.front()].unit.empty() ||
      meanings_[phases.front()].problem.empty())
    return;
  ColumnMeaning &phase = meanings_[phases.front()], &magnitude = meanings_[magnitudes.front()];
  std::vector<std::array<double, 3>> rows;
  table_.for_each_row([&](const TextTable::Row& row) {
    const auto number = [&](std::size_t column) { return parse_number(row.fields[column]).value_or(std::nan("")); };
    rows.push_back({number(*from), number(magnitudes.front()), number(phases.front())});
  });
  std::sort(rows.begin(), rows.end());
  std::vector<double> omega;
  for (const auto& row : rows) omega.push_back(row[0]);
  if (std::any_of(rows.begin(), rows.end(), [](const auto& row) { return !std::isfinite(row[0] + row[1] + row[2]); }))
    return;
  struct Reading {
    bool is_db, is_deg;
    double departure;
  };
  std::vector<Reading> readings;
  const bool may_be_db = magnitude.unit.empty() && magnitude.symbol.empty();
  for (const bool is_db : {false, true})
    for (const bool is_deg : {false, true}) {
      if (is_db && !may_be_db) continue;
      std::vector<std::complex<double>> values;
      for (const auto& row : rows)
        values.push_back(std::polar(is_db ? std::pow(10, row[1] / 20) : std::max(row[1], 0.0),
                                    is_deg ? row[2] * std::numbers::pi / 180 : row[2]));
      if (const auto departure = departure_from_bode(omega, values)) readings.push_back({is_db, is_deg, *departure});
    }
  std::sort(readings.begin(), readings.end(),
            [](const Reading& a, const Reading& b) { return a.departure < b.departure; });
  if (readings.empty() || readings.front().departure > agrees_with_bode ||
      (readings.size() > 1 && readings[1].departure < clearly_beside_bode * readings.front().departure))
    return;
  const Reading& best = readings.front();
  phase = column_meaning(best.is_deg ? "phase_deg" : "phase_rad");
  phase.assumption = "column " + quoted(table_.header()[phases.front()].text) + " has no unit and is in " +
                     (best.is_deg ? "degrees" : "radians") + " by Bode's relation to the magnitude";
  if (!best.is_db) return;
  magnitude.quantity = Quantity::magnitude_db;
  magnitude.assumption = "column " + quoted(table_.header()[magnitudes.front()].text) +
                         " has no unit and is in dB by Bode's relation to the phase";
}

void Planner::fail_at(std::size_t column, const std::string& message) const {
  const auto& field = table_.header()[column];
  throw DataError(table_.file(), field.line, field.column, "column " + quoted(field.text) + ": " + message);
}

void Planner::fail_missing(const std::string& what, const std::string& expected) const {
  throw DataError(table_.file(), table_.header().front().line, table_.header().front().column,
                  "no " + what + " among the columns " + column_list(table_) + "; expected " + expected);
}

std::vector<std::size_t> Planner::columns_with(Quantity quantity) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < meanings_.size(); ++i)
    if (meanings_[i].quantity == quantity) found.push_back(i);
  return found;
}

std::optional<std::size_t> Planner::single(Quantity quantity) const {
  const auto found = columns_with(quantity);
  if (found.size() > 1)
    fail_at(found[1], "means the same as column " + quoted(table_.header()[found[0]].text) +
                          "; expected one of them, or --columns with those that are meant");
  return found.empty() ? std::nullopt : std::optional(found.front());
}

std::size_t Planner::frequency_column() const {
  const auto found = columns_with(Quantity::frequency);
  for (const auto column : found) {
    if (!meanings_[column].problem.empty()) continue;
    if (meanings_[column].unit.empty())
      notes_.push_back("column " + quoted(table_.header()[column].text) + " has no unit and is taken as rad/s");
    return column;
  }
  if (!found.empty()) fail_at(found.front(), meanings_[found.front()].problem);
  fail_missing("frequency column", "omega_rad_s, w_rad_s, f_Hz, frequency_hz or the like, or --columns f=1,re=2,im=3");
}

void Planner::find_value_columns(ColumnPlan& plan, const FrequencyResponseReadOptions& options) const {
  const auto real = single(Quantity::real);
  auto imaginary = single(Quantity::imaginary);
  if (!imaginary) imaginary = single(Quantity::negative_imaginary);
  if (real && imaginary) {
    if (meanings_[*real].unit != meanings_[*imaginary].unit)
      fail_at(*imaginary, "unit " + quoted(meanings_[*imaginary].unit) + " differs from " +
                              quoted(meanings_[*real].unit) + " of the real part; expected the same");
    plan.form = ValueForm::real_imaginary;
    plan.first = *real;
    plan.second = *imaginary;
    return;
  }
  auto magnitude = single(Quantity::magnitude);
  if (!magnitude) magnitude = single(Quantity::magnitude_db);
  if (magnitude && !meanings_[*magnitude].problem.empty()) fail_at(*magnitude, meanings_[*magnitude].problem);
  const auto phase = single(Quantity::phase);
  if (magnitude && phase) {
    if (!meanings_[*phase].problem.empty()) fail_at(*phase, meanings_[*phase].problem);
    plan.form = ValueForm::magnitude_phase;
    plan.first = *magnitude;
    plan.second = *phase;
    return;
  }
  // A tangent alone says nothing of its sign: the symbol does.
  const auto tangent = single(Quantity::loss_tangent);
  const auto has_known_sign = [&](std::optional<std::size_t> column) {
    return column && !meanings_[*column].symbol.empty() && meanings_[*column].symbol != "z" &&
           meanings_[*column].symbol != "y";
  };
  for (const auto& [first, form] :
       {std::pair{real, ValueForm::real_tangent}, {magnitude, ValueForm::magnitude_tangent}})
    if (tangent && has_known_sign(first)) {
      plan.form = form;
      plan.first = *first;
      plan.second = *tangent;
      return;
    }
  if (imaginary && options.real_may_miss && !magnitude && !phase && !tangent) {
    plan.form = ValueForm::imaginary_alone;
    plan.first = plan.second = *imaginary;
    notes_.emplace_back("no column holds a real part, which stands as 0");
    return;
  }
  if (magnitude && options.phase_may_miss) {
    plan.form = ValueForm::magnitude_alone;
    plan.first = plan.second = *magnitude;
    return;
  }
  if (phase && options.magnitude_may_miss) {
    if (!meanings_[*phase].problem.empty()) fail_at(*phase, meanings_[*phase].problem);
    plan.form = ValueForm::phase_alone;
    plan.first = plan.second = *phase;
    return;
  }
  if (real) fail_missing("imaginary part", "a column im or im_<unit> beside the real part");
  if (imaginary)
    fail_missing("real part", "a column re or re_<unit> beside the imaginary part, or --component imaginary");
  if (magnitude)
    fail_missing("phase", "a column phase_deg or phase_rad beside the magnitude, or --component magnitude");
  if (phase) fail_missing("magnitude", "a column magnitude or magnitude_db beside the phase, or --component phase");
  fail_missing("values",
               "re and im, or magnitude (or magnitude_db) and phase_deg (or phase_rad), or --columns f=1,re=2,im=3");
}

void Planner::find_spread_column(ColumnPlan& plan, const FrequencyResponseReadOptions& options) const {
  if (options.weight_column) {
    plan.spread = column_named(*options.weight_column);
    plan.spread_is_weight = !names_standard_deviation(*options.weight_column);
    notes_.push_back("column " + quoted(*options.weight_column) +
                     (plan.spread_is_weight ? " is taken as weight of the squared residuals"
                                            : " is taken as standard deviation of the values"));
  } else if (const auto sigma = single(Quantity::sigma)) {
    plan.spread = sigma;
  } else if (const auto weight = single(Quantity::weight)) {
    plan.spread = weight;
    plan.spread_is_weight = true;
  }
  const bool has_unit = plan.form == ValueForm::real_imaginary || plan.form == ValueForm::imaginary_alone;
  if (plan.spread && !plan.spread_is_weight && has_unit) {
    const auto& unit = meanings_[*plan.spread].unit;
    if (!unit.empty() && unit != meanings_[plan.first].unit)
      fail_at(*plan.spread, "unit " + quoted(unit) + " differs from " + quoted(meanings_[plan.first].unit) +
                                " of the values; expected the same");
  }
}

std::size_t Planner::column_named(const std::string& name) const {
  const auto found = position_of(table_, name);
  if (!found)
    throw std::invalid_argument("weight " + quoted(name) + " is no column of " + table_.file() + ", which has " +
                                column_list(table_) + "; expected one of these, relative, absolute or given");
  return *found;
}

void Planner::note_ignored() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < table_.header().size(); ++i)
    if (std::find(used_.begin(), used_.end(), i) == used_.end()) names.emplace_back(table_.header()[i].text);
  if (!names.empty()) notes_.push_back("columns not used: " + shortened_list(names));
}

}  // namespace io
