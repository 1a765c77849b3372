// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "backlash/impact_simulation.hpp"
#include "backlash/rig_record.hpp"

namespace python {

/// Sample time, noise of positions and of the force, step and limit of the converter, delay, jitter, seed.
using Sensors = std::tuple<double, double, double, double, double, double, double, std::uint64_t>;

[[nodiscard]] inline backlash::RigSensors sensors_of(const Sensors& given) {
  backlash::RigSensors sensors;
  std::tie(sensors.sample_time, sensors.position.noise, sensors.force.noise, sensors.position.quantisation,
           sensors.position.clip, sensors.position.delay, sensors.clock_jitter, sensors.seed) = given;
  return sensors;
}

[[nodiscard]] inline py::dict dict_of(backlash::RigRecord record, double sample_time, bool complete) {
  py::dict result;
  result["time"] = array_of(std::move(record.time));
  result["force"] = array_of(std::move(record.force));
  result["x1"] = array_of(std::move(record.x1));
  result["x2"] = array_of(std::move(record.x2));
  result["set_point"] = array_of(std::move(record.set_point));
  result["sample_time"] = sample_time;
  result["complete"] = complete;
  return result;
}

/// Of a wall: 0: none, 1: near, 2: far.
[[nodiscard]] inline std::int8_t code_of(const std::optional<backlash::Wall>& wall) {
  return static_cast<std::int8_t>(!wall ? 0 : *wall == backlash::Wall::near ? 1 : 2);
}

}  // namespace python
