// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace frac::detail {

// Distributions of Boost behind functions that are no templates: compiled in one file, where each user would spend two
// to six seconds on them.  Degrees of freedom and shapes are above 0; they need not be whole.

/// Chance that a variable of the distribution is larger than a value.
[[nodiscard]] double normal_above(double value);
[[nodiscard]] double student_t_above(double value, double degrees);
[[nodiscard]] double chi_squared_above(double value, double degrees);
/// @param degrees, degrees_below  of the numerator and of the denominator
[[nodiscard]] double fisher_f_above(double value, double degrees, double degrees_below);
[[nodiscard]] double gamma_above(double value, double shape);
/// The rest of gamma_above, without cancellation where it is small.
[[nodiscard]] double gamma_below(double value, double shape);

/// Value that a variable of the distribution stays below with this chance.
[[nodiscard]] double student_t_quantile(double chance, double degrees);
[[nodiscard]] double chi_squared_quantile(double chance, double degrees);
[[nodiscard]] double fisher_f_quantile(double chance, double degrees, double degrees_below);

}  // namespace frac::detail
