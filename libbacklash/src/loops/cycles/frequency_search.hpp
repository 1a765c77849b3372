// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "backlash/loops/limit_cycles.hpp"
#include "frac/power_term.hpp"

namespace backlash::detail {

/// The harmonics of the impulses that a search counts with: all odd ones, or the first.
enum class CountedHarmonics { all, first };

/// The terms of a controller that is a sum of powers of s; empty where it is a ratio.
[[nodiscard]] std::vector<frac::PowerTerm> controller_powers(const ControlLoop& loop);

/// Sum of powers with roots at the frequencies of the cycles, for a loop without dead time with the load measured:
///   sum c w^q sin(q pi/2) lambda(3 - q) - (pi/4) (M1 + M2) w^2 (1 - eps)/(1 + eps),   C = sum c s^q,
/// lambda(p) the sum over odd k of k^-p, or its first term.
[[nodiscard]] std::vector<frac::PowerTerm> frequency_equation(const ControlLoop& loop, CountedHarmonics harmonics);

/// Where roots are looked for on a grid: as asked for, else up to the frequency above which a controller that is a sum
/// of powers cannot make up for the loss in the impacts whatever its phase, and four decades down from there, more
/// where friction or springs of the bodies have their corners beyond; 1e-4 to 1e4 rad/s for a ratio.
[[nodiscard]] FrequencyRange search_range(const ControlLoop& loop, const std::optional<FrequencyRange>& asked);

/// 200 points per decade and per turn of the dead time.
/// @throws std::invalid_argument  more than a million of them.
[[nodiscard]] std::vector<double> search_grid(const FrequencyRange& range, double delay);

/// @throws std::invalid_argument  ends that are not positive, finite and rising.
void require_range(const std::optional<FrequencyRange>& range);

}  // namespace backlash::detail
