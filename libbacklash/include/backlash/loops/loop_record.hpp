// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "backlash/loops/simulate_loop.hpp"
#include "backlash/rig_record.hpp"

namespace backlash {

/// Rows of a loop for each sample of a record: between rows a record takes cubics, which err by the fourth power of
/// their length.
constexpr int loop_rows_per_sample = 8;

/// The motion of a loop as a record samples it; the force runs straight between rows.
/// @param rows  of simulate_loop(), times not falling
[[nodiscard]] RigMotion rig_motion(const std::vector<LoopRow>& rows);

}  // namespace backlash
