// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "identification/residuals/loss.hpp"
#include "local_solve.hpp"

namespace frac::detail {

/// Sum of the loss over points of `per_point` residuals each, the sum of squares without a loss: what local_solve()
/// makes least.
[[nodiscard]] double loss_cost(std::span<const double> residual, std::size_t per_point, const LocalOptions& options);

/// Loss scale over the standard deviation of normal residuals that keeps 95 % of the efficiency (Huber 1981; Holland,
/// Welsch 1977).
[[nodiscard]] double tuning_constant(Loss loss);

/// 1.4826 times the median absolute residual: the standard deviation of the well-behaved part (normal residuals).
[[nodiscard]] double robust_spread(std::span<const double> residual);

/// Points with a residual beyond five robust standard deviations: one in two million of normal residuals.
/// @param residual  in units of the data: what is below 1e-13 is rounding
[[nodiscard]] std::vector<std::size_t> outliers(std::span<const double> residual, std::size_t per_point);

/// Refines a least-squares solution under a robust loss.
/// @param scale  of the loss; unset: it follows the residuals until it settles
/// @return the loss with its scale, which `residuals` is left with
[[nodiscard]] LocalOptions robust_refinement(Residuals& residuals, Loss loss, std::optional<double> scale,
                                             LocalSolution& solution);
/// Searches under a robust loss: from a least-squares solution, which outliers may have led far off, and from seeded
/// places about the best found so far, until several of them come back to it.
/// Two solutions have scales of their own: the better one has the smaller spread of the well-behaved residuals.
[[nodiscard]] LocalOptions robust_search(Residuals& residuals, Loss loss, std::optional<double> scale,
                                         std::uint64_t seed, LocalSolution& solution);

[[nodiscard]] std::vector<double> residuals_at(const Residuals& residuals, std::span<const double> theta);

}  // namespace frac::detail
