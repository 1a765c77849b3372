// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "projected_residual.hpp"

namespace frac::detail {

/// Points of a response with the standard deviation of each part.
struct WeightedPoints {
  std::vector<double> omega;  // rising, rad/s
  Eigen::VectorXcd value;
  Eigen::VectorXd deviation;
};

/// A response of a linear, causal, stable system, fitted to points.
struct ConsistentModel {
  ProjectedResidual projected;  // weighted
  Eigen::VectorXcd value;
  std::size_t grid_poles = 0;
  double margin = 0;  // of the grid beyond the band on either side, as ratio of frequencies on the logarithm
  std::vector<std::complex<double>> free_poles;  // real, or the upper one of a pair; in units of the middle of the band
  std::size_t narrow_pairs = 0;                  // of free_poles, narrower than half the distance of the points there
  double criterion = 0;                          // AICc, of the same points and weights
};

/// The price of a narrow pair beside its four parameters.  It may follow a single point, the one with the largest
/// residual; this is the price of having chosen that point.
inline constexpr std::size_t price_of_narrow_pair = 3;

/// Least squares that the candidates of best_on_grid() leave of points under these weights, or bounds below them.
struct GridCosts {
  Eigen::VectorXd weight;
  std::vector<double> cost;
};

/// c_0 + c_1 s + c_2/s + sum r_k/(1 + s tau_k), the tau_k evenly on the logarithm; the best of many counts and reaches.
/// @param costs  empty, or those of the same points under other weights: they tell which candidates cannot be the best.
///               Afterwards those under these weights.
[[nodiscard]] ConsistentModel best_on_grid(const WeightedPoints& points, GridCosts& costs);

/// The model with this number of poles and this margin.
[[nodiscard]] ConsistentModel on_grid(const WeightedPoints& points, std::size_t poles, double margin);

/// The best model with poles at free places in the left half plane, real or in pairs, found by vector fitting
/// (Gustavsen, Semlyen 1999) and brought to least squares by Gauss-Newton steps.  A pair is at least a tenth as wide as
/// the points are apart there, since these cannot tell narrower ones apart.
/// @param pair_counts  rising; those that half the values afford are tried, the best is returned
[[nodiscard]] ConsistentModel best_with_free_poles(const WeightedPoints& points,
                                                   std::span<const std::size_t> pair_counts);

/// A model with free poles fitted anew, starting from its poles, to other weights or to fewer points of the same band.
[[nodiscard]] ConsistentModel refitted(const WeightedPoints& points, const ConsistentModel& model);

}  // namespace frac::detail
