// SPDX-License-Identifier: BSD-3-Clause
#include "io/frequency_response_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "io/column_name.hpp"
#include "io/fields.hpp"
#include "io/number.hpp"

namespace io {
namespace {

enum class ValueForm { real_imaginary, magnitude_phase, magnitude_alone, phase_alone };

// Which column feeds what.
struct ColumnPlan {
  std::size_t frequency = 0;
  ValueForm form = ValueForm::real_imaginary;
  std::size_t first = 0;   // real part or magnitude
  std::size_t second = 0;  // imaginary part or phase
  std::optional<std::size_t> spread;
  bool spread_is_weight = false;
};

bool holds_values(Quantity quantity) {
  return quantity != Quantity::frequency && quantity != Quantity::other;
}

// "re_a" -> label "a", "magnitude_db_a" -> label "a" and the meaning of "magnitude_db".
std::pair<std::string, ColumnMeaning> labelled(const ColumnMeaning& meaning) {
  const bool in_db = meaning.quantity == Quantity::magnitude || meaning.quantity == Quantity::magnitude_db;
  if (!in_db && meaning.quantity != Quantity::phase) return {meaning.unit, {meaning.quantity, meaning.factor, {}, {}}};
  const auto split = meaning.unit.find('_');
  const std::string head = meaning.unit.substr(0, split);
  const std::string tail = split == std::string::npos ? "" : meaning.unit.substr(split + 1);
  const ColumnMeaning plain = column_meaning((in_db ? "magnitude_" : "phase_") + head);
  const bool head_is_unit = in_db ? plain.quantity == Quantity::magnitude_db : plain.problem.empty();
  if (head_is_unit) return {tail, plain};
  return {meaning.unit, column_meaning(in_db ? "magnitude" : "phase")};
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

class Planner {
 public:
  // With a label, columns that belong to other curves are ignored.
  Planner(const TextTable& table, const std::string& label, const MeasurementOptions& how,
          std::vector<std::string>& notes)
      : table_(table), notes_(notes) {
    if (!how.columns.empty()) {
      take_columns(how.columns);
      take_frequency_unit(how.frequency_unit);
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
  }

  [[nodiscard]] ColumnPlan plan(const FrequencyResponseReadOptions& options) {
    ColumnPlan plan;
    plan.frequency = frequency_column();
    find_value_columns(plan, options);
    find_spread_column(plan, options);
    used_.push_back(plan.frequency);
    used_.push_back(plan.first);
    used_.push_back(plan.second);
    for (const auto column : {plan.first, plan.second})
      if (!meanings_[column].assumption.empty() &&
          std::find(notes_.begin(), notes_.end(), meanings_[column].assumption) == notes_.end())
        notes_.push_back(meanings_[column].assumption);
    if (plan.spread) used_.push_back(*plan.spread);
    note_ignored();
    return plan;
  }

  [[nodiscard]] const ColumnMeaning& meaning(std::size_t column) const { return meanings_[column]; }
  /// The only understood frequency column, if there is one.
  [[nodiscard]] std::optional<std::size_t> frequency() const {
    for (const auto column : columns_with(Quantity::frequency))
      if (meanings_[column].problem.empty()) return column;
    return std::nullopt;
  }
  [[nodiscard]] bool uses(std::size_t column) const {
    return std::find(used_.begin(), used_.end(), column) != used_.end();
  }
  /// Names as an instrument gives them, e.g. "Zreal/Zimag"; empty where all names are of the common kind.
  [[nodiscard]] std::string values_of_instrument(const ColumnPlan& plan) const {
    if (meanings_[plan.first].symbol.empty()) return "";
    std::string text(bare_name(plan.first));
    if (plan.second != plan.first) text += "/" + std::string(bare_name(plan.second));
    return text;
  }

 private:
  [[nodiscard]] std::string_view bare_name(std::size_t column) const {
    const std::string_view name = table_.header()[column].text;
    const auto end = std::min({name.find('/'), name.find(" ("), name.find("(a)"), name.find("(b)")});
    return trimmed(name.substr(0, end));
  }

  // The caller says which column is what; the name of the column may give its unit.
  void take_columns(const std::string& columns) {
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
        meaning.unit = named.unit;
    }
  }

  // A file may hold impedance and admittance; the impedance is read.
  void keep_one_symbol() {
    const auto has = [&](std::string_view symbol) {
      return std::any_of(meanings_.begin(), meanings_.end(), [&](const auto& each) { return each.symbol == symbol; });
    };
    if (!has("z")) return;
    for (auto& meaning : meanings_)
      if (!meaning.symbol.empty() && meaning.symbol != "z" && meaning.symbol != "w") meaning.quantity = Quantity::other;
  }

  void take_frequency_unit(const std::string& unit) {
    if (unit.empty()) return;
    for (auto& meaning : meanings_) {
      if (meaning.quantity != Quantity::frequency) continue;
      if (!meaning.unit.empty())
        throw std::invalid_argument("--frequency-unit " + unit + ": the frequency of " + table_.file() +
                                    " has the unit " + quoted(meaning.unit) + " in its name");
      const ColumnMeaning told = column_meaning("f[" + unit + "]");
      if (!told.problem.empty()) throw std::invalid_argument("--frequency-unit " + unit + ": " + told.problem);
      meaning = told;
    }
  }

  [[noreturn]] void fail_at(std::size_t column, const std::string& message) const {
    const auto& field = table_.header()[column];
    throw DataError(table_.file(), field.line, field.column, "column " + quoted(field.text) + ": " + message);
  }

  [[noreturn]] void fail_missing(const std::string& what, const std::string& expected) const {
    throw DataError(table_.file(), table_.header().front().line, table_.header().front().column,
                    "no " + what + " among the columns " + column_list(table_) + "; expected " + expected);
  }

  [[nodiscard]] std::vector<std::size_t> columns_with(Quantity quantity) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < meanings_.size(); ++i)
      if (meanings_[i].quantity == quantity) found.push_back(i);
    return found;
  }

