// SPDX-License-Identifier: BSD-3-Clause
#include "output/sweep_output.hpp"

#include <cstdint>
#include <limits>

#include "io/number.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

using Point = backlash::DescribingFunctionPoint;

std::vector<std::string> point_columns(PointColumns columns, std::vector<std::string> in_front = {}) {
  std::vector<std::string> names = std::move(in_front);
  for (const char* name : {"omega_rad_s", "re_m_per_n", "im_m_per_n", "regime", "period", "impacts_per_period",
                           "uncertainty_m_per_n", "third_harmonic_ratio"})
    names.emplace_back(name);
  if (columns == PointColumns::basic) return names;
  for (const char* name : {"even_harmonic_ratio", "energy_defect", "lyapunov_exponent", "periods_followed",
                           "transient_possible", "force_sensitivity"})
    names.emplace_back(name);
  return names;
}

// Period and possible transient are numbers in a table, a whole number and true or false in the JSON of a sweep.
struct AsNumbers {
  Cell operator()(int period) const { return static_cast<double>(period); }
  Cell operator()(bool flag) const { return flag ? 1.0 : 0.0; }
};
struct AsTypes {
  Cell operator()(int period) const { return std::int64_t{period}; }
  Cell operator()(bool flag) const { return flag; }
};

template <class Form = AsNumbers>
void append_point(std::vector<Cell>& cells, const Point& point, PointColumns columns, const Form& form = {}) {
  cells.insert(cells.end(),
               {point.omega, point.value.real(), point.value.imag(), std::string(backlash::to_string(point.regime)),
                form(point.period), point.impacts_per_period, point.uncertainty, point.third_harmonic_ratio});
  if (columns == PointColumns::basic) return;
  cells.insert(cells.end(), {point.even_harmonic_ratio, point.energy_defect, point.lyapunov_exponent,
                             point.periods_followed, form(point.transient_possible), point.force_sensitivity});
}

io::Metadata entries(std::initializer_list<std::pair<const char*, double>> numbers) {
  io::Metadata result;
  for (const auto& [key, value] : numbers) result.emplace_back(key, io::format_number(value));
  return result;
}

void append_options(io::Metadata& scene, const backlash::SweepOptions& options, bool with_mean_tolerance) {
  scene.emplace_back("output", backlash::to_string(options.output));
  scene.emplace_back("protocol", backlash::to_string(options.protocol));
  scene.emplace_back("tolerance", io::format_number(options.tolerance));
  if (with_mean_tolerance) scene.emplace_back("mean_tolerance", io::format_number(options.mean_tolerance));
}

io::Metadata scene_of(const backlash::DescribingFunctionSweep& sweep) {
  io::Metadata scene = entries({{"mass1_kg", sweep.system.mass1()},
                                {"mass2_kg", sweep.system.mass2()},
                                {"clearance_m", sweep.system.clearance()},
                                {"force_n", sweep.force_amplitude},
                                {"restitution", sweep.system.restitution()}});
  scene.emplace(scene.begin(), "model", "dynamic");
  append_options(scene, sweep.options, sweep.options.mean_tolerance > 0);
  return scene;
}

io::Metadata scene_of(const StaticCurve& curve) {
  io::Metadata scene = entries({{"mass1_kg", curve.mass1},
                                {"mass2_kg", curve.mass2},
                                {"clearance_m", curve.clearance},
                                {"force_n", curve.force_amplitude}});
  scene.emplace(scene.begin(), "model", "static");
  return scene;
}

Rows points_with_types(const std::vector<Point>& points) {
  return {point_columns(PointColumns::with_diagnostics), points.size(), [&](std::size_t i, std::vector<Cell>& cells) {
            append_point(cells, points[i], PointColumns::with_diagnostics, AsTypes{});
          }};
}

void append_sweep(Json& json, const io::Metadata& scene, const Rows& points) {
  json["scene"] = object_of(scene);
  json["points"] = array_of(points);
}

}  // namespace

Document document_of(const backlash::DescribingFunctionSweep& sweep, PointColumns columns) {
  return {scene_of(sweep),
          {point_columns(columns), sweep.points.size(),
           [&, columns](std::size_t i, std::vector<Cell>& cells) { append_point(cells, sweep.points[i], columns); }}};
}

Document document_of(const std::vector<backlash::DescribingFunctionSweep>& sweeps, PointColumns columns,
                     const io::Shard& shard) {
  const auto& first = sweeps.front();
  io::Metadata common = entries({{"mass1_kg", first.system.mass1()}, {"mass2_kg", first.system.mass2()}});
  common.emplace(common.begin(), "model", "dynamic");
  append_options(common, first.options, first.options.mean_tolerance > 0);
  const std::size_t width = first.points.size();  // all sweeps run over the same frequencies
  return {std::move(common),
          {point_columns(columns, {"force_n", "clearance_m", "restitution"}), sweeps.size() * width,
           [&sweeps, columns, width](std::size_t i, std::vector<Cell>& cells) {
             const auto& sweep = sweeps[i / width];
             cells.insert(cells.end(), {sweep.force_amplitude, sweep.system.clearance(), sweep.system.restitution()});
             append_point(cells, sweep.points[i % width], columns);
           }},
          shard};
}

Document document_of(const backlash::RegimeMap& map, const io::Shard& shard) {
  io::Metadata scene = entries({{"mass1_kg", map.scene.mass1},
                                {"mass2_kg", map.scene.mass2},
                                {"clearance_m", map.scene.clearance},
                                {"force_n", map.scene.force_amplitude}});
  append_options(scene, map.options, true);
  return {std::move(scene),
          {point_columns(PointColumns::with_diagnostics, {"restitution"}), map.points.size(),
           [&map](std::size_t i, std::vector<Cell>& cells) {
             const std::size_t width = map.omega.size();
             cells.emplace_back(map.restitution[i / width]);
             append_point(cells, map.at(i / width, i % width), PointColumns::with_diagnostics);
           }},
          shard};
}

Document document_of(const StaticCurve& curve) {
  return {scene_of(curve),
          {point_columns(PointColumns::basic), curve.omega.size(), [&](std::size_t i, std::vector<Cell>& cells) {
             constexpr double none = std::numeric_limits<double>::quiet_NaN();
             cells.insert(cells.end(), {curve.omega[i], curve.value[i].real(), curve.value[i].imag(),
                                        std::string("static"), none, none, none, none});
           }}};
}

std::string sweep_json(const backlash::DescribingFunctionSweep& sweep, const std::string& command) {
  Json json = origin(command);
  append_sweep(json, scene_of(sweep), points_with_types(sweep.points));
  return json.dump() + "\n";
}

std::string sweeps_json(const std::vector<backlash::DescribingFunctionSweep>& sweeps, const std::string& command) {
  Json json = origin(command);
  json["sweeps"] = Json::array();
  for (const auto& sweep : sweeps)
    append_sweep(json["sweeps"].push_back(Json::object()), scene_of(sweep), points_with_types(sweep.points));
  return json.dump() + "\n";
}

std::string static_curve_json(const StaticCurve& curve, const std::string& command) {
  Json json = origin(command);
  append_sweep(json, scene_of(curve),
               {{"omega_rad_s", "re_m_per_n", "im_m_per_n", "regime"},
                curve.omega.size(),
                [&](std::size_t i, std::vector<Cell>& cells) {
                  cells.insert(cells.end(),
                               {curve.omega[i], curve.value[i].real(), curve.value[i].imag(), std::string("static")});
                }});
  return json.dump() + "\n";
}

}  // namespace fracfit
