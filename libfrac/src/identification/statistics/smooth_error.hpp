// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "identification/residuals/residual_axis.hpp"

namespace frac::detail {

/// Residuals that are the sum of white noise and of a smooth error, as calibration, cables, drift, or what a model
/// lacks leave it: a Gaussian process of covariance (1 + q) e^-q, q = sqrt(3) distance/length (Matern of order 3/2),
/// the same and independent for the residuals of a point.  `share` is its part of the variance of a residual.
///
/// More than 256 points are taken together in as many blocks of neighbours, over each of which the smooth error is
/// constant.  Within the blocks there is white noise alone.
class SmoothError {
 public:
  /// Shares that are filtered at once: as many as the widest registers hold.
  static constexpr std::size_t side_by_side = 8;

  /// @param residual  as left by least squares
  /// @param basis     orthonormal, of the columns that were fitted
  SmoothError(std::span<const double> residual, const Eigen::Ref<const Eigen::MatrixXd>& basis,
              const ResidualAxis& axis);

  /// The shortest length that points can tell from white noise, and the longest that a trend over all of them has.
  [[nodiscard]] double shortest() const { return 2 * spacing_; }
  [[nodiscard]] double longest() const;

  struct Likelihood {
    double logarithm;  // restricted: with the fitted columns integrated out, of the residuals as they came
    double variance;   // of a residual, where that is most likely
  };
  /// At several shares, which are cheaper together.
  [[nodiscard]] std::vector<Likelihood> at(std::span<const double> shares, double length) const;

  /// Sums over the blocks of what residuals are multiplied by, in columns, and the products of these columns: all that
  /// covariances need.
  struct Influences {
    Eigen::MatrixXd sums;  // a row for each residual of a block
    Eigen::MatrixXd products;
  };
  [[nodiscard]] Influences influences(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;
  /// A residual of that variance.
  struct Possibility {
    double variance, share, length;
  };
  /// Covariance of columns' * residuals, summed over what is possible.
  [[nodiscard]] Eigen::MatrixXd covariance(const Influences& of, std::span<const Possibility> possibilities) const;

 private:
  using Shares = std::array<double, side_by_side>;
  /// Takes the rows of some points, from the first of these, times the factors of the points.
  void turn(std::size_t first, Eigen::Ref<Eigen::MatrixXd> rows) const;
  /// Sums of turned rows over blocks, the first of which begins with them: a row for each residual of a point.
  [[nodiscard]] Eigen::MatrixXd block_sums(const Eigen::MatrixXd& rows) const;
  /// Visits pieces of whole blocks, short enough for the memory next to the processor: the first point, the first row
  /// and the number of rows of each.
  template <typename Visit>
  void for_each_piece(const Visit& visit) const;

  /// What a filter (Kalman) tells of some shares at once.
  struct Filtered {
    std::vector<double> products;  // of what is new in two columns, weighed: the lower triangle by rows, of each share
    Shares logarithm = {};         // of the determinant of the covariance
  };
  [[nodiscard]] Filtered filtered(const Shares& shares, double length) const;

  ResidualAxis axis_;
  std::size_t block_;             // points of a block but the last
  std::vector<double> position_;  // of the blocks
  std::vector<double> points_;    // of each block
  double spacing_, degrees_;
  double by_turning_ = 0;  // ln of the determinant of all factors
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Index width_;  // columns of the basis
  Rows means_;          // of the blocks, times the root of their points: a row for each residual of a point
  Rows within_;         // products of columns within the blocks
};

}  // namespace frac::detail