  // The only column of that quantity, if there is one.  Refuses two, because it is open which is meant.
  [[nodiscard]] std::optional<std::size_t> single(Quantity quantity) const {
    const auto found = columns_with(quantity);
    if (found.size() > 1)
      fail_at(found[1],
              "means the same as column " + quoted(table_.header()[found[0]].text) + "; expected one of them");
    return found.empty() ? std::nullopt : std::optional(found.front());
  }

  [[nodiscard]] std::size_t frequency_column() const {
    const auto found = columns_with(Quantity::frequency);
    for (const auto column : found) {
      if (!meanings_[column].problem.empty()) continue;
      if (meanings_[column].unit.empty())
        notes_.push_back("column " + quoted(table_.header()[column].text) + " has no unit and is taken as rad/s");
      return column;
    }
    if (!found.empty()) fail_at(found.front(), meanings_[found.front()].problem);
    fail_missing("frequency column", "omega_rad_s, w_rad_s, f_Hz, frequency_hz or the like");
  }

  void find_value_columns(ColumnPlan& plan, const FrequencyResponseReadOptions& options) const {
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
    const auto phase = single(Quantity::phase);
    if (magnitude && phase) {
      if (!meanings_[*phase].problem.empty()) fail_at(*phase, meanings_[*phase].problem);
      plan.form = ValueForm::magnitude_phase;
      plan.first = *magnitude;
      plan.second = *phase;
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
    if (imaginary) fail_missing("real part", "a column re or re_<unit> beside the imaginary part");
    if (magnitude)
      fail_missing("phase", "a column phase_deg or phase_rad beside the magnitude, or --component magnitude");
    if (phase) fail_missing("magnitude", "a column magnitude or magnitude_db beside the phase, or --component phase");
    fail_missing("values", "re and im, or magnitude (or magnitude_db) and phase_deg (or phase_rad)");
  }

  void find_spread_column(ColumnPlan& plan, const FrequencyResponseReadOptions& options) const {
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
    if (plan.spread && !plan.spread_is_weight && plan.form == ValueForm::real_imaginary) {
      const auto& unit = meanings_[*plan.spread].unit;
      if (!unit.empty() && unit != meanings_[plan.first].unit)
        fail_at(*plan.spread, "unit " + quoted(unit) + " differs from " + quoted(meanings_[plan.first].unit) +
                                  " of the values; expected the same");
    }
  }

  [[nodiscard]] std::size_t column_named(const std::string& name) const {
    const auto found = position_of(table_, name);
    if (!found)
      throw std::invalid_argument("weight " + quoted(name) + " is no column of " + table_.file() + ", which has " +
                                  column_list(table_) + "; expected one of these, relative, absolute or given");
    return *found;
  }

  void note_ignored() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < table_.header().size(); ++i)
      if (std::find(used_.begin(), used_.end(), i) == used_.end()) names.emplace_back(table_.header()[i].text);
    if (!names.empty()) notes_.push_back("columns not used: " + shortened_list(names));
  }

