// SPDX-License-Identifier: BSD-3-Clause
#include "base/gram_schmidt.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/wide_vectors.hpp"

namespace frac::detail {
namespace {

using Index = Eigen::Index;

/// The products of a vector with some columns.
template <std::size_t width, std::size_t count>
FRACFIT_INLINE inline void multiply(const double* vector, std::size_t rows, const double* columns, std::size_t stride,
                                    double* products) {
  using Wide = Doubles<width>;
  const std::size_t whole = rows / width * width;
  typename Wide::Type product[count] = {};
  for (std::size_t i = 0; i < whole; i += width)
    for (std::size_t c = 0; c < count; ++c) product[c] += Wide::at(vector + i) * Wide::at(columns + c * stride + i);
  for (std::size_t c = 0; c < count; ++c) {
    products[c] = 0;
    for (std::size_t l = 0; l < width; ++l) products[c] += product[c][l];
    for (std::size_t i = whole; i < rows; ++i) products[c] += vector[i] * columns[c * stride + i];
  }
}

/// Takes from some columns their parts along a unit vector.
/// @param stride   from one column to the next
/// @param share    of the unit vector in each column, added to what is there
/// @param squares  of the length of each column afterwards
template <std::size_t width, std::size_t count>
FRACFIT_INLINE inline void take_out(const double* unit, std::size_t rows, double* columns, std::size_t stride,
                                    double* share, double* squares) {
  using Wide = Doubles<width>;
  using Vector = typename Wide::Type;
  const std::size_t whole = rows / width * width;
  double sum[count];
  multiply<width, count>(unit, rows, columns, stride, sum);
  for (std::size_t c = 0; c < count; ++c) share[c] += sum[c];
  Vector square[count] = {};
  for (std::size_t i = 0; i < whole; i += width) {
    for (std::size_t c = 0; c < count; ++c) {
      Vector& at = Wide::at(columns + c * stride + i);
      at -= sum[c] * Wide::at(unit + i);
      square[c] += at * at;
    }
  }
  for (std::size_t c = 0; c < count; ++c) {
    squares[c] = 0;
    for (std::size_t l = 0; l < width; ++l) squares[c] += square[c][l];
    for (std::size_t i = whole; i < rows; ++i) {
      double& at = columns[c * stride + i];
      at -= sum[c] * unit[i];
      squares[c] += at * at;
    }
  }
}

/// The same of any number of columns one behind the other.
template <std::size_t width>
FRACFIT_INLINE inline void take_out_of_all(const double* unit, std::size_t rows, std::size_t count, double* columns,
                                           std::size_t stride, double* share, double* squares) {
  constexpr std::size_t together = 4;  // columns that one load of the unit vector serves
  std::size_t c = 0;
  for (; c + together <= count; c += together)
    take_out<width, together>(unit, rows, columns + c * stride, stride, share + c, squares + c);
  for (; c < count; ++c) take_out<width, 1>(unit, rows, columns + c * stride, stride, share + c, squares + c);
}

template <typename Work>
void in_wide_vectors(const Work& work) {
  if (instruction_set() == InstructionSet::plain)
    work.template operator()<2>();
  else
    with_wide_vectors([&]() FRACFIT_INLINE { work.template operator()<4>(); });
}

}  // namespace

Eigen::VectorXd Orthonormalised::solution() const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Index>(order.size()));
  Eigen::VectorXd right = share;
  for (Index k = basis.cols(); k-- > 0;) {
    const double value = right[k] / triangle(k, k);
    result[order[static_cast<std::size_t>(k)]] = value;
    right.head(k) -= value * triangle.col(k).head(k);
  }
  return result;
}

