// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "identification/data/fit_data.hpp"
#include "identification/statistics/curvature_fit.hpp"
#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Points [first, last) that are left out together.
using Block = std::pair<std::size_t, std::size_t>;

/// Blocks of neighbouring points, each point in one.
[[nodiscard]] std::vector<Block> even_blocks(std::size_t points, std::size_t count);
/// Such blocks of half a decade, but five to ten of them.
[[nodiscard]] std::vector<Block> half_decades(const FrequencyResponseData& data);
/// The points within half a decade of either end; none where that takes more than a third of them.
[[nodiscard]] std::vector<Block> end_blocks(const FrequencyResponseData& data);

/// The options of a fit that starts where the competitor's ended, with what ended at a limit held there; empty where an
/// estimate is not finite.
template <class Options>
[[nodiscard]] std::optional<Options> refit_options(Options options, const Competitor& competitor) {
  options.constraints = competitor.ranked.model.constraints;
  for (const ParameterEstimate& estimate : competitor.ranked.fit.parameters) {
    if (!std::isfinite(estimate.value)) return std::nullopt;
    if (estimate.at_bound) hold(options, estimate.name, estimate.value);
  }
  return started_at(std::move(options), competitor.ranked.fit);
}

/// rms of the weighted residuals with which fits to the rest predict each block, started from the fit to all; infinity
/// where one of them fails, NaN without a block.
template <class Data>
[[nodiscard]] double prediction_rms(const Data& data, const OptionsOf<Data>& options, const Competitor& competitor,
                                    const std::vector<Block>& blocks) {
  if (blocks.empty()) return std::numeric_limits<double>::quiet_NaN();
  constexpr double failed = std::numeric_limits<double>::infinity();
  const std::size_t per_point = residuals_per_point(data, options);
  double square = 0, count = 0;
  const auto add = [&](const std::vector<double>& residual, const Block& block) {
    for (std::size_t i = block.first * per_point; i < block.second * per_point; ++i)
      square += residual[i] * residual[i];
    count += static_cast<double>((block.second - block.first) * per_point);
  };
  if (competitor.ranked.model_class == ModelClass::fixed_curve) {
    for (const Block& block : blocks) add(competitor.residual, block);
    return std::sqrt(square / count);
  }
  const Structure structure(competitor.ranked.fit.model);
  const auto started = refit_options(options, competitor);
  if (!started) return failed;
  for (const Block& block : blocks) {
    try {
      const FitResult fit = refit(part_of(data, block.first, block.second, false), structure, *started);
      if (fit.termination == FitTermination::no_usable_start) return failed;
      add(weighted_residuals(data, options, fit), block);
    } catch (const std::invalid_argument&) {
      return failed;
    }
  }
  return std::isfinite(square) ? std::sqrt(square / count) : failed;
}

}  // namespace frac::detail
