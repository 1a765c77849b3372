// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "base/linear_algebra.hpp"

namespace frac::detail {

/// Restricted likelihood of the correlation r of residuals.  The inverse covariance of first-order noise with unit
/// innovations is 1 - r N + r^2 D, with N the sum of both shifts by a point and D the identity without the first and
/// last point of each series, so that three small matrices serve every r.
class RestrictedLikelihood {
 public:
  /// @param basis  orthonormal, of the fitted columns
  RestrictedLikelihood(std::span<const double> residual, const Eigen::Ref<const Eigen::MatrixXd>& basis,
                       std::size_t per_point)
      : count_(static_cast<double>(residual.size())), series_(static_cast<double>(per_point)), width_(basis.cols()) {
    const auto rows = static_cast<Eigen::Index>(residual.size());
    const auto stride = static_cast<Eigen::Index>(per_point);
    whole_ = Eigen::MatrixXd::Zero(width_ + 1, width_ + 1);
    Eigen::MatrixXd product = whole_;
    // By blocks: a copy of very many rows takes longer than their products.
    constexpr Eigen::Index block = 2048;
    const auto rows_from = [&](Eigen::Index first, Eigen::Index count) {
      Eigen::MatrixXd some(count, width_ + 1);
      some << basis.middleRows(first, count), Eigen::Map<const Eigen::VectorXd>(residual.data() + first, count);
      return some;
    };
    for (Eigen::Index first = 0; first < rows; first += block) {
      const Eigen::MatrixXd some = rows_from(first, std::min(block + stride, rows - first));
      const Eigen::Index pairs = std::max<Eigen::Index>(some.rows() - stride, 0);
      const auto here = some.topRows(std::min(block, rows - first));
      whole_ += here.transpose() * here;
      product += some.topRows(pairs).transpose() * some.bottomRows(pairs);
    }
    neighbours_ = product + product.transpose();
    middle_ = Eigen::MatrixXd::Zero(width_ + 1, width_ + 1);
    if (rows <= 2 * stride) return;
    const Eigen::MatrixXd head = rows_from(0, stride), tail = rows_from(rows - stride, stride);
    middle_ = whole_ - head.transpose() * head - tail.transpose() * tail;
  }

  struct Value {
    double logarithm;
    double innovation;  // variance of the white noise that drives the first-order one
  };
  [[nodiscard]] Value at(double r) const {
    const Eigen::MatrixXd all = whole_ - r * neighbours_ + r * r * middle_;
    const Eigen::VectorXd factor = CholeskyFactor(all).diagonal();
    // The last diagonal entry is the length of the residual once the columns are fitted to it anew.
    double logarithm = 0.5 * series_ * std::log(1 - r * r);
    for (Eigen::Index i = 0; i < width_; ++i) logarithm -= std::log(factor(i));
    const double length = factor(width_);
    const double degrees = count_ - static_cast<double>(width_);
    return {logarithm - degrees * std::log(length), length * length / degrees};
  }

 private:
  double count_, series_;
  Eigen::Index width_;
  Eigen::MatrixXd whole_, neighbours_, middle_;
};

}  // namespace frac::detail
