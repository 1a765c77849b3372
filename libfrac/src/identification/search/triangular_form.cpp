// SPDX-License-Identifier: BSD-3-Clause
#include "triangular_form.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/wide_vectors.hpp"

namespace frac::detail {

namespace {

constexpr std::size_t block = 64;  // rows taken in together
constexpr std::size_t lanes = 8;   // sums kept apart, so that they fit registers

/// Reflects the column of `triangle` with index k and the block below it onto the triangle's diagonal, and the columns
/// behind with it.
FRACFIT_INLINE inline void reflect(std::size_t k, std::size_t columns, double* triangle, double* rows) {
  const double* const pivot = rows + k * block;
  double partial[lanes] = {};
  for (std::size_t i = 0; i < block; i += lanes) {
    for (std::size_t l = 0; l < lanes; ++l) partial[l] += pivot[i + l] * pivot[i + l];
  }
  double below = 0;
  for (const double each : partial) below += each;
  if (below == 0) return;
  double& diagonal = triangle[k * columns + k];
  const double length = std::sqrt(diagonal * diagonal + below);
  const double end = diagonal > 0 ? -length : length;
  const double head = diagonal - end;  // of the reflecting vector; the rest of it is the pivot column
  const double scale = 1 / (length * std::abs(head));
  diagonal = end;
  for (std::size_t j = k + 1; j < columns; ++j) {
    double* const column = rows + j * block;
    double product[lanes] = {};
    for (std::size_t i = 0; i < block; i += lanes) {
      for (std::size_t l = 0; l < lanes; ++l) product[l] += pivot[i + l] * column[i + l];
    }
    double& above = triangle[k * columns + j];
    double sum = head * above;
    for (const double each : product) sum += each;
    const double share = sum * scale;
    above -= share * head;
    for (std::size_t i = 0; i < block; ++i) column[i] -= share * pivot[i];
  }
}

}  // namespace

void triangular_form(std::span<const double> jacobian, std::span<const double> residual, std::span<double> triangle) {
  const std::size_t width = jacobian.size() / residual.size(), columns = width + 1;
  thread_local AlignedVector<double> rows;  // column by column
  rows.resize(columns * block);
  std::fill(triangle.begin(), triangle.end(), 0.0);
  for (std::size_t first = 0; first < residual.size(); first += block) {
    const std::size_t count = std::min(block, residual.size() - first);
    for (std::size_t j = 0; j < columns; ++j) {
      const double* const from = j < width ? jacobian.data() + j * residual.size() : residual.data();
      double* const to = rows.data() + j * block;
      std::copy_n(from + first, count, to);
      std::fill(to + count, to + block, 0.0);
    }
    with_wide_vectors([&]() FRACFIT_INLINE {
      for (std::size_t k = 0; k < columns; ++k) reflect(k, columns, triangle.data(), rows.data());
    });
  }
}

}  // namespace frac::detail