Orthonormalised orthonormalised(Eigen::MatrixXd columns, const Eigen::VectorXd& vector, double threshold) {
  const Index rows = columns.rows(), count = columns.cols();
  const Index most = std::min(rows, count);
  const auto height = static_cast<std::size_t>(rows);
  Orthonormalised result{{}, Eigen::MatrixXd::Zero(most, count), {}, Eigen::VectorXd::Zero(most), vector};
  for (Index k = 0; k < count; ++k) result.order.push_back(k);
  Eigen::VectorXd squares = columns.colwise().squaredNorm();
  Eigen::VectorXd first = squares, share(count), unused(std::max<Index>(count, 1));
  Index rank = 0;
  in_wide_vectors([&]<std::size_t width>() FRACFIT_INLINE {
    double longest = 0;
    for (; rank < most; ++rank) {
      Index pivot = rank;
      for (Index k = rank + 1; k < count; ++k) {
        if (squares[k] > squares[pivot]) pivot = k;
      }
      if (pivot != rank) {
        columns.col(pivot).swap(columns.col(rank));
        result.triangle.col(pivot).swap(result.triangle.col(rank));
        std::swap(squares[pivot], squares[rank]);
        std::swap(first[pivot], first[rank]);
        std::swap(result.order[static_cast<std::size_t>(pivot)], result.order[static_cast<std::size_t>(rank)]);
      }
      auto column = columns.col(rank);
      // What has shrunk to a tenth holds ten times the rounding of what was taken out, along the vectors before, which
      // a second time takes out in turn (Giraud and others 2005).
      if (squares[rank] < 0.01 * first[rank]) {
        for (Index k = 0; k < rank; ++k) {
          take_out<width, 1>(columns.col(k).data(), height, column.data(), height, &result.triangle(k, rank),
                             &squares[rank]);
        }
      }
      const double length = std::sqrt(squares[rank]);
      longest = std::max(longest, length);
      if (!(length > threshold * longest)) break;
      column *= 1 / length;
      result.triangle(rank, rank) = length;
      const auto behind = static_cast<std::size_t>(count - rank - 1);
      share.setZero();
      if (behind > 0) {
        take_out_of_all<width>(column.data(), height, behind, columns.col(rank + 1).data(), height, share.data(),
                               squares.data() + rank + 1);
        result.triangle.row(rank).tail(count - rank - 1) = share.head(count - rank - 1);
      }
      take_out<width, 1>(column.data(), height, result.rest.data(), height, &result.share[rank], unused.data());
    }
  });
  if (rank == count)
    result.basis = std::move(columns);
  else
    result.basis = columns.leftCols(rank);
  return result;
}

Eigen::MatrixXd products_of(const Eigen::MatrixXd& columns) {
  const auto rows = static_cast<std::size_t>(columns.rows());
  Eigen::MatrixXd products(columns.cols(), columns.cols());
  in_wide_vectors([&]<std::size_t width>() FRACFIT_INLINE {
    constexpr Index together = 4;
    for (Index k = 0; k < columns.cols(); ++k) {
      double* const above = products.col(k).data();
      Index j = 0;
      for (; j + together <= k + 1; j += together)
        multiply<width, together>(columns.col(k).data(), rows, columns.col(j).data(), rows, above + j);
      for (; j <= k; ++j) multiply<width, 1>(columns.col(k).data(), rows, columns.col(j).data(), rows, above + j);
      products.row(k).head(k) = products.col(k).head(k);
    }
  });
  return products;
}

void remove_span(const Eigen::MatrixXd& basis, Eigen::Ref<Eigen::MatrixXd> columns) {
  Eigen::VectorXd share(columns.cols()), squares(columns.cols());
  in_wide_vectors([&]<std::size_t width>() FRACFIT_INLINE {
    for (Index k = 0; k < basis.cols(); ++k) {
      take_out_of_all<width>(basis.col(k).data(), static_cast<std::size_t>(basis.rows()),
                             static_cast<std::size_t>(columns.cols()), columns.data(),
                             static_cast<std::size_t>(columns.outerStride()), share.data(), squares.data());
    }
  });
}

}  // namespace frac::detail
