// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "identification/rational/family_members.hpp"

namespace frac::detail {

/// The members of a family of ratios in s on a record over time, the chosen one by Schwarz's criterion and the price of
/// its places, with start values.  None has more zeros than poles: it would have no finite response to a step.
/// @throws std::invalid_argument  as resolved_model()
[[nodiscard]] FamilyMembers family_members(const TimeResponseData& data, const NamedModel& model,
                                           const TimeFitOptions& options);

/// The chosen member alone.
[[nodiscard]] FamilyMembers best_member(const TimeResponseData& data, const NamedModel& model,
                                        const TimeFitOptions& options);

}  // namespace frac::detail
