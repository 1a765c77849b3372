// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "identification/verdict.hpp"

namespace frac::detail {

/// Points [first, last) that are left out together.
using Block = std::pair<std::size_t, std::size_t>;

/// `count` blocks of neighbouring points, all of them in one.
[[nodiscard]] std::vector<Block> even_blocks(std::size_t points, std::size_t count);
/// The points within half a decade of either end; none where that takes more than a third of them, and over time.
[[nodiscard]] std::vector<Block> end_blocks(const FrequencyResponseData& data);
[[nodiscard]] inline std::vector<Block> end_blocks(const TimeResponseData&) {
  return {};
}

/// rms of the weighted residuals with which fits to the rest predict each block, started from the fit to all; infinity
/// where one of them fails, NaN without a block.
[[nodiscard]] double prediction_rms(const FrequencyResponseData& data, const FitOptions& options,
                                    const Competitor& competitor, const std::vector<Block>& blocks);
[[nodiscard]] double prediction_rms(const TimeResponseData& data, const TimeFitOptions& options,
                                    const Competitor& competitor, const std::vector<Block>& blocks);

}  // namespace frac::detail
