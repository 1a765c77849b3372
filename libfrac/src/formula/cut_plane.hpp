// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "expression.hpp"

namespace frac::detail {

/// Whether a formula is known to have no singularity but on the negative real axis and at 0, as diffusion and
/// relaxation have none: tanh(sqrt(T s))/sqrt(T s), 1/(1 + (T s)^a)^b with a up to 1.  Its values are principal ones.
///
/// The proof follows the sector in which the arguments of each part lie for 0 <= arg s < pi: a sum of parts within less
/// than a half turn does not vanish, a power needs its base off the negative axis, tanh, coth and sech have their poles
/// where the argument is imaginary, and exp z is taken where Re z < 0 alone, since e^{-L s} grows beyond the imaginary
/// axis as e^{s t} decays.  Where cosh or sinh outgrows that, it does so along the positive axis too, which
/// leading_term() tells.
[[nodiscard]] bool is_analytic_in_cut_plane(const Expression& expression, std::span<const double> parameters);

}  // namespace frac::detail
