// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "frac/digital/c_header.hpp"

namespace frac::detail {

/// As c_header(), but gains, set-point weights and limits are members of the state (kp, ki, kd, setpoint_weight,
/// derivative_setpoint_weight, minimum, maximum), to be set before init and, if need be, between steps.  Compilers that
/// are told of registers for eight numbers find vectors in it.
[[nodiscard]] std::string tuned_c_header(const FractionalPidDesign& design, const CHeaderOptions& options);

/// As c_header(), with these vectors.
[[nodiscard]] std::string vector_c_header(const DigitalFilterDesign& design, const CHeaderOptions& options);

}  // namespace frac::detail
