// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "unit_design.hpp"

namespace frac::detail {

/// Zeros and poles that make the largest of max(|R - 1|, |1/R - 1|), R = H(j omega)/(j omega)^order, least over the
/// band, among real ladders with zeros_i = 1/poles_i.  `hopeless_above` ends the work early as soon as it is clear that
/// the error will stay above it.
/// The result is as a rule within 2 per cent of the optimum; a pole more gains 20 per cent or more.
[[nodiscard]] UnitDesign ladder_design(const UnitProblem& problem, int poles, double hopeless_above);

}  // namespace frac::detail
