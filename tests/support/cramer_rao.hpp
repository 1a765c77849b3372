// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <vector>

#include "frac/identification/fit.hpp"

namespace support {

/// Cramer-Rao bound of the covariance for normal noise of standard deviation noise |G| on real and imaginary part each:
/// the inverse Fisher matrix.  From central differences of the model (step 1e-6 of the parameter: error 1e-9).
inline Eigen::MatrixXd cramer_rao(const char* formula, const std::vector<double>& parameters, frac::Component component,
                                  double noise, const std::vector<double>& omega) {
  const frac::Structure structure(formula);
  const auto count = static_cast<Eigen::Index>(parameters.size());
  Eigen::MatrixXd fisher = Eigen::MatrixXd::Zero(count, count);
  for (const double each : omega) {
    const double magnitude = std::abs(structure.response(parameters, each));
    Eigen::VectorXcd gradient(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      std::vector<double> above = parameters, below = parameters;
      const double step = 1e-6 * std::abs(parameters[static_cast<std::size_t>(k)]);
      above[static_cast<std::size_t>(k)] += step;
      below[static_cast<std::size_t>(k)] -= step;
      gradient[k] =
          (structure.response(above, each) - structure.response(below, each)) / (2 * step * magnitude * noise);
    }
    fisher += gradient.imag() * gradient.imag().transpose();
    if (component == frac::Component::both) fisher += gradient.real() * gradient.real().transpose();
  }
  return fisher.llt().solve(Eigen::MatrixXd::Identity(count, count));
}

}  // namespace support
