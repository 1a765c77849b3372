// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "backlash/compliant/compliant_history.hpp"
#include "compliant_run.hpp"

namespace backlash::detail {

/// What a row says of an event of the run; empty of those that nobody sees.
[[nodiscard]] std::optional<CompliantEvent> shown(CompliantRun::Event event, int subject);
[[nodiscard]] CompliantRow row_of(const CompliantRun& run, double time, CompliantEvent event);

}  // namespace backlash::detail
