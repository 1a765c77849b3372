// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

// Text of the C files in runtime/, which stand in every unit as they are.  CMake puts it in when it configures.
namespace frac::detail::fmu_runtime {

extern const std::string_view fmi2;
extern const std::string_view fmi3;
extern const std::string_view fmu;
extern const std::string_view sampled_model;
extern const std::string_view pid_model;
extern const std::string_view filter_model;
extern const std::string_view state_space_model;

}  // namespace frac::detail::fmu_runtime
