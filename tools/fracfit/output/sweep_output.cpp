// SPDX-License-Identifier: BSD-3-Clause
#include "output/sweep_output.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "backlash/loss_factor.hpp"
#include "io/frequency_response_file.hpp"
#include "io/number.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

using Point = backlash::DescribingFunctionPoint;

std::vector<std::string> point_columns(const PointForm& form, std::vector<std::string> in_front = {}) {
  const bool inverse = form.quantity == backlash::Quantity::minus_inverse;
  const auto names = [&](std::initializer_list<const char*> list) {
    in_front.insert(in_front.end(), list.begin(), list.end());
  };
  names({"omega_rad_s", inverse ? "re_n_per_m" : "re_m_per_n", inverse ? "im_n_per_m" : "im_m_per_n", "regime",
         "period", "impacts_per_period", inverse ? "uncertainty_n_per_m" : "uncertainty_m_per_n",
         "third_harmonic_ratio"});
  if (form.columns == PointColumns::with_diagnostics)
    names({"even_harmonic_ratio", "energy_defect", "lyapunov_exponent", "periods_followed", "transient_possible",
           "force_sensitivity"});
  if (form.loss_factor) names({"frequency_ratio", "loss_factor"});
  return in_front;
}

// Value and uncertainty as they are written; nan where N is 0 and has no -1/N.
backlash::MinusInverse written(const Point& point, backlash::Quantity quantity) {
  if (quantity == backlash::Quantity::n) return {point.value, point.uncertainty};
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  return backlash::minus_inverse(point).value_or(backlash::MinusInverse{{none, none}, none});
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

void append_loss_factor(std::vector<Cell>& cells, const backlash::SweepScene& scene, double omega,
                        std::complex<double> minus_inverse) {
  cells.insert(cells.end(), {backlash::frequency_ratio(scene.system, scene.force_amplitude, omega),
                             backlash::loss_factor(scene.system, minus_inverse, omega)});
}

template <class Form = AsNumbers>
void append_point(std::vector<Cell>& cells, const Point& point, const PointForm& form,
                  const backlash::SweepScene& scene, const Form& as = {}) {
  const backlash::MinusInverse shown = written(point, form.quantity);
  cells.insert(cells.end(),
               {point.omega, shown.value.real(), shown.value.imag(), std::string(backlash::to_string(point.regime)),
                as(point.period), point.impacts_per_period, shown.uncertainty, point.third_harmonic_ratio});
  if (form.columns == PointColumns::with_diagnostics)
    cells.insert(cells.end(), {point.even_harmonic_ratio, point.energy_defect, point.lyapunov_exponent,
                               point.periods_followed, as(point.transient_possible), point.force_sensitivity});
  if (form.loss_factor) append_loss_factor(cells, scene, point.omega, shown.value);
}

io::Metadata entries(std::initializer_list<std::pair<const char*, double>> numbers) {
  io::Metadata result;
  for (const auto& [key, value] : numbers) result.emplace_back(key, io::format_number(value));
  return result;
}

// Only -1/N is told: N is what a curve holds that says nothing.
void append_quantity(io::Metadata& scene, backlash::Quantity quantity) {
  if (quantity != backlash::Quantity::n) scene.emplace_back(io::quantity_key, backlash::to_string(quantity));
}

void append_options(io::Metadata& scene, const backlash::SweepOptions& options, bool with_mean_tolerance,
                    backlash::Quantity quantity) {
  scene.emplace_back("output", backlash::to_string(options.output));
  scene.emplace_back("protocol", backlash::to_string(options.protocol));
  scene.emplace_back("tolerance", io::format_number(options.tolerance));
  if (with_mean_tolerance) scene.emplace_back("mean_tolerance", io::format_number(options.mean_tolerance));
  append_quantity(scene, quantity);
}

io::Metadata scene_of(const backlash::DescribingFunctionSweep& sweep, backlash::Quantity quantity) {
  io::Metadata scene = entries({{"mass1_kg", sweep.system.mass1()},
                                {"mass2_kg", sweep.system.mass2()},
                                {"clearance_m", sweep.system.clearance()},
                                {"force_n", sweep.force_amplitude},
                                {"restitution", sweep.system.restitution()}});
  scene.emplace(scene.begin(), "model", "dynamic");
  append_options(scene, sweep.options, sweep.options.mean_tolerance > 0, quantity);
  return scene;
}

// Entries of a contact in place of the restitution.
io::Metadata with_contact(io::Metadata scene, const io::Metadata& contact) {
  if (contact.empty()) return scene;
  const auto restitution =
      std::find_if(scene.begin(), scene.end(), [](const auto& entry) { return entry.first == "restitution"; });
  scene.insert(scene.erase(restitution), contact.begin(), contact.end());
  return scene;
}

io::Metadata scene_of(const StaticCurve& curve, backlash::Quantity quantity) {
  io::Metadata scene = entries({{"mass1_kg", curve.mass1},
                                {"mass2_kg", curve.mass2},
                                {"clearance_m", curve.clearance},
                                {"force_n", curve.force_amplitude}});
  scene.emplace(scene.begin(), "model", "static");
  append_quantity(scene, quantity);
  return scene;
}

Rows points_with_types(const backlash::DescribingFunctionSweep& sweep, const PointForm& form) {
  return {point_columns(form), sweep.points.size(), [&sweep, form](std::size_t i, std::vector<Cell>& cells) {
            append_point(cells, sweep.points[i], form, {sweep.system, sweep.force_amplitude}, AsTypes{});
          }};
}

// Rows of the closed form, which knows frequency and value; `whole` has the other columns of a point too.
Rows static_rows(const StaticCurve& curve, backlash::Quantity quantity, bool whole) {
  const bool inverse = quantity == backlash::Quantity::minus_inverse;
  std::vector<std::string> columns = point_columns({PointColumns::basic, quantity, inverse});
  if (!whole) columns.erase(columns.begin() + 4, columns.begin() + 8);
  // The closed form has no impacts, so that restitution has no part in it.
  const backlash::SweepScene scene{{curve.mass1, curve.mass2, curve.clearance, 1}, curve.force_amplitude};
  return {std::move(columns), curve.omega.size(),
          [&curve, scene, quantity, whole, inverse](std::size_t i, std::vector<Cell>& cells) {
            constexpr double none = std::numeric_limits<double>::quiet_NaN();
            Point point{};
            point.value = curve.value[i];
            const auto value = written(point, quantity).value;
            cells.insert(cells.end(), {curve.omega[i], value.real(), value.imag(), std::string("static")});
            if (whole) cells.insert(cells.end(), {none, none, none, none});
            if (inverse) append_loss_factor(cells, scene, curve.omega[i], value);
          }};
}

void append_sweep(Json& json, const io::Metadata& scene, const Rows& points) {
  json["scene"] = object_of(scene);
  json["points"] = array_of(points);
}

}  // namespace

