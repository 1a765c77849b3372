// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"

namespace frac {

enum class ModelClass { fractional, integer_order, fixed_curve };
[[nodiscard]] std::string_view to_string(ModelClass model_class);

/// A named structure: formula, the ranges of its parameters, and what it describes.
struct NamedModel {
  std::string name;
  std::string formula;
  ModelClass model_class;
  std::string description;
  std::vector<ParameterConstraint> constraints;
};

/// All presets: power-law, two-power-laws, fractional-lag (K/(T s^a + 1)), inertia-and-power-law, cole-cole,
/// havriliak-negami, ... and the integer-order counterparts they are compared with.
[[nodiscard]] const std::vector<NamedModel>& model_library();

/// The preset of that name, or the text taken as a formula (class by its orders, name = formula).
/// @throws FormulaError
[[nodiscard]] NamedModel find_model(std::string_view name_or_formula);

}  // namespace frac
