// SPDX-License-Identifier: BSD-3-Clause
#include "options/model_options.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "frac/no_ratio.hpp"

namespace fracfit {

frac::FractionalTransferFunction formula_of(std::string_view, const std::string& text) {
  try {
    return frac::FractionalTransferFunction::parse(text);
  } catch (const frac::NoRatio& reason) {
    throw std::invalid_argument(std::string(reason.what()) +
                                "; poles, stability and responses over time are computed for such ratios only; fit one "
                                "to the response on a band (fracfit evaluate, fracfit fit)");
  }
}

Option& add_model(Options& options, std::optional<frac::FractionalTransferFunction>& model, const std::string& help) {
  return options.parsed("--model", model, formula_of, help).or_argument();
}

frac::FrequencyBand band_of(std::string_view name, const std::string& text) {
  const auto [lower, upper] = pair_of(name, text);
  return {number_of(name, lower), number_of(name, upper)};
}

std::optional<frac::ApproximationGoal> GoalOptions::goal() const {
  if (tolerance) return frac::Tolerance{*tolerance};
  // Whether it is too many depends on the method, which the library knows.
  constexpr std::size_t most = std::numeric_limits<int>::max();
  if (poles) return frac::PoleCount{static_cast<int>(std::min(most, *poles))};
  return std::nullopt;
}

void add_goal(Options& options, GoalOptions& goal, const std::string& tolerance_help, const std::string& poles_help) {
  options.number("--tolerance", goal.tolerance, tolerance_help);
  options.count("--poles", goal.poles, 1, std::numeric_limits<std::size_t>::max(), poles_help);
}

}  // namespace fracfit