SweepTable map_table(const backlash::MapScene& scene, const std::vector<double>& restitution,
                     const backlash::SweepOptions& options, const PointForm& form, const io::Shard& shard) {
  io::Metadata head = entries({{"mass1_kg", scene.mass1},
                               {"mass2_kg", scene.mass2},
                               {"clearance_m", scene.clearance},
                               {"force_n", scene.force_amplitude}});
  append_options(head, options, true, form.quantity);
  return {std::move(head), point_columns(form, {"restitution"}), form,
          // More shards than restitutions leave some without any.
          restitution.empty() ? std::vector<backlash::SweepScene>{} : backlash::map_scenes(scene, restitution),
          [restitution](std::size_t curve) { return std::vector<Cell>{restitution[curve]}; }, shard};
}

SweepTable sweep_table(const std::vector<backlash::SweepScene>& all, const std::vector<backlash::SweepScene>& part,
                       const backlash::SweepOptions& options, const PointForm& form, const io::Shard& shard) {
  const backlash::SweepScene& first = all.front();
  if (all.size() == 1)
    return {scene_of({first.system, first.force_amplitude, options, {}}, form.quantity),
            point_columns(form),
            form,
            part,
            [](std::size_t) { return std::vector<Cell>(); },
            shard};
  io::Metadata head = entries({{"mass1_kg", first.system.mass1()}, {"mass2_kg", first.system.mass2()}});
  head.emplace(head.begin(), "model", "dynamic");
  append_options(head, options, options.mean_tolerance > 0, form.quantity);
  return {std::move(head),
          point_columns(form, {"force_n", "clearance_m", "restitution"}),
          form,
          part,
          [part](std::size_t curve) {
            const backlash::SweepScene& scene = part[curve];
            return std::vector<Cell>{scene.force_amplitude, scene.system.clearance(), scene.system.restitution()};
          },
          shard};
}

