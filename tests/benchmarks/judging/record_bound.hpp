// SPDX-License-Identifier: BSD-3-Clause
// What theory says can be decided on a record over time; prices as in evidence_bound.hpp.
#pragma once

#include "benchmarks/judging/evidence_bound.hpp"
#include "benchmarks/judging/step_response.hpp"
#include "benchmarks/judging/systems.hpp"

namespace judging {

/// Fractional truth: the rivals are sums of 1 to 8 exponentials, real or in pairs, with a direct term, an offset and,
/// where the truth has one, a dead time.  Integer truth: the rival is the truth with the order of one factor freed;
/// others are not tried, so that more is called decidable than may be.
Bound record_bound(const Kind& kind, const System& system, const Record& record);

}  // namespace judging
