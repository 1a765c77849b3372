// SPDX-License-Identifier: BSD-3-Clause
#include "io/sweep_file.hpp"

#include <charconv>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "io/number.hpp"
#include "io/shard_file.hpp"

namespace io {
namespace {

constexpr std::string_view basic_columns =
    "omega_rad_s,re_m_per_n,im_m_per_n,regime,period,impacts_per_period,uncertainty_m_per_n,third_harmonic_ratio";
constexpr std::string_view all_columns =
    "omega_rad_s,re_m_per_n,im_m_per_n,regime,period,impacts_per_period,uncertainty_m_per_n,third_harmonic_ratio,"
    "even_harmonic_ratio,energy_defect,lyapunov_exponent,periods_followed,transient_possible,force_sensitivity";
// The last three came later: files without them are read.
constexpr std::size_t columns_of_version_1 = 11;

Metadata scene_entries(std::string_view model, double mass1, double mass2, double clearance, double force_amplitude) {
  return {{"model", std::string(model)},
          {"mass1_kg", format_number(mass1)},
          {"mass2_kg", format_number(mass2)},
          {"clearance_m", format_number(clearance)},
          {"force_n", format_number(force_amplitude)}};
}

void append_row(std::string& text, double omega, std::complex<double> value, std::string_view regime,
                std::string_view period, double impacts, double uncertainty, double third_harmonic) {
  append_number(text, omega);
  text += ',';
  append_number(text, value.real());
  text += ',';
  append_number(text, value.imag());
  text += ',';
  text += regime;
  text += ',';
  text += period;
  for (const double number : {impacts, uncertainty, third_harmonic}) {
    text += ',';
    append_number(text, number);
  }
}

void append_options(Metadata& scene, const backlash::SweepOptions& options) {
  scene.emplace_back("output", backlash::to_string(options.output));
  scene.emplace_back("protocol", backlash::to_string(options.protocol));
  scene.emplace_back("tolerance", format_number(options.tolerance));
  if (options.mean_tolerance > 0) scene.emplace_back("mean_tolerance", format_number(options.mean_tolerance));
}

// What the scene or a row says, with the place in messages.
class SweepReader {
 public:
  explicit SweepReader(const std::string& file) : table_(file) {
    std::string names;
    for (const auto& field : table_.header()) names += (names.empty() ? "" : ",") + std::string(field.text);
    has_diagnostics_ = names == all_columns ||
                       (table_.header().size() == columns_of_version_1 && all_columns.starts_with(names + ","));
    if (!has_diagnostics_ && names != basic_columns)
      throw DataError(table_.file(), table_.header().front().line, 1,
                      "found columns " + names + "; expected " + std::string(basic_columns) +
                          ", with or without the columns of --diagnostics");
  }

  [[nodiscard]] backlash::DescribingFunctionSweep read() const {
    if (text("model") != "dynamic")
      throw DataError(table_.file(), 0, 0, "found model " + quoted(text("model")) + "; expected dynamic");
    backlash::SweepOptions options;
    options.protocol = checked("protocol", [&] { return backlash::protocol_from_string(text("protocol")); });
    options.output = checked("output", [&] { return backlash::output_from_string(text("output")); });
    options.tolerance = number("tolerance");
    if (find_value(table_.metadata(), "mean_tolerance")) options.mean_tolerance = number("mean_tolerance");
    const auto system = checked("scene", [&] {
      return backlash::TwoMassSystem(number("mass1_kg"), number("mass2_kg"), number("clearance_m"),
                                     number("restitution"));
    });
    backlash::DescribingFunctionSweep sweep{system, number("force_n"), options, {}};
    table_.for_each_row([&](const TextTable::Row& row) { sweep.points.push_back(point(row)); });
    return sweep;
  }

 private:
  [[nodiscard]] std::string_view text(std::string_view key) const {
    const auto value = find_value(table_.metadata(), key);
    if (!value) throw DataError(table_.file(), 0, 0, "no header line '# " + std::string(key) + ": ...'");
    return *value;
  }

  [[nodiscard]] double number(std::string_view key) const {
    const auto value = parse_number(text(key));
    if (!value)
      throw DataError(table_.file(), 0, 0,
                      "found " + quoted(text(key)) + " for " + std::string(key) + "; expected a number");
    return *value;
  }

  template <typename Make>
  [[nodiscard]] std::invoke_result_t<Make> checked(std::string_view what, const Make& make) const {
    try {
      return make();
    } catch (const std::invalid_argument& error) {
      throw DataError(table_.file(), 0, 0, std::string(what) + ": " + error.what());
    }
  }

  [[noreturn]] void fail(const TextTable::Row& row, std::size_t field, const std::string& expected) const {
    throw DataError(table_.file(), row.line, row.column_of(field),
                    "found " + quoted(row.fields[field]) + " in column " + quoted(table_.header()[field].text) +
                        "; expected " + expected);
  }

