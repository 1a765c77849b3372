// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "frac/approximation/approximate.hpp"
#include "frac/digital/discretise.hpp"

namespace fracfit {

/// Whether a tolerance was given that the continuous system or the recursion does not keep.
[[nodiscard]] bool missed(const frac::Approximation& result, const frac::DigitalPower* digital);

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
