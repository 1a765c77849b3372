// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <numbers>
#include <vector>

#include "identification/rational/family_members.hpp"
#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// What is fractional of a formula shows where it changes a value by that share: as s^least_departure does, which turns
/// the phase by so much and leaves the magnitude at s = j.
inline const double least_visible = least_departure * std::numbers::pi / 2;

/// Whether a formula is another one at its optimum, richer one first.
using Containing = std::function<bool(const FitResult&, const FitResult&)>;

/// Tells fractional candidates how far they are from being of integer order: the least root of the sum of squares,
/// relative to the data, by which their weighted residuals differ from those of an integer-order candidate that they
/// contain, as a diffusion behind a lag contains the lag, and that is the better one by Schwarz's criterion; infinite
/// where that is not below least_visible, and for members of families, of which FamilyMembers tells how far they are
/// from departing.  It is found when it is asked for first, and among these competitors, which have to stay where they
/// are.
void find_integer_limits(std::vector<Competitor>& competitors, const Containing& contains);

}  // namespace frac::detail
