// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "frac/identification/lack_of_fit.hpp"

namespace frac::detail {

/// A fit fails where noise alone would leave such residuals with less than that chance.
inline constexpr double least_chance = 1e-3;

/// lack_of_fit() of residuals that are at hand.
/// @param residual  weighted, points in order, `per_point` of each
/// @param abscissa  of the points
/// @param parameters  fitted
/// @param told  whether the weighted residuals are in units of a known standard deviation
/// @param rounding  residuals below it are rounding
/// @param whitened  residuals freed of a correlation: what takes a smooth misfit beside white noise for correlated
/// noise
///     leaves neighbours that oppose each other, so that either sign of what is left tells
[[nodiscard]] LackOfFit residual_tests(std::span<const double> residual, std::size_t per_point,
                                       std::span<const double> abscissa, std::size_t parameters, bool told,
                                       double rounding, bool whitened = false);

/// The same for residuals over time, whose noise may be of first order, e_i = r e_(i-1) + white, r the most likely:
/// where they are not white, what is left of them without r times their neighbours has to be.
[[nodiscard]] LackOfFit first_order_tests(std::span<const double> residual, std::span<const double> time,
                                          std::size_t parameters, bool told, double rounding);

/// lack_of_fit() with the correlation of the noise as the options tell it, white where they tell none.
[[nodiscard]] LackOfFit tests_in_told_noise(const TimeResponseData& data, const TimeFitOptions& options,
                                            std::span<const double> residual, std::size_t parameters);

}  // namespace frac::detail
