// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "frac/identification/fit.hpp"

namespace frac::detail {

/// Whether a model has a pole right of the imaginary axis; empty where that cannot be told, as of a formula that is no
/// ratio of sums of powers.
[[nodiscard]] std::optional<bool> is_unstable(const Structure& structure, std::span<const double> parameters);
[[nodiscard]] std::optional<bool> is_unstable(const FitResult& fit);

/// Whether a formula has a dead time among its parameters.
[[nodiscard]] bool has_dead_time(const Structure& structure);

/// By which exp(-L s) turns by half a turn between the two points nearest each other, s: a longer dead time looks like
/// a shorter one, or like an advance, on evenly spaced points.
[[nodiscard]] double longest_dead_time(const FrequencyResponseData& data);

/// The place where the real part of a fitted response is most negative.
struct ActivePlace {
  double omega;  // rad/s
  double share;  // of |G| there, above 0
};
/// Over the band and three decades beyond either end of it; empty where the real part is nowhere negative, as that of a
/// passive immittance.
[[nodiscard]] std::optional<ActivePlace> active_place(const FitResult& fit, const FrequencyResponseData& data);

/// "is that of no passive immittance: ..." or what was checked; begins with a blank.
[[nodiscard]] std::string remark_on_passivity(const FitResult& fit, const FrequencyResponseData& data);

}  // namespace frac::detail
