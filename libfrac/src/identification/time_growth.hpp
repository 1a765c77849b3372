// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "identification/rational/family_members.hpp"

namespace frac::detail {

/// The member of a family of ratios in s that suits a record over time, by Schwarz's criterion and the price of its
/// places, with start values.  It has no more zeros than poles: any other has no finite response to a step.
/// @throws std::invalid_argument  a family of another kind, or too few samples for its smallest member
[[nodiscard]] FamilyMembers best_member(const TimeResponseData& data, const NamedModel& family,
                                        const TimeFitOptions& options);

}  // namespace frac::detail
