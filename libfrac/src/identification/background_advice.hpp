// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/identify.hpp"

namespace frac::detail {

/// Says it in the verdict's sentence and as advice where a preset with a drift of the output, or with an input before
/// the record, describes the record better than the ratio that was chosen without: poles of a ratio can follow a drift,
/// which then stands in no residual.  Nothing where none does, or where a preset was chosen, whose own residuals would
/// show it.
void add_background_advice(const TimeResponseData& data, const TimeFitOptions& options, IdentificationResult& result);

}  // namespace frac::detail
