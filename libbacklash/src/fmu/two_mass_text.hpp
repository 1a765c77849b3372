// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

// Text of two_mass_model.h.  CMake puts it in when it configures.
namespace backlash::detail::fmu_runtime {

extern const std::string_view two_mass_model;

}  // namespace backlash::detail::fmu_runtime
