// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "frac/approximation/approximate.hpp"
#include "frac/model/fractional_transfer_function.hpp"
#include "options/options.hpp"

namespace fracfit {

/// --model, a formula without open parameters; it may stand without the name of the option.
Option& add_model(Options& options, std::optional<frac::FractionalTransferFunction>& model,
                  const std::string& help = {});
[[nodiscard]] frac::FractionalTransferFunction formula_of(std::string_view name, const std::string& text);

/// LOW:HIGH of --band.
[[nodiscard]] frac::FrequencyBand band_of(std::string_view name, const std::string& text);

/// How good an approximation is to be: --tolerance or --poles, at most one of them.
struct GoalOptions {
  std::optional<double> tolerance;
  std::optional<std::size_t> poles;

  [[nodiscard]] std::optional<frac::ApproximationGoal> goal() const;
};
void add_goal(Options& options, GoalOptions& goal, const std::string& tolerance_help, const std::string& poles_help);

}  // namespace fracfit
