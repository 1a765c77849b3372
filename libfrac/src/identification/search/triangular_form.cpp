// SPDX-License-Identifier: BSD-3-Clause
#include "triangular_form.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/wide_vectors.hpp"

namespace frac::detail {

namespace {

constexpr std::size_t block = 64;  // rows taken in together
constexpr std::size_t narrow = 2, widest = 4;

/// Reflects some columns and the entries of the triangle above them: the reflecting vector has this head and goes on
/// with the pivot column.
template <std::size_t width, std::size_t count>
FRACFIT_INLINE inline void reflect_columns(const double* pivot, double head, double scale, std::size_t height,
                                           double* above, double* columns) {
  using Vector = typename Doubles<width>::Type;
  const auto* const from = reinterpret_cast<const Vector*>(pivot);
  auto* const to = reinterpret_cast<Vector*>(columns);
  constexpr std::size_t stride = block / width;
  Vector product[count] = {};
  for (std::size_t i = 0; i < height / width; ++i)
    for (std::size_t c = 0; c < count; ++c) product[c] += from[i] * to[c * stride + i];
  double share[count];
  for (std::size_t c = 0; c < count; ++c) {
    double sum = head * above[c];
    for (std::size_t l = 0; l < width; ++l) sum += product[c][l];
    share[c] = sum * scale;
    above[c] -= share[c] * head;
  }
  for (std::size_t i = 0; i < height / width; ++i)
    for (std::size_t c = 0; c < count; ++c) to[c * stride + i] -= share[c] * from[i];
}

/// Reflects the column of `triangle` with index k and the block below it onto the triangle's diagonal, and the columns
/// behind with it.
/// @param height  of the block, a multiple of `width`
template <std::size_t width>
FRACFIT_INLINE inline void reflect(std::size_t k, std::size_t columns, std::size_t height, double* triangle,
                                   double* rows) {
  const double* const pivot = rows + k * block;
  using Vector = typename Doubles<width>::Type;
  Vector squares = {};
  for (std::size_t i = 0; i < height; i += width) {
    const auto& part = *reinterpret_cast<const Vector*>(pivot + i);
    squares += part * part;
  }
  double below = 0;
  for (std::size_t l = 0; l < width; ++l) below += squares[l];
  if (below == 0) return;
  double* const row = triangle + k * columns;
  double& diagonal = row[k];
  const double length = std::sqrt(diagonal * diagonal + below);
  const double end = diagonal > 0 ? -length : length;
  const double head = diagonal - end;
  const double scale = 1 / (length * std::abs(head));
  diagonal = end;
  constexpr std::size_t together = 4;  // columns that one load of the pivot serves
  std::size_t j = k + 1;
  for (; j + together <= columns; j += together)
    reflect_columns<width, together>(pivot, head, scale, height, row + j, rows + j * block);
  for (; j < columns; ++j) reflect_columns<width, 1>(pivot, head, scale, height, row + j, rows + j * block);
}

}  // namespace

void triangular_form(std::span<const double> jacobian, std::span<const double> residual, std::span<double> triangle) {
  const std::size_t width = jacobian.size() / residual.size(), columns = width + 1;
  thread_local AlignedVector<double> rows;  // column by column
  rows.resize(columns * block);
  std::fill(triangle.begin(), triangle.end(), 0.0);
  for (std::size_t first = 0; first < residual.size(); first += block) {
    const std::size_t count = std::min(block, residual.size() - first);
    const std::size_t height = (count + widest - 1) / widest * widest;
    for (std::size_t j = 0; j < columns; ++j) {
      const double* const from = j < width ? jacobian.data() + j * residual.size() : residual.data();
      double* const to = rows.data() + j * block;
      std::copy_n(from + first, count, to);
      std::fill(to + count, to + height, 0.0);
    }
    if (instruction_set() == InstructionSet::plain) {
      for (std::size_t k = 0; k < columns; ++k) reflect<narrow>(k, columns, height, triangle.data(), rows.data());
    } else {
      with_wide_vectors([&]() FRACFIT_INLINE {
        for (std::size_t k = 0; k < columns; ++k) reflect<widest>(k, columns, height, triangle.data(), rows.data());
      });
    }
  }
}

}  // namespace frac::detail
