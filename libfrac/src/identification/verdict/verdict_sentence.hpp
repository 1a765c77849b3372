// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "identification/verdict/ruling.hpp"

namespace frac::detail {

/// Of frequency or time.
struct AxisUnit {
  std::string_view name;
  double factor;  // from rad/s or s

  [[nodiscard]] std::string text(double at) const;
};

/// "the rival 'zener' could not be fitted"
[[nodiscard]] std::string unfitted(const std::vector<std::string>& rivals);

/// Name, number of parameters, and rms as a share of the data.
[[nodiscard]] std::string described(const RankedFit& ranked);

/// The sentence of a verdict that compares two finalists, and what is to be known beside it, a sentence each.
/// @param unit  of the axis of the data
[[nodiscard]] std::string verdict_sentence(const IdentificationResult& result, const Comparison& pair,
                                           const Ruling& ruling);
[[nodiscard]] std::vector<std::string> verdict_notes(const IdentificationResult& result, const Comparison& pair,
                                                     const Ruling& ruling, const AxisUnit& unit);

/// The same where no candidate follows the data.
[[nodiscard]] std::string sentence_without_model(const RankedFit& best);
[[nodiscard]] std::string note_without_model(const RankedFit& best, const AxisUnit& unit);

/// What to measure next.
/// @param noise     of the data at hand, as next.accuracy
/// @param relative  whether both are shares of the response
[[nodiscard]] std::string advice(const NextMeasurement& next, double noise, const AxisUnit& unit);

}  // namespace frac::detail
