// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/rig_record.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "backlash/time_history.hpp"
#include "base/check.hpp"

namespace backlash {

frac::SignalPath stepped_sine_force(double force_amplitude, const std::vector<double>& omega, int periods, int steps) {
  using std::numbers::pi;
  frac::SignalPath path;
  double begin = 0;
  for (const double w : omega) {
    const double period = 2 * pi / w;
    for (int i = 0; i < periods; ++i)
      for (int k = 0; k < steps; ++k) {
        const double share = static_cast<double>(k) / steps;
        path.add(begin + (i + share) * period, force_amplitude * std::cos(2 * pi * share),
                 -force_amplitude * w * std::sin(2 * pi * share));
      }
    begin += periods * period;
  }
  path.add(begin, force_amplitude, 0);
  return path;
}

RigMotion rig_motion(const TwoMassSystem& system, double force_amplitude, const std::vector<double>& omega,
                     const RelativeState& start, int periods) {
  const TimeHistory history = stepped_sine_history(system, force_amplitude, omega, start, periods, rig_steps);
  RigMotion motion{stepped_sine_force(force_amplitude, omega, periods, rig_steps), {}, {}, history.complete};
  for (const HistoryRow& row : history.rows) {
    motion.x1.add(row.time, row.x1, row.v1);
    motion.x2.add(row.time, row.x2, row.v2);
  }
  return motion;
}

RigRecord rig_record(const RigMotion& motion, const RigSensors& sensors) {
  detail::require_positive("sample_time", "s", sensors.sample_time);
  for (const frac::SignalPath* path : {&motion.force, &motion.x1, &motion.x2})
    if (path->time.size() < 2)
      throw std::invalid_argument("motion has a signal of " + std::to_string(path->time.size()) +
                                  " entries; expected at least 2 in each");
  // Seven deviations: an instant outside has a chance of 10^-12.
  const double margin = 7 * sensors.clock_jitter;
  const double late = std::max(sensors.position.delay, sensors.force.delay);
  const double first = std::ceil((late + margin) / sensors.sample_time) * sensors.sample_time;
  // The paths end at the same peak, to rounding.
  const double end = std::min({motion.force.time.back(), motion.x1.time.back(), motion.x2.time.back()}) - margin;
  const double steps = std::floor((end - first) / sensors.sample_time);
  constexpr double most = 1e7;
  if (!(steps >= 0 && steps < most))
    throw std::invalid_argument("sample_time is " + detail::text(sensors.sample_time) + " s, of which a motion of " +
                                detail::text(motion.force.time.back()) + " s has " +
                                detail::text(std::max(steps + 1, 0.0)) +
                                " samples after delay and jitter; expected 1 to 1e7");
  RigRecord record;
  const auto count = static_cast<std::size_t>(steps) + 1;
  const auto instants = frac::sampling_instants(first, sensors.sample_time, count, sensors.clock_jitter, sensors.seed);
  record.time = frac::sampling_instants(first, sensors.sample_time, count, 0, sensors.seed);
  record.force = frac::sensor_readings(motion.force, instants, sensors.force, sensors.seed + 1);
  record.x1 = frac::sensor_readings(motion.x1, instants, sensors.position, sensors.seed + 2);
  record.x2 = frac::sensor_readings(motion.x2, instants, sensors.position, sensors.seed + 3);
  if (!motion.set_point.time.empty())
    record.set_point = frac::sensor_readings(motion.set_point, instants, {}, sensors.seed);
  return record;
}

}  // namespace backlash
