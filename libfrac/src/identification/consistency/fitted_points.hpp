// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "consistent_model.hpp"
#include "frac/model/frequency_response_data.hpp"

namespace frac::detail {

/// Points by index into the data, and a model of them.
struct Fitted {
  std::vector<std::size_t> kept;
  WeightedPoints points;
  ConsistentModel model;
  double floor = 0, slope = 0;
};

[[nodiscard]] WeightedPoints points_of(const FrequencyResponseData& data, const std::vector<std::size_t>& kept);

/// AICc with the part of the likelihood that depends on the weights.
[[nodiscard]] double likelihood_criterion(const Fitted& fitted);

/// Share of the model.
[[nodiscard]] double relative_residual(const Fitted& fitted, Eigen::Index i);
[[nodiscard]] double rms_of_residuals(const Fitted& fitted);

/// Squares that the poles of the model leave of the complex conjugates of the points, over those of the points.
[[nodiscard]] double left_of_mirrored(const Fitted& fitted);

/// The best model with poles on a grid, weighted by its own residuals.
[[nodiscard]] Fitted fit_on_grid(const FrequencyResponseData& data, std::vector<std::size_t> kept);

[[nodiscard]] Fitted fit_free_poles(const FrequencyResponseData& data, std::vector<std::size_t> kept,
                                    std::span<const std::size_t> pair_counts);

/// Free poles for points whose weights come from the residuals of another model.
[[nodiscard]] Fitted with_free_poles(const FrequencyResponseData& data, Fitted fitted,
                                     std::span<const std::size_t> pair_counts);

/// Fits a model anew to some of its points, starting from its poles.
[[nodiscard]] Fitted refitted_points(const FrequencyResponseData& data, std::vector<std::size_t> kept,
                                     const ConsistentModel& model);

/// The kept points but for those at these positions among them.
[[nodiscard]] std::vector<std::size_t> without(const std::vector<std::size_t>& kept,
                                               const std::vector<Eigen::Index>& removed);

}  // namespace frac::detail
