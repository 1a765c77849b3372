// SPDX-License-Identifier: BSD-3-Clause
#include "linearisation.hpp"

#include <span>

#include "triangular_form.hpp"

namespace frac::detail {

std::optional<Linearisation> linearised(const Residuals& residuals, const std::vector<double>& theta) {
  Linearisation result{
      std::vector<double>(residuals.count()),
      Eigen::MatrixXd(static_cast<Eigen::Index>(residuals.count()), static_cast<Eigen::Index>(theta.size()))};
  if (!residuals.evaluate(theta, result.residual.data(), result.jacobian.data())) return std::nullopt;
  return result;
}

Eigen::MatrixXd Linearisation::reduced() const {
  const auto width = static_cast<std::size_t>(jacobian.cols());
  if (width == 0) return Eigen::MatrixXd(0, 0);
  std::vector<double> triangle((width + 1) * (width + 1));
  triangular_form(std::span(jacobian.data(), residual.size() * width), residual, triangle);
  Eigen::MatrixXd result(width, width);
  for (std::size_t row = 0; row < width; ++row) {
    for (std::size_t k = 0; k < width; ++k) {
      result(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) = triangle[row * (width + 1) + k];
    }
  }
  return result;
}

}  // namespace frac::detail
