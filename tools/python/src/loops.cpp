// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "arrays.hpp"
#include "backlash/compliant/compliant_cycles.hpp"
#include "backlash/compliant/compliant_loop.hpp"
#include "backlash/loops/impact_cycles.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/loops/loop_record.hpp"
#include "backlash/loops/predicted_cycles.hpp"
#include "backlash/loops/simulate_loop.hpp"
#include "backlash/loops/simulate_sampled_loop.hpp"
#include "described.hpp"
#include "loop_parts.hpp"
#include "parts.hpp"
#include "rig.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict compliant_cycles(const backlash::CompliantLoop& loop, const std::optional<std::pair<double, double>>& range,
                          int harmonics, int starts) {
  backlash::CompliantCycleOptions options;
  if (range) options.range = backlash::FrequencyRange{range->first, range->second};
  options.harmonics = harmonics;
  options.starts = starts;
  const auto found = result_of([&](frac::Progress&) { return backlash::compliant_cycles(loop, options); });
  py::list cycles, predicted, motions;
  for (const auto& cycle : found.cycles) {
    cycles.append(cycle_of(cycle));
    if (cycle.predicted)
      predicted.append(py::dict(py::arg("omega") = cycle.predicted->omega,
                                py::arg("force_amplitude") = cycle.predicted->force_amplitude,
                                py::arg("stable") = cycle.predicted->stable));
  }
  for (const auto& motion : found.motions) motions.append(std::string(backlash::to_string(motion.regime)));
  const backlash::RestRange rests = backlash::rest_range(loop, 0);
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  return py::dict(py::arg("cycles") = cycles, py::arg("predicted") = predicted, py::arg("motions") = motions,
                  py::arg("searched") = py::make_tuple(unknown, unknown), py::arg("certain") = false,
                  py::arg("any_frequency") = false, py::arg("rests") = py::make_tuple(rests.from, rests.to));
}

py::dict cycles(const frac::FractionalTransferFunction& controller, const py::dict& bodies,
                const std::optional<std::pair<double, double>>& range, int harmonics, int starts, bool branches) {
  if (const auto compliant = compliant_of(bodies))
    return compliant_cycles({*compliant, controller, body_of(bodies)}, range, harmonics, starts);
  const backlash::ControlLoop loop = loop_of(controller, bodies);
  backlash::LimitCycleOptions options;
  if (range) options.range = backlash::FrequencyRange{range->first, range->second};
  options.harmonics = harmonics;
  backlash::ImpactCycleOptions seeded;
  seeded.starts = starts;
  seeded.harmonics = harmonics;
  const bool can_start = loop.measured() == backlash::Output::x1 || loop.controller().delay() == 0;
  const auto [exact, predicted, settled] = result_of([&](frac::Progress&) {
    auto all = backlash::predicted_limit_cycles(loop, options.range);
    if (branches) {
      const auto further = backlash::predicted_cycles_of_more_impacts(loop, options.range);
      all.insert(all.end(), further.begin(), further.end());
    }
    return std::tuple(backlash::symmetric_cycles(loop, options), std::move(all),
                      can_start && starts > 0 ? backlash::impact_cycles(loop, seeded) : backlash::ImpactCycles{});
  });
  py::list found;
  for (const auto& cycle : exact.cycles) found.append(cycle_of(cycle));
  for (const auto* cycle : backlash::further_cycles(settled.cycles, exact.cycles)) found.append(cycle_of(*cycle));
  py::list motions;
  for (const auto& motion : settled.motions) motions.append(std::string(backlash::to_string(motion.regime)));
  py::dict result;
  result["cycles"] = found;
  result["predicted"] = object_of(predicted);
  result["motions"] = motions;
  result["searched"] = py::make_tuple(exact.searched.from, exact.searched.to);
  result["certain"] = exact.certain;
  result["any_frequency"] = exact.any_frequency;
  result["rests"] = py::none();
  return result;
}

template <class Row>
py::dict dict_of_rows(const std::vector<Row>& rows) {
  py::dict result;
  result["contact_force"] = py::none();
  result["contact_code"] = py::none();
  if constexpr (std::is_same_v<Row, backlash::CompliantLoopRow>) {
    result["contact_force"] = column_of<double>(rows, [](const auto& row) { return row.contact_force; });
    result["contact_code"] = column_of<std::int8_t>(rows, [](const auto& row) { return code_of(row.wall); });
  }
  result["time"] = column_of<double>(rows, [](const auto& row) { return row.time; });
  result["x1"] = column_of<double>(rows, [](const auto& row) { return row.x1; });
  result["v1"] = column_of<double>(rows, [](const auto& row) { return row.v1; });
  result["x2"] = column_of<double>(rows, [](const auto& row) { return row.x2; });
  result["v2"] = column_of<double>(rows, [](const auto& row) { return row.v2; });
  result["force"] = column_of<double>(rows, [](const auto& row) { return row.force; });
  result["event_code"] = column_of<std::int8_t>(rows, [](const auto& row) { return row.event; });
  return result;
}

