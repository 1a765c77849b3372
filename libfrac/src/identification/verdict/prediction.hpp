// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "identification/data/fit_data.hpp"
#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Points [first, last) that are left out together.
using Block = std::pair<std::size_t, std::size_t>;

/// Blocks of neighbouring points, each point in one: of half a decade, but five to ten of them; five over time.
[[nodiscard]] std::vector<Block> blocks_of(const FrequencyResponseData& data);
[[nodiscard]] std::vector<Block> blocks_of(const TimeResponseData& data);
/// The points within half a decade of either end; none where that takes more than a third of them.
[[nodiscard]] std::vector<Block> end_blocks(const FrequencyResponseData& data);

/// rms of the weighted residuals with which fits to the rest predict each block, started from the fit to all; infinity
/// where one of them fails, NaN without a block.
template <class Data>
[[nodiscard]] double prediction_rms(const Data& data, const OptionsOf<Data>& options, const Competitor& competitor,
                                    const std::vector<Block>& blocks);

}  // namespace frac::detail
