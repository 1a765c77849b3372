// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/loops/simulate_loop.hpp"
#include "backlash/rig_record.hpp"

namespace backlash {

/// Rows of a simulated loop per sample of a record of it: between rows a record takes cubics, which err by the fourth
/// power of their length.
constexpr int rows_per_sample = 8;

/// The motion of a loop as a rig records it; the force runs straight between rows.
[[nodiscard]] RigMotion rig_motion(const LoopHistory& history);

}  // namespace backlash
