// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

#include "backlash/loops/simulate_loop.hpp"
#include "backlash/rig_record.hpp"

namespace backlash {

/// Rows of a loop for each sample of a record: between rows a record takes cubics, which err by the fourth power of
/// their length.
constexpr int loop_rows_per_sample = 8;

/// Whether a set-point goes on after its step and beside its ramp: it then tells a record what drives the loop.
[[nodiscard]] inline bool drives(const SetPoint& set_point) {
  return set_point.sine_amplitude != 0 || !set_point.knots.empty();
}

/// A set-point at a time from 0 on, before its lag, m.
[[nodiscard]] inline double value_at(const SetPoint& set_point, double time) {
  const auto& knots = set_point.knots;
  const double value =
      set_point.step + set_point.ramp * time + set_point.sine_amplitude * std::sin(set_point.sine_omega * time);
  if (knots.empty()) return value;
  const auto next = std::upper_bound(knots.begin() + 1, knots.end(), time,
                                     [](double t, const SetPointKnot& knot) { return t < knot.time; });
  if (next == knots.end()) return value + knots.back().value;
  const SetPointKnot& before = *std::prev(next);
  return value + before.value + (time - before.time) / (next->time - before.time) * (next->value - before.value);
}

/// The motion of a loop as a record samples it; force and set-point run straight between rows.
/// @param rows  of simulate_loop(), or others with time, x1, v1, x2, v2 and force; times not falling
template <class Row>
[[nodiscard]] RigMotion rig_motion(const std::vector<Row>& rows, const SetPoint& set_point) {
  RigMotion motion;
  const auto add_line = [](frac::SignalPath& path, double from, double from_value, double to, double to_value) {
    const double rate = to > from ? (to_value - from_value) / (to - from) : 0;
    path.add(from, from_value, rate);
    path.add(to, to_value, rate);
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    motion.x1.add(rows[i].time, rows[i].x1, rows[i].v1);
    motion.x2.add(rows[i].time, rows[i].x2, rows[i].v2);
    const Row& before = rows[i == 0 ? 0 : i - 1];
    add_line(motion.force, before.time, before.force, rows[i].time, rows[i].force);
    if (drives(set_point))
      add_line(motion.set_point, before.time, value_at(set_point, before.time), rows[i].time,
               value_at(set_point, rows[i].time));
  }
  return motion;
}

}  // namespace backlash
