// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "backlash/compliant/compliant_basins.hpp"
#include "backlash/compliant/compliant_history.hpp"
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

// Where the motion is after so many periods of the force; none where they hold too many impacts.
std::optional<backlash::RelativeState> state_after(const backlash::TwoMassSystem& system, double force, double omega,
                                                   backlash::RelativeState state, int periods) {
  // Parts that are followed at once, so that their impacts need not all be kept.
  constexpr int part = 1000;
  for (int left = periods; left > 0; left -= part) {
    const auto before = backlash::simulate_impacts(system, force, omega, state, std::min(left, part));
    if (!before.complete) return std::nullopt;
    state = before.end;
  }
  return state;
}

py::dict history(const Scene& scene, const std::optional<double>& position, double velocity, int skip, int periods,
                 int samples) {
  const backlash::TwoMassSystem system = system_of(scene);
  const double force = std::get<4>(scene), omega = std::get<5>(scene);
  const backlash::RelativeState start{position.value_or(0.5 * system.clearance()), velocity};
  const auto [motion, skipped] = result_of([&](frac::Progress&) {
    const auto from = state_after(system, force, omega, start, skip);
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
  result["contact_code"] = column_of<std::int8_t>(rows, [](const auto& row) { return code_of(row.wall); });
  result["complete"] = motion.complete;
  result["usable"] = skipped;
  return result;
}

backlash::CompliantBodies bodies_of(const Scene& scene, const std::array<double, 4>& contact) {
  const auto [stiffness, damping, friction1, friction2] = contact;
  return {backlash::free_mass(std::get<0>(scene)),
          backlash::free_mass(std::get<1>(scene)),
          std::get<2>(scene),
          backlash::CompliantContact(stiffness, damping),
          {friction1, friction2}};
}

// With contacts that take time; contact: stiffness, damping, and the friction of both masses.
py::dict compliant_history(const Scene& scene, const std::array<double, 4>& contact,
                           const std::optional<double>& position, double velocity, int skip, int periods, int samples) {
  const auto [mass1, mass2, clearance, restitution, force, omega] = scene;
  const backlash::CompliantBodies bodies = bodies_of(scene, contact);
  const double half = 0.5 * clearance;
  const backlash::LoopStart start =
      backlash::start_about_mean(bodies.system(), force, omega, {position.value_or(half), velocity});
  const double amplitude = force, frequency = omega;
  const auto motion = result_of([&](frac::Progress&) {
    return backlash::compliant_history(bodies, amplitude, frequency, start, skip, periods, samples);
  });
  const auto& rows = motion.rows;
  py::dict result;
  result["time"] = column_of<double>(rows, [](const auto& row) { return row.time; });
  result["x1"] = column_of<double>(rows, [](const auto& row) { return row.x1; });
  result["v1"] = column_of<double>(rows, [](const auto& row) { return row.v1; });
  result["x2"] = column_of<double>(rows, [half](const auto& row) { return row.x2 + half; });
  result["v2"] = column_of<double>(rows, [](const auto& row) { return row.v2; });
  result["event_code"] = column_of<std::int8_t>(rows, [](const auto& row) { return row.event; });
  result["contact_code"] = column_of<std::int8_t>(rows, [](const auto& row) { return code_of(row.wall); });
  result["contact_force"] = column_of<double>(rows, [](const auto& row) { return row.contact_force; });
  result["complete"] = motion.complete;
  result["usable"] = motion.complete;
  return result;
}

// What sensors read of the motion at one frequency after the other; `contact` where it takes time.
py::dict history_record(const Scene& scene, const std::optional<std::array<double, 4>>& contact, const Reals& omegas,
                        const std::optional<double>& position, double velocity, int skip, int periods,
                        const Sensors& given) {
  const backlash::RigSensors sensors = sensors_of(given);
  const std::vector<double> omega = vector_of(omegas);
  const double force = std::get<4>(scene), clearance = std::get<2>(scene);
  const backlash::RelativeState start{position.value_or(0.5 * clearance), velocity};
  auto [record, complete] = result_of([&](frac::Progress&) {
    const auto motion = [&]() -> std::optional<backlash::RigMotion> {
      if (contact) {
        const backlash::CompliantBodies bodies = bodies_of(scene, *contact);
        return backlash::rig_motion(bodies, force, omega,
                                    backlash::start_about_mean(bodies.system(), force, omega.front(), start), skip,
                                    periods);
      }
      const auto from = state_after(system_of(scene), force, omega.front(), start, skip);
      if (!from) return std::nullopt;
      return backlash::rig_motion(system_of(scene), force, omega, *from, periods);
    }();
    const bool is_whole = motion && motion->complete;
    return std::pair(is_whole ? rig_record(*motion, sensors) : backlash::RigRecord{}, is_whole);
  });
  return dict_of(std::move(record), sensors.sample_time, complete);
}

py::dict basins(const Scene& scene, const std::optional<std::array<double, 4>>& contact, const Reals& position,
                const Reals& velocity, const std::string& body, int threads, const py::object& report) {
  backlash::SweepOptions options;
  options.output = backlash::output_from_string(body);
  options.threads = threads;
  const std::vector<double> positions = vector_of(position), velocities = vector_of(velocity);
  const auto map = result_of(
      [&](frac::Progress& progress) {
        const auto found = [&](const auto& bodies) {
          return backlash::basins(bodies, std::get<4>(scene), std::get<5>(scene), positions, velocities, options,
                                  &progress);
        };
        return contact ? found(bodies_of(scene, *contact)) : found(system_of(scene));
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
  module.def("compliant_history", &compliant_history);
  module.def("history_record", &history_record);
  using backlash::CompliantEvent;
  module.attr("compliant_events") = py::tuple(
      words_of({CompliantEvent::sample, CompliantEvent::contact, CompliantEvent::separation, CompliantEvent::parting,
                CompliantEvent::stick1, CompliantEvent::slide1, CompliantEvent::reversal1, CompliantEvent::stick2,
                CompliantEvent::slide2, CompliantEvent::reversal2}));
  module.attr("history_events") =
      py::tuple(words_of({HistoryEvent::sample, HistoryEvent::before_impact, HistoryEvent::after_impact,
                          HistoryEvent::rest_begin, HistoryEvent::release}));
  module.def("basins", &basins);
}

}  // namespace python