  const TextTable& table_;
  std::vector<std::string>& notes_;
  std::vector<ColumnMeaning> meanings_;
  std::vector<std::size_t> used_;
};

struct Points {
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  std::vector<double> sigma;
};

class RowReader {
 public:
  RowReader(const TextTable& table, const ColumnPlan& plan, const Planner& planner)
      : table_(table),
        plan_(plan),
        to_radians_per_second_(planner.meaning(plan.frequency).factor),
        to_radians_(planner.meaning(plan.second).factor),
        imaginary_sign_(planner.meaning(plan.second).quantity == Quantity::negative_imaginary ? -1 : 1),
        decibel_(planner.meaning(plan.first).quantity == Quantity::magnitude_db) {}

  // False for a row at frequency 0.
  bool read(const TextTable::Row& row, Points& points) const {
    const double frequency = number(row, plan_.frequency);
    if (frequency == 0) return false;
    const double omega = frequency * to_radians_per_second_;
    if (!(frequency > 0) || !(omega > 0) || !std::isfinite(omega))
      fail(row, plan_.frequency, "a frequency must be > 0 and finite in rad/s");
    const std::complex<double> value = plan_.form == ValueForm::real_imaginary ? cartesian(row) : polar(row);
    points.omega.push_back(omega);
    points.value.push_back(value);
    if (!plan_.spread) return true;
    const double spread = number(row, *plan_.spread);
    const double sigma = plan_.spread_is_weight ? 1 / std::sqrt(spread) : spread;
    if (!(spread > 0) || !(sigma > 0) || !std::isfinite(sigma))
      fail(row, *plan_.spread,
           plan_.spread_is_weight ? "a weight must be > 0; leave points out with --where"
                                  : "a standard deviation must be > 0");
    // A phase alone has |value| = 1, so sigma becomes an angle in rad.
    points.sigma.push_back(plan_.form == ValueForm::phase_alone ? sigma * to_radians_ : sigma);
    return true;
  }

 private:
  [[noreturn]] void fail(const TextTable::Row& row, std::size_t field, const std::string& expected) const {
    throw DataError(
        table_.file(), row.line, row.column_of(field),
        "found " + quoted(row.fields[field]) + " in column " + quoted(table_.header()[field].text) + "; " + expected);
  }

  [[nodiscard]] double number(const TextTable::Row& row, std::size_t field) const {
    const auto text = row.fields[field];
    const auto value = parse_number(text);
    if (value && std::isfinite(*value)) return *value;
    if (value) fail(row, field, "expected a finite number");
    if (text.empty()) fail(row, field, "expected a number, the field is empty");
    if (text.find(',') != std::string_view::npos)
      fail(row, field, "expected a number with a decimal point, such as 1.5");
    fail(row, field, "expected a number");
  }

  [[nodiscard]] std::complex<double> cartesian(const TextTable::Row& row) const {
    return {number(row, plan_.first), imaginary_sign_ * number(row, plan_.second)};
  }

  [[nodiscard]] std::complex<double> polar(const TextTable::Row& row) const {
    if (plan_.form == ValueForm::phase_alone) return std::polar(1.0, number(row, plan_.second) * to_radians_);
    const double given = number(row, plan_.first);
    const double magnitude = decibel_ ? std::pow(10, given / 20) : given;
    if (magnitude < 0) fail(row, plan_.first, "a magnitude must be >= 0");
    if (!std::isfinite(magnitude)) fail(row, plan_.first, "the magnitude is beyond the range of a double");
    if (plan_.form == ValueForm::magnitude_alone) return magnitude;
    return std::polar(magnitude, number(row, plan_.second) * to_radians_);
  }

