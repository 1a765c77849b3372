// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_jacobian.hpp"

#include "triangular_form.hpp"

namespace frac::detail {

std::optional<Eigen::MatrixXd> reduced_jacobian(const Residuals& residuals, const std::vector<double>& theta,
                                                std::vector<double>& residual) {
  const std::size_t width = theta.size();
  residual.resize(residuals.count());
  std::vector<double> jacobian(residual.size() * width), triangle((width + 1) * (width + 1));
  if (!residuals.evaluate(theta, residual.data(), jacobian.data())) return std::nullopt;
  if (width == 0) return Eigen::MatrixXd(0, 0);
  triangular_form(jacobian, residual, triangle);
  Eigen::MatrixXd reduced(width, width);
  for (std::size_t row = 0; row < width; ++row) {
    for (std::size_t k = 0; k < width; ++k) {
      reduced(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) = triangle[row * (width + 1) + k];
    }
  }
  return reduced;
}

}  // namespace frac::detail
