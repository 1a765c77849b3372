// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "identification/verdict/ruling.hpp"

namespace frac::detail {

/// "the rival 'zener' could not be fitted"
[[nodiscard]] std::string unfitted(const std::vector<std::string>& rivals);

/// The sentence of a verdict that compares two finalists.
/// @param unit  of the axis of the data
[[nodiscard]] std::string verdict_sentence(const IdentificationResult& result, const Comparison& pair,
                                           const Ruling& ruling, const char* unit);

/// The sentence where no candidate follows the data.
[[nodiscard]] std::string sentence_without_model(const RankedFit& best, const char* unit);

/// What to measure next.
/// @param noise     of the data at hand, as next.accuracy
/// @param relative  whether both are shares of the response
[[nodiscard]] std::string advice(const NextMeasurement& next, double noise, bool relative);

}  // namespace frac::detail
