// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>
#include <vector>

namespace backlash::detail {

/// Gaussian elimination with the largest pivot of each column, for matrices of a few dozen rows, row after row.
/// @param right  one number per row, solved in place; may be empty
/// @return the determinant; 0 where the matrix is singular, and `right` is then of no use
template <typename Number>
Number eliminate(std::vector<Number>& matrix, std::vector<Number>& right) {
  const std::size_t size = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(matrix.size()))));
  const auto at = [&](std::size_t row, std::size_t column) -> Number& { return matrix[row * size + column]; };
  Number determinant = 1;
  for (std::size_t k = 0; k < size; ++k) {
    std::size_t pivot = k;
    for (std::size_t row = k + 1; row < size; ++row) {
      if (std::abs(at(row, k)) > std::abs(at(pivot, k))) pivot = row;
    }
    if (at(pivot, k) == Number(0)) return 0;
    if (pivot != k) {
      for (std::size_t column = k; column < size; ++column) std::swap(at(pivot, column), at(k, column));
      if (!right.empty()) std::swap(right[pivot], right[k]);
      determinant = -determinant;
    }
    determinant *= at(k, k);
    for (std::size_t row = k + 1; row < size; ++row) {
      const Number factor = at(row, k) / at(k, k);
      if (factor == Number(0)) continue;
      for (std::size_t column = k + 1; column < size; ++column) at(row, column) -= factor * at(k, column);
      if (!right.empty()) right[row] -= factor * right[k];
    }
  }
  if (right.empty()) return determinant;
  for (std::size_t k = size; k-- > 0;) {
    for (std::size_t column = k + 1; column < size; ++column) right[k] -= at(k, column) * right[column];
    right[k] /= at(k, k);
  }
  return determinant;
}

}  // namespace backlash::detail
