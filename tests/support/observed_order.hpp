// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace support {

/// Order p of a method whose error is C step^p, from the errors at a step and at half of it.
inline double observed_order(double error_at_step, double error_at_half_step) {
  return std::log2(error_at_step / error_at_half_step);
}

}  // namespace support
