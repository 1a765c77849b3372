// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "frac/identification/model_library.hpp"
#include "term_growth.hpp"

namespace frac::detail {

/// Sums of passive elements, each with a positive gain, simplest first, grown until neither of the last two sizes paid
/// by element_value().
using ElementLadder = GrowthLadder<TermFit>;

/// The response that passive elements in series make: an impedance, a modulus or a compliance, whose real part is
/// nowhere negative, or the displacement of a structure per force where it acts, whose imaginary part is nowhere
/// positive.
enum class PassiveResponse { immittance, receptance };

/// The one that the signs of the data leave less of; what they leave is a lower bound of the cost of any such sum.
struct PassiveKind {
  PassiveResponse response;
  double least_cost;  // in the unit of the rule
};
[[nodiscard]] PassiveKind passive_kind(const ProjectedData& data);

/// term_value() with the choice of kinds paid for.  Of m kinds and their places k elements are drawn in k! orders,
/// which make one sum: 2 ln m for each element, less 2 ln k!.
[[nodiscard]] double element_value(const TermProblem& problem, PassiveResponse response, const TermFit& fit);

[[nodiscard]] ElementLadder grow_elements(const TermProblem& problem, std::size_t most_elements);

/// The least cost of any sum of resistors, inductors, capacitors, relaxations and diffusion, whatever their number,
/// orders and places; of an immittance.  Each of them is a mixture, with weights that are nowhere negative, of
/// resistors beside a capacitor and resistors beside an inductor at all times (Cole, Cole 1941; Fuoss, Kirkwood 1941),
/// and so is every network of resistors with capacitors alone or inductors alone.  Modes are none.
[[nodiscard]] double least_cost_of_relaxations(const TermProblem& problem);
/// To what share of the data its times, an eighth of an e-fold apart, follow any between them.
inline constexpr double relaxations_follow = 5e-4;

/// The sum as a formula with start values, each gain positive.  Its name holds the circuit:
/// "elements:L0+R0+(R1|CPE1)+Wo2", see ElementFamily.
[[nodiscard]] NamedModel elements_written_out(const TermProblem& problem, const TermSum& sum);

}  // namespace frac::detail
