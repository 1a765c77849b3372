// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac {

enum class ModelClass { fractional, integer_order, fixed_curve };
[[nodiscard]] std::string_view to_string(ModelClass model_class);

/// Models b(s)/a(s) of whole order, with or without a factor exp(-L s).  How many poles are real and how many come in
/// complex pairs is found out from the data, and so is what is left open here.
struct RationalFamily {
  std::optional<std::size_t> zeros;  // degree of b; unset: what pays for itself
  std::size_t fewest_poles = 0;
  std::size_t most_poles = 12;
  bool dead_time = false;
};

/// A named structure: formula, the ranges of its parameters, and what it describes.
struct NamedModel {
  std::string name;
  std::string formula;  // no formula but the name of the family where `rational` is set, see resolved_model()
  ModelClass model_class;
  std::string description;
  std::vector<ParameterConstraint> constraints;
  std::optional<RationalFamily> rational = std::nullopt;
};

/// All presets: power-law, two-power-laws, fractional-lag (K/(T s^a + 1)), inertia-and-power-law, cole-cole,
/// havriliak-negami, ... and the integer-order counterparts they are compared with.
[[nodiscard]] const std::vector<NamedModel>& model_library();

/// What `identify` compares unless told otherwise: all presets, and rational models of up to 12 poles with and without
/// dead time.
[[nodiscard]] std::vector<NamedModel> default_candidates();

/// The preset of that name, a rational family, or the text taken as a formula (class by its orders, name = formula).
/// Rational families are written "rational" (0 to 12 poles), "rational:4" (poles), "rational:3/4" (zeros/poles) or
/// "rational:1..8" (poles), each with "+delay" behind it for a dead time.
/// @throws FormulaError
/// @throws std::invalid_argument  a rational family with more than 12 poles, more than one zero more than poles, or an
///     empty range.
[[nodiscard]] NamedModel find_model(std::string_view name_or_formula);

/// The model with the formula that suits the data: for a rational family the best member, by BIC where the order is
/// open, in factored form with start values, to be fitted with FitOptions::global_start = false.  Real poles are p1,
/// p2, ... (rad/s, s/p1 + 1), complex pairs w1, d1, ... (s^2/w1^2 + d1 s/w1 + 1), coefficients of the numerator b0, b1,
/// ..., the dead time L.  Where the imaginary part alone is fitted, a constant beside the fraction is h0.  Any other
/// model is returned as it is.
/// @throws std::invalid_argument  fewer residuals than parameters, or a component other than both, imaginary and real.
[[nodiscard]] NamedModel resolved_model(const FrequencyResponseData& data, const NamedModel& model,
                                        const FitOptions& options);
/// Over time. @throws std::invalid_argument  a rational family, which is grown on frequency responses only.
[[nodiscard]] NamedModel resolved_model(const TimeResponseData& data, const NamedModel& model,
                                        const TimeFitOptions& options);

}  // namespace frac
