// SPDX-License-Identifier: BSD-3-Clause
#include "io/frequency_response_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "io/column_name.hpp"
#include "io/column_plan.hpp"
#include "io/curve_rows.hpp"
#include "io/fields.hpp"
#include "io/number.hpp"
#include "io/response_rows.hpp"
#include "io/unit_name.hpp"

namespace io {
namespace {

[[noreturn]] void refuse_several(const Measurement& measurement, const std::vector<std::string>& names) {
  throw std::invalid_argument(measurement.file + " holds " + std::to_string(names.size()) + " sweeps (" +
                              shortened_list(names) +
                              "); take one by --select N or its name, each on its own by fracfit batch, or all of them "
                              "with parameters in common, such as the poles of one machine, by fracfit joint-fit " +
                              measurement.file + " --model FORMULA --shared NAMES");
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

// A sweep of the amplitude or of time has one frequency and many points.
void refuse_one_frequency(const std::string& file, const std::vector<double>& omega,
                          const FrequencyResponseReadOptions& options) {
  if (omega.size() < 3 || omega.front() != omega.back() || options.repeats_are_points || !options.where.empty()) return;
  throw DataError(file, 0, 0,
                  "holds " + std::to_string(omega.size()) + " points, all at " +
                      format_number(omega.front() / (2 * std::numbers::pi)) +
                      " Hz: a sweep of the amplitude or of time is no frequency response");
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
  const bool real_is_missing = plan.form == ValueForm::imaginary_alone;
  for (const auto& filter : options.where)
    if (real_is_missing && filter.is_on_real_part())
      throw std::invalid_argument("--where " + quoted(filter.condition().text()) + ": " + table.file() +
                                  " holds no real part");
  const RowReader reader(table, plan, planner);
  OneScene scene(table);
  SignsOfPhase signs(table, plan, planner);

  Points points;
  points.omega.reserve(table.row_estimate());
  points.value.reserve(table.row_estimate());
  std::size_t rows = 0, at_rest = 0, without_inverse = 0, empty = 0;
  // simulate and map write nan for -1/N where N is 0.
  const bool may_miss = find_value(table.metadata(), quantity_key) == to_string(backlash::Quantity::minus_inverse);
  table.for_each_row([&](const TextTable::Row& row) {
    if (!selection(row)) return;
    ++rows;
    if (!row_filter(row)) return;
    if (may_miss && reader.has_no_value(row)) {
      ++without_inverse;
      --rows;
      return;
    }
    if (reader.is_empty(row)) {
      ++empty;
      --rows;
      return;
    }
    if (!reader.read(row, points)) {
      ++at_rest;
      --rows;
      return;
    }
    signs.see(row, points.value.back());
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
  if (empty > 0)
    notes.push_back(std::to_string(empty) + (empty == 1 ? " row" : " rows") +
                    " left out whose frequency and value are empty");
  if (without_inverse > 0)
    notes.push_back(std::to_string(without_inverse) + (without_inverse == 1 ? " point" : " points") +
                    " without -1/N left out, as N is 0 there");
  if (table.is_cut_off()) notes.emplace_back("the file ends within a row, which is left out");
  if (points.omega.size() < rows)
    notes.push_back(std::to_string(points.omega.size()) + " of " + std::to_string(rows) +
                    " points satisfy the conditions and are used");
  sort_by_frequency(points, is_of_instrument ? ignored : notes);
  if (!is_of_instrument) signs.settle(points, notes);
  if (is_repeated(points.omega) && options.rows.empty() && !options.repeats_are_points) {
    const SweepColumn column = sweep_column(table, measurement.how);
    // Conditions may have left one of them.
    if (!column.name.empty() && options.where.empty()) refuse_several(measurement, curve_labels(measurement, ""));
  }
  refuse_one_frequency(measurement.file, points.omega, options);
  leave_out_copies(points, notes);
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
  return {frac::FrequencyResponseData(
              std::move(points.omega), std::move(points.value), std::move(points.sigma),
              planner.meaning(plan.frequency).in_hertz ? frac::FrequencyUnit::hertz : frac::FrequencyUnit::rad_per_s),
          std::move(metadata),
          unit,
          std::move(notes),
          measurement.fingerprint,
          planner.other_sign(plan),
          backlash::Quantity::n,
          planner.meaning(plan.first).symbol,
          real_is_missing};
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
  leave_out_copies(points, notes);
  Metadata metadata;
  if (!options.curve.empty()) metadata.emplace_back("curve", options.curve);
  const std::string what = curve.quantity +
                           (sweep.name.empty() || sweep.name == curve.quantity ? "" : " " + sweep.name) +
                           (curve.unit.empty() || curve.unit == "1" ? "" : " in " + curve.unit);
  say_what_was_taken(measurement, what, points.omega.size(), notes);
  return {frac::FrequencyResponseData(std::move(points.omega), std::move(points.value), {}, curve.frequency_unit),
          std::move(metadata), curve.unit, std::move(notes), measurement.fingerprint};
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

FrequencyResponseFile read_as_stored(const Measurement& measurement, const FrequencyResponseReadOptions& given) {
  FrequencyResponseReadOptions options = given;
  if (!options.how.select.empty() && !measurement.is_selected)
    options.curve = selected(measurement, options.how.select);
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
  if (options.rows.size() == 1 && options.rows.front().first == measurement.of_rows.first)
    if (const auto part = measurement.of_rows.second.find(options.rows.front().second);
        part != measurement.of_rows.second.end())
      return read_table(measurement, *part->second, options);
  if (!chosen_by_sweep && options.curve.empty() && measurement.how.columns.empty()) {
    const auto labels = column_labels(*sweep->table);
    const bool all_named = std::none_of(labels.begin(), labels.end(), [](const auto& label) { return label.empty(); });
    if (all_named && !labels.empty()) refuse_several(measurement, labels);
  }
  if (!chosen_by_sweep) return read_table(measurement, *sweep->table, options);
  const std::string name = std::exchange(options.curve, "");
  auto result = read_table(measurement, *sweep->table, options);
  if (!name.empty()) result.metadata.emplace_back("curve", name);
  return result;
}

backlash::Quantity stored_quantity(const FrequencyResponseFile& file, const std::string& name) {
  const auto told = find_value(file.metadata, quantity_key);
  if (!told) return written_unit(file.value_unit) == "N/m" ? backlash::Quantity::minus_inverse : backlash::Quantity::n;
  try {
    return backlash::quantity_from_string(*told);
  } catch (const std::invalid_argument& error) {
    throw DataError(name, 0, 0, "says in its header: " + std::string(error.what()));
  }
}

}  // namespace

FrequencyResponseFile read_frequency_response(const std::string& file, const FrequencyResponseReadOptions& options) {
  return read_frequency_response(read_measurement(file, options.how), options);
}

FrequencyResponseFile read_frequency_response(const Measurement& measurement,
                                              const FrequencyResponseReadOptions& options) {
  FrequencyResponseFile file = read_as_stored(measurement, options);
  file.quantity = stored_quantity(file, measurement.file);
  if (options.immittance) return in_immittance(std::move(file), *options.immittance, measurement.file);
  if (!options.quantity || *options.quantity == file.quantity) return file;
  return in_quantity(std::move(file), *options.quantity, measurement.file);
}

bool is_computed(const Metadata& header) {
  const std::string_view command = find_value(header, "command").value_or(std::string_view{});
  return std::ranges::any_of(std::array{"simulate", "map", "evaluate"}, [&](const char* each) {
    return command.starts_with(std::string("fracfit ") + each + " ");
  });
}

bool has_measured_sigma(const FrequencyResponseFile& file) {
  return !file.data.sigma().empty() && find_value(file.metadata, sigma_key) == sigma_is_measured;
}

FrequencyResponseFile in_quantity(FrequencyResponseFile file, backlash::Quantity quantity, const std::string& name) {
  if (file.quantity == quantity) return file;
  const bool to_inverse = quantity == backlash::Quantity::minus_inverse;
  if (file.real_is_missing)
    throw DataError(name, 0, 0,
                    std::string("holds no real part, without which ") +
                        (to_inverse ? "-1/N is not known from N" : "N is not known from -1/N"));
  const auto converted = [&] {
    try {
      return backlash::minus_inverse(file.data);
    } catch (const std::invalid_argument& error) {
      throw DataError(name, 0, 0, error.what());
    }
  }();
  file.data = converted.data;
  const std::string held = file.value_unit.empty() ? "" : ", which the file holds in " + written_unit(file.value_unit);
  file.notes.push_back(to_inverse ? "values are -1/N of N" + held : "values are N, of -1/N" + held);
  if (const std::size_t count = converted.left_out.size(); count > 0)
    file.notes.push_back(std::to_string(count) + (count == 1 ? " point" : " points") + " at which " +
                         (to_inverse ? "N" : "-1/N") + " is 0 left out, as " + (to_inverse ? "-1/N" : "N") +
                         " is infinite there, the first at " + format_number(converted.left_out.front()) + " rad/s");
  file.value_unit = inverse_unit(file.value_unit);
  std::erase_if(file.metadata, [](const auto& entry) { return entry.first == quantity_key; });
  file.metadata.emplace_back(quantity_key, backlash::to_string(quantity));
  file.quantity = quantity;
  return file;
}

FrequencyResponseFile in_immittance(FrequencyResponseFile file, Immittance wanted, const std::string& name) {
  const std::string asked(to_string(wanted));
  const auto told = file.symbol == "z"   ? std::optional(Immittance::impedance)
                    : file.symbol == "y" ? std::optional(Immittance::admittance)
                                         : immittance_of_unit(file.value_unit);
  if (!told && (!file.symbol.empty() || (!file.value_unit.empty() && file.value_unit != "1")))
    throw DataError(
        name, 0, 0,
        "holds values " +
            (file.value_unit.empty() ? "of " + quoted(file.symbol) : "in " + written_unit(file.value_unit)) +
            ", which are neither an impedance nor an admittance, so that there is no " + asked);
  if (told == wanted) return file;
  const std::string held(to_string(wanted == Immittance::impedance ? Immittance::admittance : Immittance::impedance));
  if (file.real_is_missing)
    throw DataError(name, 0, 0, "holds no real part, without which the " + asked + " is not known");
  const auto converted = [&] {
    try {
      return backlash::minus_inverse(file.data);
    } catch (const std::invalid_argument&) {
      throw DataError(name, 0, 0, "is 0 at each of its points, where the " + asked + " is infinite");
    }
  }();
  std::vector<std::complex<double>> value = converted.data.value();
  for (auto& each : value) each = -each;
  file.data = frac::FrequencyResponseData(converted.data.omega(), std::move(value), converted.data.sigma(),
                                          converted.data.frequency_unit());
  const std::string unit = file.value_unit.empty() ? "" : " in " + written_unit(file.value_unit);
  file.notes.push_back(told ? "values are the " + asked + ", 1 over the " + held + unit + " of the file"
                            : "the file does not tell what its values are; they are taken for the " + held +
                                  ", and 1 over them for the " + asked);
  if (const std::size_t count = converted.left_out.size(); count > 0)
    file.notes.push_back(std::to_string(count) + (count == 1 ? " point" : " points") + " at which the " + held +
                         " is 0 left out, as the " + asked + " is infinite there, the first at " +
                         format_number(converted.left_out.front()) + " rad/s");
  file.value_unit = inverse_immittance_unit(file.value_unit);
  file.symbol = wanted == Immittance::impedance ? "z" : "y";
  return file;
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

void prepare_curves(Measurement& measurement, const std::string& key_column) {
  if (measurement.sweeps.size() > 1 || !measurement.sweeps.front().table) return;
  const TextTable& table = *measurement.sweeps.front().table;
  if (!key_column.empty()) {
    if (const auto key = position_of(table, key_column))
      measurement.of_rows = {key_column, table.parted(*key, key_label)};
    return;
  }
  if (!measurement.how.columns.empty() || column_labels(table).empty()) return;
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