  const TextTable& table_;
  const ColumnPlan& plan_;
  double to_radians_per_second_;
  double to_radians_;
  double imaginary_sign_;
  bool decibel_;
};

bool keeps(const std::vector<PointFilter>& where, double omega, std::complex<double> value) {
  return std::all_of(where.begin(), where.end(), [&](const PointFilter& filter) { return filter(omega, value); });
}

template <typename T>
std::vector<T> permuted(const std::vector<T>& values, const std::vector<std::size_t>& order) {
  std::vector<T> result;
  result.reserve(order.size());
  for (const auto index : order) result.push_back(values[index]);
  return result;
}

void sort_by_frequency(Points& points, std::vector<std::string>& notes) {
  if (std::is_sorted(points.omega.begin(), points.omega.end())) return;
  std::vector<std::size_t> order(points.omega.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return points.omega[a] < points.omega[b]; });
  points.omega = permuted(points.omega, order);
  points.value = permuted(points.value, order);
  if (!points.sigma.empty()) points.sigma = permuted(points.sigma, order);
  notes.emplace_back("rows were not in rising frequency and have been sorted");
}

// Columns that tell apart the scenes of a table as simulate and map write it.
constexpr std::array<std::string_view, 3> scene_columns{"force_n", "clearance_m", "restitution"};

std::vector<std::size_t> scene_columns_of(const TextTable& table) {
  std::vector<std::size_t> columns;
  for (const auto name : scene_columns)
    if (const auto column = position_of(table, std::string(name))) columns.push_back(*column);
  return columns;
}

// Rows in which some columns have given values.
class Selection {
 public:
  Selection(const TextTable& table, const Metadata& wanted) {
    for (const auto& [name, value] : wanted) {
      const auto column = position_of(table, name);
      if (!column)
        throw DataError(table.file(), table.header().front().line, table.header().front().column,
                        "no column " + quoted(name) + " among " + column_list(table));
      wanted_.emplace_back(*column, value);
    }
  }
  [[nodiscard]] bool operator()(const TextTable::Row& row) const {
    return std::all_of(wanted_.begin(), wanted_.end(),
                       [&](const auto& each) { return key_label(row.fields[each.first]) == each.second; });
  }

 private:
  std::vector<std::pair<std::size_t, std::string>> wanted_;
};

// Refuses points of several scenes, which are no single curve.
class OneScene {
 public:
  explicit OneScene(const TextTable& table) : table_(table), columns_(scene_columns_of(table)) {}

  void check(const TextTable::Row& row) {
    if (first_.empty()) {
      for (const auto column : columns_) first_.emplace_back(row.fields[column]);
      return;
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const auto field = row.fields[columns_[i]];
      if (field == first_[i] || key_label(field) == key_label(first_[i])) continue;
      const std::string name(table_.header()[columns_[i]].text);
      throw std::invalid_argument(table_.file() + " holds several curves, told apart by column " + name + " (" +
                                  first_[i] + ", " + std::string(field) + ", ...); take one by --where '" + name +
                                  "==" + std::string(field) + "', or each on its own by fracfit batch --by " + name);
    }
  }

  [[nodiscard]] Metadata entries() const {
    Metadata entries;
    for (std::size_t i = 0; i < first_.size(); ++i)
      entries.emplace_back(table_.header()[columns_[i]].text, key_label(first_[i]));
    return entries;
  }

 private:
  const TextTable& table_;
  std::vector<std::size_t> columns_;
  std::vector<std::string> first_;  // texts of these columns in the first row
};

// A column that tells sweeps apart whose rows repeat the frequencies, and its values in order; empty where there is
// none.
struct SweepColumn {
  std::string name;
  std::vector<std::string> values;
};

class SweepSearch {
 public:
  SweepSearch(const TextTable& table, std::size_t frequency) : table_(table), frequency_(frequency) {}

