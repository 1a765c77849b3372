// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fracfit {

/// The solver's own log on standard error is switched off: failures are reported with the results.
void silence_solver_log();

}  // namespace fracfit