backlash::SetPoint set_point_of(const py::dict& given) {
  backlash::SetPoint set_point;
  set_point.step = given["setpoint_step"].cast<double>();
  set_point.ramp = given["setpoint_ramp"].cast<double>();
  set_point.lag = given["setpoint_lag"].cast<double>();
  if (!given["setpoint_sine"].is_none())
    std::tie(set_point.sine_amplitude, set_point.sine_omega) = given["setpoint_sine"].cast<std::pair<double, double>>();
  if (!given["setpoint_time"].is_none()) {
    const auto time = given["setpoint_time"].cast<Reals>(), value = given["setpoint_value"].cast<Reals>();
    for (py::ssize_t i = 0; i < time.size(); ++i) set_point.knots.push_back({time.data()[i], value.data()[i]});
  }
  return set_point;
}

template <class History>
py::dict dict_of_history(const History& history) {
  py::dict result = dict_of_rows(history.rows);
  if constexpr (std::is_same_v<History, backlash::CompliantLoopHistory>)
    result["impacts"] = history.contacts;
  else
    result["impacts"] = history.impacts.size();
  result["end"] = std::string(backlash::to_string(history.end));
  result["end_time"] = history.end_time;
  result["realisation_error"] = history.realisation_error;
  result["note"] = "";
  return result;
}

// Of a motion followed from impact to impact, or from event to event.
template <class Loop>
py::dict followed(const Loop& loop, const backlash::SetPoint& set_point, const py::dict& given) {
  const auto number = [&](const char* key) { return given[key].cast<double>(); };
  backlash::LoopSimulationOptions options;
  options.duration = number("duration");
  options.sample_time = number("every");
  options.force_limit = number("force_limit");
  std::tie(options.disturbance.body1, options.disturbance.body2) =
      given["disturbance"].cast<std::pair<double, double>>();
  options.tolerance = number("tolerance");
  options.whole_memory = given["whole_memory"].cast<bool>();
  options.most_impacts = given["impacts"].cast<std::size_t>();
  const auto as_read = given["sensors"].cast<std::optional<Sensors>>();
  if (as_read) options.sample_time /= backlash::loop_rows_per_sample;
  const backlash::LoopStart start{0, number("velocity1"), 0, number("velocity2")};
  const auto history =
      result_of([&](frac::Progress&) { return backlash::simulate_loop(loop, start, set_point, options); });
  if (as_read) {
    const backlash::RigSensors sensors = sensors_of(*as_read);
    auto record =
        result_of([&](frac::Progress&) { return rig_record(backlash::rig_motion(history.rows, set_point), sensors); });
    return dict_of(std::move(record), sensors.sample_time, history.end == backlash::LoopEnd::duration);
  }
  return dict_of_history(history);
}

template <class Loop>
py::dict sampled(const Loop& loop, const backlash::SetPoint& set_point, const py::dict& given) {
  const auto number = [&](const char* key) { return given[key].cast<double>(); };
  backlash::SampledLoopOptions options;
  options.sample_time = number("sample_time");
  options.duration = number("duration");
  options.force_limit = number("force_limit");
  options.velocity1 = number("velocity1");
  options.velocity2 = number("velocity2");
  options.encoder_step = number("encoder_step");
  options.set_point = set_point;
  std::tie(options.disturbance.body1, options.disturbance.body2) =
      given["disturbance"].cast<std::pair<double, double>>();
  py::dict result;
  const auto history = result_of([&](frac::Progress&) { return backlash::simulate_sampled_loop(loop, options); });
  if constexpr (std::is_same_v<Loop, backlash::CompliantLoop>) {
    result = dict_of_history(history);
    result["note"] = frac::FractionalPidDesign(backlash::sampled_controller(loop.hard(), options)).note();
  } else {
    result = dict_of_rows(history.rows);
    result["impacts"] = history.impacts;
    result["end"] = std::string(backlash::to_string(backlash::LoopEnd::duration));
    result["end_time"] = options.duration;
    result["realisation_error"] = 0.0;
    result["note"] = frac::FractionalPidDesign(backlash::sampled_controller(loop, options)).note();
  }
  return result;
}

py::dict simulated(const frac::FractionalTransferFunction& controller, const py::dict& bodies, const py::dict& given) {
  const backlash::SetPoint set_point = set_point_of(given);
  const bool is_sampled = !given["sample_time"].is_none();
  if (const auto compliant = compliant_of(bodies)) {
    const backlash::CompliantLoop loop(*compliant, controller, body_of(bodies));
    return is_sampled ? sampled(loop, set_point, given) : followed(loop, set_point, given);
  }
  const backlash::ControlLoop loop = loop_of(controller, bodies);
  return is_sampled ? sampled(loop, set_point, given) : followed(loop, set_point, given);
}

}  // namespace

void add_loops(py::module_& module) {
  module.def("limit_cycles", &cycles);
  module.def("loop", &simulated);
  module.attr("loop_events") = py::tuple(
      words_of({backlash::LoopEvent::sample, backlash::LoopEvent::before_impact, backlash::LoopEvent::after_impact,
                backlash::LoopEvent::contact, backlash::LoopEvent::release}));
}

}  // namespace python
