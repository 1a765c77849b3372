// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/identification/identify.hpp"

namespace frac::detail {

/// Compares the candidates of a ranking with the same ones beside a drift of the output, or beside an input before the
/// record, where the options leave these out.
///
/// A sentence is added to the verdict where one of these has the greater evidence: what was ranked may follow a drift,
/// by a slow pole or by the tail of a fractional order, and then no residual shows it.  A verdict that does not hold
/// against them is withdrawn: see IdentificationResult.
///
/// After one step of the input at the first sample a steady drift is the response of an integrator, and the free motion
/// of n poles another numerator: columns that are the same, so that only the simpler description speaks for a drift.
/// @param models  the candidates, families not grown
void weigh_background(IdentificationResult& result, const TimeResponseData& data, const std::vector<NamedModel>& models,
                      const TimeFitOptions& options);

}  // namespace frac::detail
