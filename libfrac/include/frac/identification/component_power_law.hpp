// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "frac/identification/fit.hpp"
#include "frac/identification/model_library.hpp"
#include "frac/model/frequency_response_data.hpp"

namespace frac {

/// A power law of one component, Re G = K omega^b, Im G = K omega^b or |G| = K omega^b, which says nothing of the
/// other. It is no transfer function with real coefficients: K s^b has the imaginary part K sin(b pi/2) omega^b, none
/// at all at b = 2, and the real part K cos(b pi/2) omega^b.  With sqrt(-s^2), which is omega on the imaginary axis, it
/// is a formula of s all the same: K sqrt(-s^2)^b, with a factor s/sqrt(-s^2) = j for the imaginary part.  Fitted to
/// component_alone(), residuals, weights and intervals are those of any other formula, and relative means relative to
/// the component.  See fit_power_law() for the least squares of ln y on ln omega.
constexpr std::string_view component_power_law_name = "component-power-law";

/// @throws std::invalid_argument  component both or phase.
[[nodiscard]] NamedModel component_power_law(Component component);

/// What it says, for people: "Im = K omega^b, ...".
[[nodiscard]] std::string component_power_law_sentence(Component component);

/// The data with the other component taken away: the imaginary part times j, the real part, or the data themselves for
/// magnitude.
/// @throws std::invalid_argument  component both or phase.
[[nodiscard]] FrequencyResponseData component_alone(const FrequencyResponseData& data, Component component);

}  // namespace frac
