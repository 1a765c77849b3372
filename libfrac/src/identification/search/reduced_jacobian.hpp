// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "identification/residuals/residuals.hpp"

namespace frac::detail {

/// A square matrix with the singular values and the right singular vectors of the Jacobian at theta; empty where the
/// model is not finite there.
[[nodiscard]] std::optional<Eigen::MatrixXd> reduced_jacobian(const Residuals& residuals,
                                                              const std::vector<double>& theta,
                                                              std::vector<double>& residual);

}  // namespace frac::detail
