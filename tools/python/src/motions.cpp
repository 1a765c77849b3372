// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "backlash/basins.hpp"
#include "backlash/rig_record.hpp"
#include "backlash/time_history.hpp"
#include "parts.hpp"
#include "rig.hpp"
#include "run.hpp"

namespace python {
namespace {

using Scene = std::tuple<double, double, double, double, double, double>;

// mass1, mass2, clearance, restitution; force and omega stand behind them.
backlash::TwoMassSystem system_of(const Scene& scene) {
  return {std::get<0>(scene), std::get<1>(scene), std::get<2>(scene), std::get<3>(scene)};
}

/// Where a motion is after some periods, followed in parts, so that their impacts need not all be kept; nothing where
/// these hold more than can be followed.
std::optional<backlash::RelativeState> skipped(const backlash::TwoMassSystem& system, double force, double omega,
                                               backlash::RelativeState from, int periods) {
  constexpr int part = 1000;
  for (int left = periods; left > 0; left -= part) {
    const auto before = backlash::simulate_impacts(system, force, omega, from, std::min(left, part));
    if (!before.complete) return std::nullopt;
    from = before.end;
  }
  return from;
}

// A record of a stepped sine, at the force of the scene.
py::dict history_record(const Scene& scene, const std::vector<double>& omega, const std::optional<double>& position,
                        double velocity, int skip, int periods, const Sensors& given) {
  const backlash::TwoMassSystem system = system_of(scene);
  const double force = std::get<4>(scene);
  const backlash::RigSensors sensors = sensors_of(given);
  const backlash::RelativeState start{position.value_or(0.5 * system.clearance()), velocity};
  auto [record, complete] = result_of([&](frac::Progress&) {
    const auto from = skipped(system, force, omega.at(0), start, skip);
    if (!from) return std::pair(backlash::RigRecord{}, false);
    const backlash::RigMotion motion = backlash::rig_motion(system, force, omega, *from, periods);
    return std::pair(motion.complete ? rig_record(motion, sensors) : backlash::RigRecord{}, motion.complete);
  });
  return dict_of(std::move(record), sensors.sample_time, complete);
}

py::dict history(const Scene& scene, const std::optional<double>& position, double velocity, int skip, int periods,
                 int samples) {
  const backlash::TwoMassSystem system = system_of(scene);
  const double force = std::get<4>(scene), omega = std::get<5>(scene);
  const backlash::RelativeState start{position.value_or(0.5 * system.clearance()), velocity};
  const auto [motion, is_skipped] = result_of([&](frac::Progress&) {
    const auto from = skipped(system, force, omega, start, skip);
    if (!from) return std::pair(backlash::TimeHistory{{}, false, start}, false);
    return std::pair(backlash::time_history(system, force, omega, *from, periods, samples), true);
  });
  const auto& rows = motion.rows;
  py::dict result;
  result["time"] = column_of<double>(rows, [](const auto& row) { return row.time; });
  result["x1"] = column_of<double>(rows, [](const auto& row) { return row.x1; });
  result["v1"] = column_of<double>(rows, [](const auto& row) { return row.v1; });
  result["x2"] = column_of<double>(rows, [](const auto& row) { return row.x2; });
  result["v2"] = column_of<double>(rows, [](const auto& row) { return row.v2; });
  result["event_code"] = column_of<std::int8_t>(rows, [](const auto& row) { return row.event; });
  // 0: none, 1: near, 2: far.
  result["contact_code"] = column_of<std::int8_t>(rows, [](const auto& row) {
    return !row.wall ? 0 : *row.wall == backlash::Wall::near ? 1 : 2;
  });
  result["complete"] = motion.complete;
  result["usable"] = is_skipped;
  return result;
}

py::dict basins(const Scene& scene, const Reals& position, const Reals& velocity, const std::string& body, int threads,
                const py::object& report) {
  backlash::SweepOptions options;
  options.output = backlash::output_from_string(body);
  options.threads = threads;
  const std::vector<double> positions = vector_of(position), velocities = vector_of(velocity);
  const auto map = result_of(
      [&](frac::Progress& progress) {
        return backlash::basins(system_of(scene), std::get<4>(scene), std::get<5>(scene), positions, velocities,
                                options, &progress);
      },
      report);
  py::list attractors;
  for (const auto& each : map.attractors) {
    py::dict entry;
    entry["regime"] = std::string(backlash::to_string(each.point.regime));
    entry["period"] = each.point.period;
    entry["impacts_per_period"] = each.point.impacts_per_period;
    entry["symmetric"] = each.symmetric;
    entry["response"] = each.point.value;
    entry["uncertainty"] = each.point.uncertainty;
    entry["starts"] = each.starts;
    attractors.append(entry);
  }
  std::vector<std::int64_t> attractor(map.attractor.begin(), map.attractor.end());
  py::dict result;
  result["position"] = array_of(map.position);
  result["velocity"] = array_of(map.velocity);
  result["attractor"] = array_of(std::move(attractor), {static_cast<py::ssize_t>(map.position.size()),
                                                        static_cast<py::ssize_t>(map.velocity.size())});
  result["attractors"] = attractors;
  result["attracts"] = map.attracts();
  return result;
}

}  // namespace

void add_motions(py::module_& module) {
  using backlash::HistoryEvent;
  module.def("history", &history);
  module.def("history_record", &history_record);
  module.attr("history_events") =
      py::tuple(words_of({HistoryEvent::sample, HistoryEvent::before_impact, HistoryEvent::after_impact,
                          HistoryEvent::rest_begin, HistoryEvent::release}));
  module.def("basins", &basins);
}

}  // namespace python
