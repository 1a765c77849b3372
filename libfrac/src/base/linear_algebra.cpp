// SPDX-License-Identifier: BSD-3-Clause
#include "base/linear_algebra.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>

namespace frac::detail {

PivotedQr::PivotedQr(const Eigen::MatrixXd& columns) : factors_(std::make_shared<Factors>(columns)) {}

PivotedQr::PivotedQr(const Eigen::MatrixXd& columns, double threshold) {
  const auto factors = std::make_shared<Factors>(columns);
  factors->setThreshold(threshold);
  factors_ = factors;
}

Eigen::Index PivotedQr::rank() const {
  return factors_->rank();
}

// A vector as a matrix of one column: a solution of its own kind would be instantiated for two seconds.
Eigen::VectorXd PivotedQr::solve(const Eigen::VectorXd& right) const {
  return solve(Eigen::MatrixXd(right));
}

Eigen::MatrixXd PivotedQr::solve(const Eigen::MatrixXd& right) const {
  return factors_->solve(right);
}

Eigen::MatrixXd PivotedQr::basis() const {
  return factors_->householderQ() * Eigen::MatrixXd::Identity(factors_->rows(), factors_->rank());
}

std::vector<Eigen::Index> PivotedQr::order() const {
  const auto& indices = factors_->colsPermutation().indices();
  return {indices.begin(), indices.end()};
}

PlainQr::PlainQr(const Eigen::MatrixXd& columns) : factors_(std::make_shared<Factors>(columns)) {}

Eigen::VectorXd PlainQr::solve(const Eigen::VectorXd& right) const {
  return factors_->solve(Eigen::MatrixXd(right));
}

Eigen::MatrixXd PlainQr::basis() const {
  return factors_->householderQ() *
         Eigen::MatrixXd::Identity(factors_->rows(), std::min(factors_->rows(), factors_->cols()));
}

double PlainQr::squared_distance(const Eigen::VectorXd& from) const {
  const Eigen::VectorXd turned = factors_->householderQ().adjoint() * from;
  return turned.tail(factors_->rows() - factors_->cols()).squaredNorm();
}

Eigen::VectorXd PlainQr::solve_triangle(const Eigen::VectorXd& right) const {
  return factors_->matrixQR().topRows(factors_->cols()).triangularView<Eigen::Upper>().solve(right);
}

Eigen::MatrixXd PlainQr::dual() const {
  // The transpose of R^-1 Q'.
  return factors_->matrixQR()
      .topRows(factors_->cols())
      .triangularView<Eigen::Upper>()
      .solve(basis().transpose())
      .transpose();
}

CholeskyFactor::CholeskyFactor(const Eigen::MatrixXd& matrix) : factor_(std::make_shared<Factor>(matrix)) {}

bool CholeskyFactor::exists() const {
  return factor_->info() == Eigen::Success;
}

Eigen::VectorXd CholeskyFactor::diagonal() const {
  return factor_->matrixLLT().diagonal();
}

Eigen::VectorXd CholeskyFactor::solve(const Eigen::VectorXd& right) const {
  return factor_->solve(right);
}

// Of the triangle R of Q R P' = matrix, whose right vectors are those of the matrix in the order P.  Rows of zeros make
// a wide matrix square.  The same preconditioner inside of Eigen's decomposition takes three times as long to compile.
RightSingularVectors right_singular_vectors(const Eigen::MatrixXd& matrix) {
  const Eigen::Index size = matrix.cols();
  const Eigen::Index count = std::min(matrix.rows(), size);
  Eigen::MatrixXd triangle = Eigen::MatrixXd::Zero(size, size);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(matrix);
  triangle.topRows(count) = factors.matrixQR().topRows(count).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner> svd(triangle, Eigen::ComputeFullV);
  return {svd.singularValues().head(count), factors.colsPermutation() * svd.matrixV().leftCols(count)};
}

Eigen::MatrixXd shortest_solution(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  // Into the space of the columns; there the rows are independent, and the solution lies in their space.
  const Eigen::MatrixXd basis = PivotedQr(matrix).basis();
  if (basis.cols() == 0) return Eigen::MatrixXd::Zero(matrix.cols(), right.cols());
  const Eigen::MatrixXd rows = basis.transpose() * matrix;
  return PlainQr(rows.transpose()).dual() * (basis.transpose() * right);
}

Eigen::MatrixXd solve_square(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return matrix.partialPivLu().solve(right);
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
  return matrix.ldlt().solve(right);
}

}  // namespace frac::detail
