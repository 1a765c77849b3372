// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "identification/residuals/residuals.hpp"

namespace frac::detail {

/// Residuals at theta, and their derivatives with a column for each variable.
struct Linearisation {
  std::vector<double> residual;
  Eigen::MatrixXd jacobian;

  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> residuals() const {
    return {residual.data(), static_cast<Eigen::Index>(residual.size())};
  }
  /// A square matrix with the singular values and the right singular vectors of the Jacobian.
  [[nodiscard]] Eigen::MatrixXd reduced() const;
};

/// Empty where the model is not finite.
[[nodiscard]] std::optional<Linearisation> linearised(const Residuals& residuals, const std::vector<double>& theta);

}  // namespace frac::detail
