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
#include "backlash/time_history.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

using Scene = std::tuple<double, double, double, double, double, double>;

// mass1, mass2, clearance, restitution; force and omega stand behind them.
backlash::TwoMassSystem system_of(const Scene& scene) {
  return {std::get<0>(scene), std::get<1>(scene), std::get<2>(scene), std::get<3>(scene)};
}

py::dict history(const Scene& scene, const std::optional<double>& position, double velocity, int skip, int periods,
                 int samples) {
  // Parts that are followed at once before the first row, so that their impacts need not all be kept.
  constexpr int part = 1000;
  const backlash::TwoMassSystem system = system_of(scene);
  const double force = std::get<4>(scene), omega = std::get<5>(scene);
  const backlash::RelativeState start{position.value_or(0.5 * system.clearance()), velocity};
  const auto [motion, skipped] = result_of([&](frac::Progress&) {
    backlash::RelativeState from = start;
    for (int left = skip; left > 0; left -= part) {
      const auto before = backlash::simulate_impacts(system, force, omega, from, std::min(left, part));
      if (!before.complete) return std::pair(backlash::TimeHistory{{}, false, before.end}, false);
      from = before.end;
    }
    return std::pair(backlash::time_history(system, force, omega, from, periods, samples), true);
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
  result["usable"] = skipped;
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
  module.attr("history_events") =
      py::tuple(words_of({HistoryEvent::sample, HistoryEvent::before_impact, HistoryEvent::after_impact,
                          HistoryEvent::rest_begin, HistoryEvent::release}));
  module.def("basins", &basins);
}

}  // namespace python
