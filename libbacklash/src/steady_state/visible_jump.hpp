// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/jump_frequency.hpp"

namespace backlash::detail {

/// c at which the motion carried from frequency to frequency becomes (sweep_up) or ceases to be (sweep_down) one of two
/// impacts per period; the message tells the step of Im N there.
[[nodiscard]] JumpFrequency visible_jump(double restitution, Protocol protocol);

}  // namespace backlash::detail
