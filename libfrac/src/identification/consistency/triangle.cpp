// SPDX-License-Identifier: BSD-3-Clause
#include "triangle.hpp"

#include <cstddef>
#include <span>

#include "identification/search/triangular_form.hpp"

namespace frac::detail {

Triangle::Triangle(const Eigen::MatrixXcd& columns, const Eigen::VectorXd& target)
    : entries_(columns.cols() + 1, columns.cols() + 1) {
  // A complex number is its two parts in memory.
  const std::span<const double> rows(reinterpret_cast<const double*>(columns.data()),
                                     2 * static_cast<std::size_t>(columns.size()));
  triangular_form(rows, {target.data(), static_cast<std::size_t>(target.size())},
                  {entries_.data(), static_cast<std::size_t>(entries_.size())});
}

double Triangle::squared_distance(Eigen::Index columns) const {
  return entries_.col(entries_.cols() - 1).tail(entries_.rows() - columns).squaredNorm();
}

Eigen::VectorXd Triangle::solution(Eigen::Index columns) const {
  Eigen::VectorXd x = entries_.col(entries_.cols() - 1).head(columns);
  for (Eigen::Index i = columns; i-- > 0;) {
    const Eigen::Index behind = columns - 1 - i;
    x(i) = (x(i) - entries_.row(i).segment(i + 1, behind).dot(x.tail(behind))) / entries_(i, i);
  }
  return x;
}

}  // namespace frac::detail
