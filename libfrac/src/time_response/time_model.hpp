// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <variant>

#include "cut_plane_model.hpp"
#include "event_response.hpp"
#include "formula/reduction.hpp"
#include "frac/structure.hpp"

namespace frac::detail {

/// A formula at parameter values, as responses over time take it: a ratio of sums of powers with a dead time, or
/// another one without singularities off the negative real axis.
using TimeModel = std::variant<RatioOfPowerSums, CutPlaneModel>;

/// @throws NoRatio  it is neither; the text says why it is no ratio
[[nodiscard]] TimeModel time_model(const Structure& structure, std::span<const double> parameters,
                                   Sensitivity sensitivity = Sensitivity::none);
/// The same; empty where it is neither.
[[nodiscard]] std::optional<TimeModel> time_model_if_any(const Structure& structure, std::span<const double> parameters,
                                                         Sensitivity sensitivity = Sensitivity::all);

/// As EventResponse::evaluate().
[[nodiscard]] bool respond_to(const TimeModel& model, const EventResponse& input, double tolerance,
                              EventResponse::Result& result);

/// s
[[nodiscard]] double dead_time(const TimeModel& model);

}  // namespace frac::detail
