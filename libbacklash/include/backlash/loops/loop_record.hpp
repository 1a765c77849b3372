// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "backlash/rig_record.hpp"

namespace backlash {

/// Rows of a loop for each sample of a record: between rows a record takes cubics, which err by the fourth power of
/// their length.
constexpr int loop_rows_per_sample = 8;

/// The motion of a loop as a record samples it; the force runs straight between rows.
/// @param rows  of simulate_loop(), or others with time, x1, v1, x2, v2 and force; times not falling
template <class Row>
[[nodiscard]] RigMotion rig_motion(const std::vector<Row>& rows) {
  RigMotion motion;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    motion.x1.add(rows[i].time, rows[i].x1, rows[i].v1);
    motion.x2.add(rows[i].time, rows[i].x2, rows[i].v2);
    if (i == 0) {
      motion.force.add(rows[i].time, rows[i].force, 0);
      continue;
    }
    const double length = rows[i].time - rows[i - 1].time;
    const double rate = length > 0 ? (rows[i].force - rows[i - 1].force) / length : 0;
    motion.force.add(rows[i - 1].time, rows[i - 1].force, rate);
    motion.force.add(rows[i].time, rows[i].force, rate);
  }
  return motion;
}

}  // namespace backlash
