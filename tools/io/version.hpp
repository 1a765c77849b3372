// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace io {

/// Version of the program, e.g. "0.1.0".
[[nodiscard]] std::string_view version();

}  // namespace io
