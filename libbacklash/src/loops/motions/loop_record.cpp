// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/loop_record.hpp"

namespace backlash {

RigMotion rig_motion(const std::vector<LoopRow>& rows) {
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