io::Metadata friction_entries(const backlash::CoulombFriction& friction) {
  return {{"friction1_n", io::format_number(friction.body1)}, {"friction2_n", io::format_number(friction.body2)}};
}

SweepTable compliant_table(const backlash::SweepScene& scene, const std::vector<LabelledScene>& part,
                           const std::vector<std::string>& labels, const io::Metadata& contact,
                           const backlash::SweepOptions& options, const PointForm& form, const io::Shard& shard) {
  io::Metadata head{{"model", "dynamic"}};
  for (const auto& [key, value] :
       {std::pair{"mass1_kg", scene.system.mass1()}, std::pair{"mass2_kg", scene.system.mass2()},
        std::pair{"clearance_m", scene.system.clearance()}, std::pair{"force_n", scene.force_amplitude}})
    if (std::find(labels.begin(), labels.end(), key) == labels.end()) head.emplace_back(key, io::format_number(value));
  head.insert(head.end(), contact.begin(), contact.end());
  append_options(head, options, options.mean_tolerance > 0, form.quantity);
  std::vector<backlash::SweepScene> scenes;
  for (const LabelledScene& each : part) scenes.push_back({each.scene.bodies.system(), each.scene.force_amplitude});
  return {std::move(head),
          point_columns(form, labels),
          form,
          std::move(scenes),
          [part](std::size_t curve) { return std::vector<Cell>(part[curve].labels.begin(), part[curve].labels.end()); },
          shard};
}

Document document_of(const SweepTable& table, std::size_t first, std::size_t width, const std::vector<Point>& points) {
  return {table.head,
          {table.columns, points.size(),
           [&table, &points, first, width](std::size_t i, std::vector<Cell>& cells) {
             const std::size_t curve = first + i / width;
             for (Cell& cell : table.in_front(curve)) cells.push_back(std::move(cell));
             append_point(cells, points[i], table.form, table.scenes[curve]);
           }},
          table.shard};
}

Document document_of(const StaticCurve& curve, backlash::Quantity quantity) {
  return {scene_of(curve, quantity), static_rows(curve, quantity, true)};
}

std::string sweep_json(const backlash::DescribingFunctionSweep& sweep, const PointForm& form,
                       const std::string& command, const io::Metadata& contact) {
  Json json = origin(command);
  append_sweep(json, with_contact(scene_of(sweep, form.quantity), contact), points_with_types(sweep, form));
  return json.dump() + "\n";
}

std::string sweeps_json(const std::vector<backlash::DescribingFunctionSweep>& sweeps, const PointForm& form,
                        const std::string& command, const std::vector<io::Metadata>& contacts) {
  Json json = origin(command);
  json["sweeps"] = Json::array();
  for (std::size_t i = 0; i < sweeps.size(); ++i)
    append_sweep(json["sweeps"].push_back(Json::object()),
                 with_contact(scene_of(sweeps[i], form.quantity), contacts.empty() ? io::Metadata() : contacts[i]),
                 points_with_types(sweeps[i], form));
  return json.dump() + "\n";
}

std::string static_curve_json(const StaticCurve& curve, backlash::Quantity quantity, const std::string& command) {
  Json json = origin(command);
  append_sweep(json, scene_of(curve, quantity), static_rows(curve, quantity, false));
  return json.dump() + "\n";
}

}  // namespace fracfit
