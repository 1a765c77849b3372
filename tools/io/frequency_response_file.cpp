// SPDX-License-Identifier: BSD-3-Clause
#include "io/frequency_response_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "io/column_name.hpp"
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
  // Of the columns of a labelled curve, all others mean nothing.
  Planner(const TextTable& table, const std::string& label, std::vector<std::string>& notes)
      : table_(table), notes_(notes) {
    for (const auto& field : table.header()) {
      ColumnMeaning meaning = column_meaning(field.text);
      if (!label.empty() && holds_values(meaning.quantity)) {
        const auto [own_label, own_meaning] = labelled(meaning);
        meaning = own_label == label ? own_meaning : ColumnMeaning{Quantity::other, 1, {}, {}};
      }
      meanings_.push_back(std::move(meaning));
    }
  }

  [[nodiscard]] ColumnPlan plan(const FrequencyResponseReadOptions& options) {
    ColumnPlan plan;
    plan.frequency = frequency_column();
    find_value_columns(plan, options);
    find_spread_column(plan, options);
    used_.push_back(plan.frequency);
    used_.push_back(plan.first);
    used_.push_back(plan.second);
    if (plan.spread) used_.push_back(*plan.spread);
    note_ignored();
    return plan;
  }

  [[nodiscard]] const ColumnMeaning& meaning(std::size_t column) const { return meanings_[column]; }

 private:
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

  // The only column of that quantity, if there is one; two of them leave open which is meant.
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

  void read(const TextTable::Row& row, Points& points) const {
    const double frequency = number(row, plan_.frequency);
    const double omega = frequency * to_radians_per_second_;
    if (!(frequency > 0) || !(omega > 0) || !std::isfinite(omega))
      fail(row, plan_.frequency, "a frequency must be > 0 and finite in rad/s");
    const std::complex<double> value = plan_.form == ValueForm::real_imaginary ? cartesian(row) : polar(row);
    points.omega.push_back(omega);
    points.value.push_back(value);
    if (!plan_.spread) return;
    const double spread = number(row, *plan_.spread);
    const double sigma = plan_.spread_is_weight ? 1 / std::sqrt(spread) : spread;
    if (!(spread > 0) || !(sigma > 0) || !std::isfinite(sigma))
      fail(row, *plan_.spread,
           plan_.spread_is_weight ? "a weight must be > 0; leave points out with --where"
                                  : "a standard deviation must be > 0");
    // Of a phase alone in the unit of the phase, so that sigma/|value| is an angle.
    points.sigma.push_back(plan_.form == ValueForm::phase_alone ? sigma * to_radians_ : sigma);
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

}  // namespace

FrequencyResponseFile read_frequency_response(const std::string& file, const FrequencyResponseReadOptions& options) {
  const TextTable table(file);
  const RowFilter row_filter(table, options.where);
  const Selection selection(table, options.rows);
  std::vector<std::string> notes;
  Planner planner(table, options.curve, notes);
  const ColumnPlan plan = planner.plan(options);
  const RowReader reader(table, plan, planner);
  OneScene scene(table);

  Points points;
  points.omega.reserve(table.row_estimate());
  points.value.reserve(table.row_estimate());
  std::size_t rows = 0;
  table.for_each_row([&](const TextTable::Row& row) {
    if (!selection(row)) return;
    ++rows;
    if (!row_filter(row)) return;
    reader.read(row, points);
    if (keeps(options.where, points.omega.back(), points.value.back())) {
      scene.check(row);
      return;
    }
    points.omega.pop_back();
    points.value.pop_back();
    if (plan.spread) points.sigma.pop_back();
  });
  if (points.omega.empty()) {
    std::string conditions;
    for (const auto& filter : options.where)
      conditions += (conditions.empty() ? "" : " and ") + filter.condition().text();
    throw DataError(table.file(), 0, 0, "none of the " + std::to_string(rows) + " points satisfies " + conditions);
  }
  if (points.omega.size() < rows)
    notes.push_back(std::to_string(points.omega.size()) + " of " + std::to_string(rows) +
                    " points satisfy the conditions and are used");
  sort_by_frequency(points, notes);
  Metadata metadata = table.metadata();
  metadata.insert(metadata.end(), options.rows.begin(), options.rows.end());
  if (!options.curve.empty()) metadata.emplace_back("curve", options.curve);
  // A force alone is no scene: others would miss the clearance.
  Metadata told = scene.entries();
  if (find_value(metadata, "clearance_m") || find_value(told, "clearance_m")) {
    for (auto& entry : told)
      if (!find_value(metadata, entry.first)) metadata.push_back(std::move(entry));
  }
  return {frac::FrequencyResponseData(std::move(points.omega), std::move(points.value), std::move(points.sigma)),
          std::move(metadata), planner.meaning(plan.first).unit, std::move(notes), table.content_fingerprint()};
}

std::vector<Metadata> scenes_in(const std::string& file, const std::vector<PointFilter>& where) {
  const TextTable table(file);
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

std::vector<std::string> curve_labels(const std::string& file, const std::string& key_column) {
  const TextTable table(file);
  std::vector<std::string> labels;
  std::set<std::string> seen;
  const auto add = [&](const std::string& label) {
    if (seen.insert(label).second) labels.push_back(label);
  };
  if (!key_column.empty()) {
    const auto key = position_of(table, key_column);
    if (key) table.for_each_row([&](const TextTable::Row& row) { add(key_label(row.fields[*key])); });
    return labels;
  }
  // Whichever quantity stands in several columns tells the curves apart.
  for (const auto wanted : {Quantity::real, Quantity::magnitude, Quantity::phase}) {
    for (const auto& field : table.header()) {
      const auto [label, meaning] = labelled(column_meaning(field.text));
      const bool is_wanted =
          meaning.quantity == wanted || (wanted == Quantity::magnitude && meaning.quantity == Quantity::magnitude_db);
      if (is_wanted) add(label);
    }
    if (!labels.empty()) break;
  }
  if (labels.size() < 2) return {};
  return labels;
}

}  // namespace io
