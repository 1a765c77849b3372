// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>

#include "arrays.hpp"
#include "backlash/rig_record.hpp"

namespace python {

/// Sensors of a rig from a dict: sample_time, sensor_noise, force_noise, quantisation, clip, sensor_delay,
/// clock_jitter, seed.
[[nodiscard]] inline backlash::RigSensors sensors_of(const pybind11::dict& given) {
  const auto number = [&](const char* key) { return given[key].cast<double>(); };
  backlash::RigSensors sensors;
  sensors.sample_time = number("sample_time");
  sensors.clock_jitter = number("clock_jitter");
  sensors.position = {number("sensor_delay"), number("sensor_noise"), number("clip"), number("quantisation")};
  sensors.force.noise = number("force_noise");
  sensors.seed = given["seed"].cast<std::uint64_t>();
  return sensors;
}

/// A record as a dict of its columns, and whether it holds the whole motion.
[[nodiscard]] inline pybind11::dict dict_of_record(backlash::RigRecord record) {
  pybind11::dict result;
  result["time"] = array_of(std::move(record.time));
  result["force"] = array_of(std::move(record.force));
  result["x1"] = array_of(std::move(record.x1));
  result["x2"] = array_of(std::move(record.x2));
  return result;
}

}  // namespace python
