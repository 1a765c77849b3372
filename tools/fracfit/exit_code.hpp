// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fracfit {

enum ExitCode : int { usable_result = 0, no_usable_result = 1, wrong_usage = 2, invalid_data = 3 };

}  // namespace fracfit