  // Sweeps begin where the frequency turns back.  A column tells them apart that is constant in each and never the same
  // in two.
  [[nodiscard]] SweepColumn find() {
    const std::size_t width = table_.header().size();
    std::vector<bool> is_constant(width, true);
    std::vector<std::vector<std::string>> values(width);
    double previous = 0, direction = 0;
    bool is_first = true;
    table_.for_each_row([&](const TextTable::Row& row) {
      const auto frequency = parse_number(row.fields[frequency_]);
      if (!frequency || !(*frequency > 0)) return;
      const double step = *frequency - previous;
      const bool turns = is_first || (direction != 0 && step * direction < 0);
      if (turns) {
        for (std::size_t i = 0; i < width; ++i) values[i].emplace_back(row.fields[i]);
        direction = 0;
      } else {
        if (direction == 0) direction = step;
        for (std::size_t i = 0; i < width; ++i)
          if (is_constant[i] && row.fields[i] != values[i].back()) is_constant[i] = false;
      }
      previous = *frequency;
      is_first = false;
    });
    if (is_first || values.front().size() < 2) return {};
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < width; ++i) {
      if (i == frequency_ || !is_constant[i]) continue;
      if (std::set<std::string>(values[i].begin(), values[i].end()).size() != values[i].size()) continue;
      if (!best || (names_a_sweep(i) && !names_a_sweep(*best))) best = i;
    }
    if (!best) return {};
    SweepColumn found{std::string(table_.header()[*best].text), {}};
    for (const auto& value : values[*best]) found.values.push_back(key_label(value));
    return found;
  }

 private:
  [[nodiscard]] bool names_a_sweep(std::size_t column) const {
    std::string name(table_.header()[column].text);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    constexpr std::array<std::string_view, 7> words{"set", "cycle", "sweep", "segment", "run", "loop", "curve"};
    return std::any_of(words.begin(), words.end(),
                       [&](std::string_view word) { return name.find(word) != std::string::npos; });
  }

  const TextTable& table_;
  std::size_t frequency_;
};

SweepColumn sweep_column(const TextTable& table, const MeasurementOptions& how) {
  if (!scene_columns_of(table).empty()) return {};
  std::vector<std::string> ignored;
  const Planner planner(table, "", how, ignored);
  const auto frequency = planner.frequency();
  return frequency ? SweepSearch(table, *frequency).find() : SweepColumn{};
}

[[noreturn]] void refuse_several(const Measurement& measurement, const std::vector<std::string>& names) {
  throw std::invalid_argument(measurement.file + " holds " + std::to_string(names.size()) + " sweeps (" +
                              shortened_list(names) +
                              "); take one by --select N or its name, or each on its own by "
                              "fracfit batch");
}

bool is_repeated(const std::vector<double>& rising) {
  return std::adjacent_find(rising.begin(), rising.end()) != rising.end();
}

void note_points_at_rest(std::size_t count, std::vector<std::string>& notes) {
  if (count > 0)
    notes.push_back(std::to_string(count) + (count == 1 ? " row" : " rows") +
                    " at frequency 0 left out, which no spectrum has");
}

[[noreturn]] void fail_empty(const std::string& file, std::size_t rows, const std::vector<PointFilter>& where) {
  std::string conditions;
  for (const auto& filter : where) conditions += (conditions.empty() ? "" : " and ") + filter.condition().text();
  throw DataError(file, 0, 0,
                  where.empty() ? "holds no point at a frequency above 0"
                                : "none of the " + std::to_string(rows) + " points satisfies " + conditions);
}

// "Gamry ZCURVE, 72 points, Zreal/Zimag in ohm", before all other notes.
void say_what_was_taken(const Measurement& measurement, const std::string& what, std::size_t points,
                        std::vector<std::string>& notes) {
  if (measurement.format.empty() && what.empty()) return;
  notes.insert(notes.begin(), (measurement.format.empty() ? "table" : measurement.format) + ", " +
                                  std::to_string(points) + (points == 1 ? " point" : " points") +
                                  (what.empty() ? "" : ", " + what));
}