  [[nodiscard]] double number(const TextTable::Row& row, std::size_t field) const {
    const auto value = parse_number(row.fields[field]);
    if (!value) fail(row, field, "a number");
    return *value;
  }

  [[nodiscard]] backlash::DescribingFunctionPoint point(const TextTable::Row& row) const {
    backlash::DescribingFunctionPoint point{};
    point.omega = number(row, 0);
    point.value = {number(row, 1), number(row, 2)};
    try {
      point.regime = backlash::regime_from_string(row.fields[3]);
    } catch (const std::invalid_argument& error) {
      fail(row, 3, error.what());
    }
    const auto period = row.fields[4];
    const auto [stop, error] = std::from_chars(period.data(), period.data() + period.size(), point.period);
    if (error != std::errc{} || stop != period.data() + period.size()) fail(row, 4, "a whole number of force periods");
    point.impacts_per_period = number(row, 5);
    point.uncertainty = number(row, 6);
    point.third_harmonic_ratio = number(row, 7);
    if (has_diagnostics_) {
      point.even_harmonic_ratio = number(row, 8);
      point.energy_defect = number(row, 9);
      point.lyapunov_exponent = number(row, 10);
      if (table_.header().size() > columns_of_version_1) {
        point.periods_followed = number(row, 11);
        point.transient_possible = number(row, 12) != 0;
        point.force_sensitivity = number(row, 13);
      }
    }
    return point;
  }

  TextTable table_;
  bool has_diagnostics_ = false;
};

}  // namespace

std::string_view version() {
  return FRACFIT_VERSION;
}

std::string header_lines(const Metadata& scene, const std::string& command) {
  std::string text = "# fracfit: " + std::string(version()) + "\n# command: " + command + "\n";
  for (const auto& [key, value] : scene) text += "# " + key + ": " + value + "\n";
  return text;
}

std::string_view point_columns(PointColumns columns) {
  return columns == PointColumns::basic ? basic_columns : all_columns;
}

void append_point(std::string& text, const backlash::DescribingFunctionPoint& point, PointColumns columns) {
  append_row(text, point.omega, point.value, backlash::to_string(point.regime), std::to_string(point.period),
             point.impacts_per_period, point.uncertainty, point.third_harmonic_ratio);
  if (columns == PointColumns::basic) return;
  for (const double number : {point.even_harmonic_ratio, point.energy_defect, point.lyapunov_exponent,
                              point.periods_followed, point.transient_possible ? 1.0 : 0.0, point.force_sensitivity}) {
    text += ',';
    append_number(text, number);
  }
}

Metadata scene_of(const backlash::DescribingFunctionSweep& sweep) {
  Metadata scene = scene_entries("dynamic", sweep.system.mass1(), sweep.system.mass2(), sweep.system.clearance(),
                                 sweep.force_amplitude);
  scene.emplace_back("restitution", format_number(sweep.system.restitution()));
  append_options(scene, sweep.options);
  return scene;
}

std::string sweep_csv(const backlash::DescribingFunctionSweep& sweep, const std::string& command,
                      PointColumns columns) {
  std::string text = header_lines(scene_of(sweep), command);
  text += std::string(point_columns(columns)) + "\n";
  for (const auto& point : sweep.points) {
    append_point(text, point, columns);
    text += '\n';
  }
  return text;
}

std::string sweeps_csv(const std::vector<backlash::DescribingFunctionSweep>& sweeps, const std::string& command,
                       PointColumns columns, const Shard& shard) {
  Metadata common{{"model", "dynamic"},
                  {"mass1_kg", format_number(sweeps.front().system.mass1())},
                  {"mass2_kg", format_number(sweeps.front().system.mass2())}};
  append_options(common, sweeps.front().options);
  if (shard.count > 1) common.emplace_back(std::string(shard_key), text_of(shard));
  std::string text = header_lines(common, command);
  text += "force_n,clearance_m,restitution," + std::string(point_columns(columns)) + "\n";
  for (const auto& sweep : sweeps) {
    const std::string scene = format_number(sweep.force_amplitude) + "," + format_number(sweep.system.clearance()) +
                              "," + format_number(sweep.system.restitution()) + ",";
    for (const auto& point : sweep.points) {
      text += scene;
      append_point(text, point, columns);
      text += '\n';
    }
  }
  if (shard.count > 1) text += checksum_line(text);
  return text;
}

Metadata scene_of(const StaticCurve& curve) {
  return scene_entries("static", curve.mass1, curve.mass2, curve.clearance, curve.force_amplitude);
}

std::string static_curve_csv(const StaticCurve& curve, const std::string& command) {
  std::string text = header_lines(scene_of(curve), command);
  text += std::string(basic_columns) + "\n";
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < curve.omega.size(); ++i) {
    append_row(text, curve.omega[i], curve.value[i], "static", "nan", none, none, none);
    text += '\n';
  }
  return text;
}

backlash::DescribingFunctionSweep read_sweep(const std::string& file) {
  return SweepReader(file).read();
}

}  // namespace io
