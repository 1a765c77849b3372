// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace frac::detail {

/// Columns, by their indices, of which a linear combination comes that near to the target.
struct ColumnSubset {
  std::vector<std::size_t> members;  // rising
  double cost;                       // squared distance that is left
};

/// The best subsets of each size from 1 to `most`, up to `kept` of each, best first, out of all there are.
///
/// Every subset is visited: each step takes one more column into the space, which is taken out of the columns that
/// follow and out of the residual (the modified Gram-Schmidt method as an update of a QR decomposition), so that the
/// last of a subset costs a single product.  Subsets with a column that depends on the others to 1e-11 are those
/// without it, and are left out.
/// @param columns  of length 1, or 0 where nothing is seen of one
[[nodiscard]] std::vector<std::vector<ColumnSubset>> best_subsets(const Eigen::MatrixXd& columns,
                                                                  const Eigen::VectorXd& target, std::size_t most,
                                                                  std::size_t kept);

}  // namespace frac::detail