FrequencyResponseFile read_table(const Measurement& measurement, const TextTable& table,
                                 const FrequencyResponseReadOptions& options) {
  const RowFilter row_filter(table, options.where);
  const Selection selection(table, options.rows);
  std::vector<std::string> notes = measurement.notes;
  // An instrument writes the same columns in every file, from high frequencies to low.
  const bool is_of_instrument = !measurement.format.empty() && measurement.format != "table";
  std::vector<std::string> ignored;
  Planner planner(table, options.curve, measurement.how, is_of_instrument ? ignored : notes);
  const ColumnPlan plan = planner.plan(options);
  const RowReader reader(table, plan, planner);
  OneScene scene(table);

  Points points;
  points.omega.reserve(table.row_estimate());
  points.value.reserve(table.row_estimate());
  std::size_t rows = 0, at_rest = 0;
  table.for_each_row([&](const TextTable::Row& row) {
    if (!selection(row)) return;
    ++rows;
    if (!row_filter(row)) return;
    if (!reader.read(row, points)) {
      ++at_rest;
      --rows;
      return;
    }
    if (keeps(options.where, points.omega.back(), points.value.back())) {
      scene.check(row);
      return;
    }
    points.omega.pop_back();
    points.value.pop_back();
    if (plan.spread) points.sigma.pop_back();
  });
  if (points.omega.empty()) fail_empty(table.file(), rows, options.where);
  note_points_at_rest(at_rest, notes);
  if (points.omega.size() < rows)
    notes.push_back(std::to_string(points.omega.size()) + " of " + std::to_string(rows) +
                    " points satisfy the conditions and are used");
  sort_by_frequency(points, is_of_instrument ? ignored : notes);
  if (is_repeated(points.omega) && options.rows.empty() && !options.repeats_are_points) {
    const SweepColumn column = sweep_column(table, measurement.how);
    // Conditions may have left one of them.
    if (!column.name.empty() && options.where.empty()) refuse_several(measurement, curve_labels(measurement, ""));
  }
  Metadata metadata = table.metadata();
  metadata.insert(metadata.end(), options.rows.begin(), options.rows.end());
  if (!options.curve.empty()) metadata.emplace_back("curve", options.curve);
  // A scene needs the clearance too, so a force alone is not reported.
  Metadata told = scene.entries();
  if (find_value(metadata, "clearance_m") || find_value(told, "clearance_m")) {
    for (auto& entry : told)
      if (!find_value(metadata, entry.first)) metadata.push_back(std::move(entry));
  }
  const std::string unit =
      planner.meaning(plan.first).unit.empty() ? measurement.unit : planner.meaning(plan.first).unit;
  std::string what = planner.values_of_instrument(plan);
  if (!what.empty() && !unit.empty()) what += " in " + unit;
  say_what_was_taken(measurement, what, points.omega.size(), notes);
  return {frac::FrequencyResponseData(std::move(points.omega), std::move(points.value), std::move(points.sigma)),
          std::move(metadata),
          unit,
          std::move(notes),
          measurement.fingerprint,
          planner.meaning(plan.first).symbol};
}

FrequencyResponseFile read_curve(const Measurement& measurement, const Measurement::Sweep& sweep,
                                 const FrequencyResponseReadOptions& options) {
  const SampledCurve& curve = sweep.curve;
  for (const auto& filter : options.where)
    if (!filter.condition().quantity())
      throw std::invalid_argument("--where " + quoted(filter.condition().text()) + ": " + measurement.file +
                                  " has no columns with names; expected a comparison of re, im, magnitude, omega or f");
  if (options.weight_column)
    throw std::invalid_argument("weight " + quoted(*options.weight_column) + " is no column of " + measurement.file +
                                "; expected relative or absolute");
  if (!measurement.how.frequency_unit.empty() && measurement.format != "MAT-file")
    throw std::invalid_argument("--frequency-unit: a " + measurement.format + " file gives the unit itself");
  std::vector<std::string> notes = measurement.notes;
  Points points;
  std::size_t at_rest = 0;
  for (std::size_t i = 0; i < curve.omega.size(); ++i) {
    if (curve.omega[i] == 0) {
      ++at_rest;
      continue;
    }
    if (!(curve.omega[i] > 0) || !std::isfinite(curve.omega[i]))
      throw DataError(measurement.file, 0, 0,
                      "point " + std::to_string(i + 1) + " of " + curve.quantity + " has the frequency " +
                          format_number(curve.omega[i]) + " rad/s; expected > 0 and finite");
    if (!std::isfinite(curve.value[i].real()) || !std::isfinite(curve.value[i].imag()))
      throw DataError(measurement.file, 0, 0,
                      "point " + std::to_string(i + 1) + " of " + curve.quantity + " is not finite");
    if (!keeps(options.where, curve.omega[i], curve.value[i])) continue;
    points.omega.push_back(curve.omega[i]);
    points.value.push_back(curve.value[i]);
  }
  if (points.omega.empty()) fail_empty(measurement.file, curve.omega.size() - at_rest, options.where);
  note_points_at_rest(at_rest, notes);
  sort_by_frequency(points, notes);
  Metadata metadata;
  if (!options.curve.empty()) metadata.emplace_back("curve", options.curve);
  const std::string what = curve.quantity +
                           (sweep.name.empty() || sweep.name == curve.quantity ? "" : " " + sweep.name) +
                           (curve.unit.empty() || curve.unit == "1" ? "" : " in " + curve.unit);
  say_what_was_taken(measurement, what, points.omega.size(), notes);
  return {frac::FrequencyResponseData(std::move(points.omega), std::move(points.value)), std::move(metadata),
          curve.unit, std::move(notes), measurement.fingerprint};
}

