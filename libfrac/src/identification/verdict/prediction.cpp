// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "identification/data/fit_data.hpp"
#include "identification/statistics/curvature_fit.hpp"

namespace frac::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The options of a fit that starts where the competitor's ended, with what ended at a limit held there; empty where an
/// estimate is not finite.
template <class Options>
std::optional<Options> refit_options(Options options, const Competitor& competitor) {
  options.constraints = competitor.ranked.model.constraints;
  for (const ParameterEstimate& estimate : competitor.ranked.fit.parameters) {
    if (!std::isfinite(estimate.value)) return std::nullopt;
    if (estimate.at_bound) hold(options, estimate.name, estimate.value);
  }
  return started_at(std::move(options), competitor.ranked.fit);
}

std::vector<Block> even_blocks(std::size_t points, std::size_t count) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < count; ++i) blocks.emplace_back(i * points / count, (i + 1) * points / count);
  return blocks;
}

}  // namespace

std::vector<Block> blocks_of(const FrequencyResponseData& data) {
  // Over a longer gap structures of many parameters say nothing.
  const double half_decades = 2 * std::log10(data.omega().back() / data.omega().front());
  return even_blocks(data.size(), static_cast<std::size_t>(std::clamp(std::round(half_decades), 5.0, 10.0)));
}

std::vector<Block> blocks_of(const TimeResponseData& data) {
  return even_blocks(points(data), 5);
}

std::vector<Block> end_blocks(const FrequencyResponseData& data) {
  const double half_decade = std::sqrt(10.0);
  const std::vector<double>& omega = data.omega();
  const auto below = std::upper_bound(omega.begin(), omega.end(), omega.front() * half_decade);
  const auto above = std::lower_bound(omega.begin(), omega.end(), omega.back() / half_decade);
  const auto lower = static_cast<std::size_t>(below - omega.begin());
  const auto upper = static_cast<std::size_t>(omega.end() - above);
  if (3 * (lower + upper) > 2 * omega.size()) return {};
  return {{0, lower}, {omega.size() - upper, omega.size()}};
}

template <class Data>
double prediction_rms(const Data& data, const OptionsOf<Data>& options, const Competitor& competitor,
                      const std::vector<Block>& blocks) {
  if (blocks.empty()) return std::numeric_limits<double>::quiet_NaN();
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
  if (!started) return infinity;
  for (const Block& block : blocks) {
    try {
      const FitResult fit = refit(part_of(data, block.first, block.second, false), structure, *started);
      if (fit.termination == FitTermination::no_usable_start) return infinity;
      add(weighted_residuals(data, options, fit), block);
    } catch (const std::invalid_argument&) {
      return infinity;
    }
  }
  return std::isfinite(square) ? std::sqrt(square / count) : infinity;
}

template double prediction_rms(const FrequencyResponseData&, const FitOptions&, const Competitor&,
                               const std::vector<Block>&);
template double prediction_rms(const TimeResponseData&, const TimeFitOptions&, const Competitor&,
                               const std::vector<Block>&);

}  // namespace frac::detail
