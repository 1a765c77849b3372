// SPDX-License-Identifier: BSD-3-Clause
#include "nonnegative.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

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

Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& b) {
  // Columns that promise less lie in the space of the free ones but for rounding.
  const double rounding = 1e-12 * b.norm();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(columns.cols());
  std::vector<Eigen::Index> free;
  while (static_cast<Eigen::Index>(free.size()) < columns.rows()) {
    throw_if_cancelled();
    Eigen::VectorXd slope = columns.transpose() * (b - columns * x);
    slope(free).setConstant(-1);
    Eigen::Index steepest = 0;
    if (!(slope.maxCoeff(&steepest) > rounding)) break;
    free.push_back(steepest);
    while (true) {
      const Eigen::VectorXd solved = PlainQr(columns(Eigen::all, free)).solve(b);
      // The new column is 0 so far: by its slope it can only turn negative where rounding has made that.
      if (free.back() == steepest && !(solved(solved.size() - 1) > 0)) return x;
      double step = 1;
      for (Eigen::Index k = 0; k < solved.size(); ++k) {
        const double from = x(free[static_cast<std::size_t>(k)]);
        if (solved(k) <= 0) step = std::min(step, from / (from - solved(k)));
      }
      std::vector<Eigen::Index> kept;
      for (Eigen::Index k = 0; k < solved.size(); ++k) {
        double& at = x(free[static_cast<std::size_t>(k)]);
        const bool ends = solved(k) <= 0 && at / (at - solved(k)) <= step;
        at = ends ? 0 : at + step * (solved(k) - at);
        if (!ends) kept.push_back(free[static_cast<std::size_t>(k)]);
      }
      if (kept.size() == free.size()) break;
      free = std::move(kept);
    }
  }
  return x;
}

}  // namespace frac::detail