// Which of these names the choice means: one of them, or its number.
std::string selected(const Measurement& measurement, const std::string& choice) {
  std::vector<std::string> names = curve_labels(measurement, "");
  if (names.empty()) names.push_back(measurement.sweeps.front().name);
  const bool is_name = std::find(names.begin(), names.end(), choice) != names.end();
  if (is_name) return choice;
  for (const auto& sweep : measurement.sweeps)
    if (sweep.is_derived && sweep.name == choice) return choice;
  const auto number = parse_count(choice);
  if (number && *number >= 1 && *number <= names.size()) return names[*number - 1];
  throw std::invalid_argument("--select " + quoted(choice) + ": " + measurement.file + " holds " +
                              std::to_string(names.size()) + (names.size() == 1 ? " sweep" : " sweeps: ") +
                              (names.size() == 1 ? "" : shortened_list(names)));
}

std::vector<std::string> column_labels(const TextTable& table) {
  std::vector<std::string> labels;
  std::set<std::string> seen;
  // The first of these quantities that stands in several columns tells the curves apart.
  for (const auto wanted : {Quantity::real, Quantity::magnitude, Quantity::phase}) {
    for (const auto& field : table.header()) {
      const ColumnMeaning whole = column_meaning(field.text);
      if (!whole.symbol.empty()) continue;
      const auto [label, meaning] = labelled(whole);
      const bool is_wanted =
          meaning.quantity == wanted || (wanted == Quantity::magnitude && meaning.quantity == Quantity::magnitude_db);
      if (is_wanted && seen.insert(label).second) labels.push_back(label);
    }
    if (!labels.empty()) break;
  }
  if (labels.size() < 2) return {};
  return labels;
}

}  // namespace

FrequencyResponseFile read_frequency_response(const std::string& file, const FrequencyResponseReadOptions& options) {
  return read_frequency_response(read_measurement(file, options.how), options);
}

FrequencyResponseFile read_frequency_response(const Measurement& measurement,
                                              const FrequencyResponseReadOptions& given) {
  FrequencyResponseReadOptions options = given;
  if (!options.how.select.empty()) options.curve = selected(measurement, options.how.select);
  const Measurement::Sweep* sweep = &measurement.sweeps.front();
  const auto is_shown = [](const Measurement::Sweep& each) { return !each.is_derived; };
  if (measurement.sweeps.size() > 1) {
    if (options.curve.empty()) {
      if (std::count_if(measurement.sweeps.begin(), measurement.sweeps.end(), is_shown) > 1)
        refuse_several(measurement, curve_labels(measurement, ""));
    } else {
      const auto found = std::find_if(measurement.sweeps.begin(), measurement.sweeps.end(),
                                      [&](const auto& each) { return each.name == options.curve; });
      if (found == measurement.sweeps.end())
        throw std::invalid_argument(measurement.file + " has no sweep " + quoted(options.curve));
      sweep = &*found;
    }
  }
  if (!sweep->table) return read_curve(measurement, *sweep, options);
  const bool chosen_by_sweep = !sweep->name.empty();
  if (const auto narrow = measurement.narrow.find(options.curve); narrow != measurement.narrow.end())
    return read_table(measurement, *narrow->second, options);
  // "Set=3": rows instead of columns.
  const auto sign = options.curve.find('=');
  if (!chosen_by_sweep && sign != std::string::npos && position_of(*sweep->table, options.curve.substr(0, sign))) {
    options.rows.emplace_back(options.curve.substr(0, sign), options.curve.substr(sign + 1));
    options.curve.clear();
  }
  if (!chosen_by_sweep) return read_table(measurement, *sweep->table, options);
  const std::string name = std::exchange(options.curve, "");
  auto result = read_table(measurement, *sweep->table, options);
  if (!name.empty()) result.metadata.emplace_back("curve", name);
  return result;
}

