// SPDX-License-Identifier: BSD-3-Clause
#include "nonnegative.hpp"

#include <cstddef>

#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"

namespace frac::detail {

Eigen::VectorXd nonnegative_minimum(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& b, std::vector<bool>& free) {
  const Eigen::Index n = b.size();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  Eigen::Index fewest = n + 1;
  int patience = 3;
  // All that are on the wrong side change sides at once; where that stops helping, the last one alone, which ends.
  for (Eigen::Index step = 0; step < 20 * n; ++step) {
    throw_if_cancelled();
    std::vector<Eigen::Index> chosen;
    for (Eigen::Index i = 0; i < n; ++i)
      if (free[static_cast<std::size_t>(i)]) chosen.push_back(i);
    x.setZero();
    if (!chosen.empty()) {
      const Eigen::MatrixXd part = hessian(chosen, chosen);
      const Eigen::VectorXd right = b(chosen);
      const Eigen::VectorXd solved = CholeskyFactor(part).solve(right);
      x(chosen) = solved;
    }
    const Eigen::VectorXd slope = hessian * x - b;
    const double rounding = 1e-12 * b.cwiseAbs().maxCoeff();
    std::vector<Eigen::Index> wrong;
    for (Eigen::Index i = 0; i < n; ++i)
      if (free[static_cast<std::size_t>(i)] ? x(i) < 0 : slope(i) < -rounding) wrong.push_back(i);
    if (wrong.empty()) break;
    const auto count = static_cast<Eigen::Index>(wrong.size());
    if (count < fewest) {
      fewest = count;
      patience = 3;
    } else {
      --patience;
    }
    for (std::size_t k = patience < 0 ? wrong.size() - 1 : 0; k < wrong.size(); ++k) {
      const auto i = static_cast<std::size_t>(wrong[k]);
      free[i] = !free[i];
    }
  }
  return x.cwiseMax(0);
}

}  // namespace frac::detail
