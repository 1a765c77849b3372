// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frac/identification/derived.hpp"
#include "frac/identification/fit.hpp"
#include "output/json.hpp"

namespace fracfit {

// What outputs of fits of every kind say alike of a parameter.

/// "lower .. upper".
[[nodiscard]] std::string interval(double lower, double upper);
/// Why an estimate has no interval worth the name; empty where it has one.
template <class Estimate>
[[nodiscard]] std::string parameter_state(const Estimate& estimate) {
  if (estimate.fixed) return "fixed";
  if (estimate.at_bound) return "at its bound";
  return estimate.identified ? "" : "not identified";
}
[[nodiscard]] Json parameter_json(const frac::ParameterEstimate& parameter);

/// @param curve  that the priors are of; empty where they are of no single one
void append_priors(Json& list, const std::vector<frac::PriorEstimate>& priors, const std::string& curve = {});
/// "a = 0.5 +- 0.1" or "R1 = 10 +- 5 %".
[[nodiscard]] std::string prior_text(const frac::PriorEstimate& prior);
/// A table, or nothing where there are none.
[[nodiscard]] std::string prior_table(const std::vector<frac::PriorEstimate>& priors);

[[nodiscard]] Json derived_json(const std::vector<frac::DerivedEstimate>& derived);
/// One line each, below the name of the table; empty where there are none.
[[nodiscard]] std::string derived_table(const std::vector<frac::DerivedEstimate>& derived);

}  // namespace fracfit
