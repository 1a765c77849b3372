// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

namespace report {

/// Median of three repeats of the processor time of one call in the calling thread, s.  Other work on the machine
/// changes it little.  Short calls are repeated within a repeat until the clock resolves them.
[[nodiscard]] double median_seconds(const std::function<void()>& call);

}  // namespace report
