// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

// Text of the C files in runtime/, of which exported headers are made.  CMake puts it in when it configures.
namespace frac::detail::runtime {

extern const std::string_view guard_open;
extern const std::string_view guard_close;
extern const std::string_view section_filter;
extern const std::string_view section_vector;
extern const std::string_view pid_state;
extern const std::string_view pid;
extern const std::string_view filter_state;
extern const std::string_view filter;
extern const std::string_view q31_filter_state;
extern const std::string_view q31_section;
extern const std::string_view q31_filter;
extern const std::string_view q31_pid_state;
extern const std::string_view q31_pid;
extern const std::string_view arduino_pid;
extern const std::string_view arduino_filter;

}  // namespace frac::detail::runtime
