// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace frac::detail {

// Eigen's solver costs ten seconds of compiler time: it is compiled in one file.

/// Of a real matrix; a pair of conjugate ones stands side by side, the upper first.
[[nodiscard]] Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

}  // namespace frac::detail
