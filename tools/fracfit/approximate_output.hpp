#pragma once

#include <string>

#include "frac/approximate.hpp"
#include "frac/discretise.hpp"

namespace fracfit {

// `digital` is nullptr where no sample time was given.
[[nodiscard]] std::string approximation_json(const frac::Approximation& result, const frac::DigitalPower* digital,
                                             const std::string& command);
/// Command, method and errors as "# key: value" lines, then one row per zero and pole, residues with the poles; the
/// digital part as lines too.
[[nodiscard]] std::string approximation_csv(const frac::Approximation& result, const frac::DigitalPower* digital,
                                            const std::string& command);
/// For people.
[[nodiscard]] std::string approximation_table(const frac::Approximation& result, const frac::DigitalPower* digital);

}  // namespace fracfit