std::vector<Metadata> scenes_in(const Measurement& measurement, const std::vector<PointFilter>& where) {
  if (measurement.sweeps.size() > 1 || !measurement.sweeps.front().table) return {};
  const TextTable& table = *measurement.sweeps.front().table;
  const RowFilter filter(table, where);
  const auto columns = scene_columns_of(table);
  std::vector<std::vector<std::string>> scenes;
  if (columns.empty()) return {};
  std::set<std::vector<std::string>> seen;
  std::vector<std::string> labels(columns.size());
  table.for_each_row([&](const TextTable::Row& row) {
    if (!filter(row)) return;
    for (std::size_t i = 0; i < columns.size(); ++i) labels[i] = key_label(row.fields[columns[i]]);
    if (seen.insert(labels).second) scenes.push_back(labels);
  });
  if (scenes.size() < 2) return {};
  std::vector<Metadata> result(scenes.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto varies = [&](const auto& scene) { return scene[i] != scenes.front()[i]; };
    if (std::none_of(scenes.begin(), scenes.end(), varies)) continue;
    for (std::size_t k = 0; k < scenes.size(); ++k)
      result[k].emplace_back(table.header()[columns[i]].text, scenes[k][i]);
  }
  return result;
}

std::vector<std::string> curve_labels(const Measurement& measurement, const std::string& key_column) {
  std::vector<std::string> labels;
  if (measurement.sweeps.size() > 1) {
    for (const auto& sweep : measurement.sweeps)
      if (!sweep.is_derived) labels.push_back(sweep.name);
    if (labels.size() < 2) labels.clear();
    return labels;
  }
  if (!measurement.sweeps.front().table) return labels;
  const TextTable& table = *measurement.sweeps.front().table;
  if (!key_column.empty()) {
    std::set<std::string> seen;
    const auto key = position_of(table, key_column);
    if (!key) return labels;
    table.for_each_row([&](const TextTable::Row& row) {
      std::string label = key_label(row.fields[*key]);
      if (seen.insert(label).second) labels.push_back(std::move(label));
    });
    return labels;
  }
  if (measurement.how.columns.empty()) labels = column_labels(table);
  if (!labels.empty()) return labels;
  const SweepColumn column = sweep_column(table, measurement.how);
  for (const auto& value : column.values) labels.push_back(column.name + "=" + value);
  return labels;
}

void prepare_curves(Measurement& measurement) {
  if (measurement.sweeps.size() > 1 || !measurement.sweeps.front().table || !measurement.how.columns.empty()) return;
  const TextTable& table = *measurement.sweeps.front().table;
  if (column_labels(table).empty()) return;
  std::vector<std::size_t> shared;
  std::map<std::string, std::vector<std::size_t>> own;
  for (std::size_t i = 0; i < table.header().size(); ++i) {
    const ColumnMeaning meaning = column_meaning(table.header()[i].text);
    if (meaning.quantity == Quantity::other) continue;
    if (holds_values(meaning.quantity))
      own[labelled(meaning).first].push_back(i);
    else
      shared.push_back(i);
  }
  for (auto& [label, columns] : own) {
    columns.insert(columns.begin(), shared.begin(), shared.end());
    measurement.narrow[label] = table.narrowed(columns);
  }
}

}  // namespace io
