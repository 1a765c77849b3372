// SPDX-License-Identifier: BSD-3-Clause
#include "base/eigenvalues.hpp"

#include <Eigen/Eigenvalues>
#include <complex>

#include "base/linear_algebra.hpp"

namespace frac::detail {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(matrix, false).eigenvalues();
}

PartialFractions partial_fractions(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& b,
                                   const Eigen::RowVectorXd& c) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix);
  // Of a pair, the real and the imaginary part of the upper one's eigenvector, so that all is real.
  const Eigen::MatrixXd& vectors = solver.pseudoEigenvectors();
  const Eigen::VectorXd of_b = PlainQr(vectors).solve(b);
  const Eigen::RowVectorXd of_c = c * vectors;
  PartialFractions result{solver.eigenvalues(), Eigen::VectorXcd(b.size())};
  for (Eigen::Index k = 0; k < b.size(); ++k) {
    if (result.poles[k].imag() == 0) {
      result.residues[k] = of_c[k] * of_b[k];
      continue;
    }
    const std::complex<double> upper(of_c[k], of_c[k + 1]);
    result.residues[k] = upper * std::complex<double>(of_b[k], -of_b[k + 1]) / 2.0;
    result.residues[k + 1] = std::conj(result.residues[k]);
    ++k;
  }
  return result;
}

}  // namespace frac::detail
