#pragma once

#include <string>

#include "frac/approximate.hpp"

namespace fracfit {

[[nodiscard]] std::string approximation_json(const frac::Approximation& result, const std::string& command);
/// Command, method and errors as "# key: value" lines, then one row per zero and pole, residues with the poles.
[[nodiscard]] std::string approximation_csv(const frac::Approximation& result, const std::string& command);
/// For people.
[[nodiscard]] std::string approximation_table(const frac::Approximation& result);

}  // namespace fracfit
