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

SweepTable map_table(const backlash::MapScene& scene, const std::vector<double>& restitution,
                     const backlash::SweepOptions& options, const io::Shard& shard) {
  io::Metadata head = entries({{"mass1_kg", scene.mass1},
                               {"mass2_kg", scene.mass2},
                               {"clearance_m", scene.clearance},
                               {"force_n", scene.force_amplitude}});
  append_options(head, options, true);
  return {std::move(head), point_columns(PointColumns::with_diagnostics, {"restitution"}),
          PointColumns::with_diagnostics,
          [restitution](std::size_t curve) { return std::vector<Cell>{restitution[curve]}; }, shard};
}

SweepTable sweep_table(const std::vector<backlash::SweepScene>& all, const std::vector<backlash::SweepScene>& part,
                       const backlash::SweepOptions& options, PointColumns columns, const io::Shard& shard) {
  const backlash::SweepScene& first = all.front();
  if (all.size() == 1)
    return {scene_of({first.system, first.force_amplitude, options, {}}), point_columns(columns), columns,
            [](std::size_t) { return std::vector<Cell>(); }, shard};
  io::Metadata head = entries({{"mass1_kg", first.system.mass1()}, {"mass2_kg", first.system.mass2()}});
  head.emplace(head.begin(), "model", "dynamic");
  append_options(head, options, options.mean_tolerance > 0);
  return {std::move(head), point_columns(columns, {"force_n", "clearance_m", "restitution"}), columns,
          [part](std::size_t curve) {
            const backlash::SweepScene& scene = part[curve];
            return std::vector<Cell>{scene.force_amplitude, scene.system.clearance(), scene.system.restitution()};
          },
          shard};
}

Document document_of(const SweepTable& table, std::size_t first, std::size_t width, const std::vector<Point>& points) {
  return {table.head,
          {table.columns, points.size(),
           [&table, &points, first, width](std::size_t i, std::vector<Cell>& cells) {
             for (Cell& cell : table.in_front(first + i / width)) cells.push_back(std::move(cell));
             append_point(cells, points[i], table.points);
           }},
          table.shard};
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
