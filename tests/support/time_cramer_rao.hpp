// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <string>
#include <vector>

#include "frac/structure.hpp"
#include "support/exact_output.hpp"

namespace support {

/// The structure with numbers for its parameters.
inline frac::FractionalTransferFunction model_of(const frac::Structure& structure,
                                                 const std::vector<double>& parameters) {
  const std::string& formula = structure.formula();
  std::string text;
  for (std::size_t i = 0; i < formula.size();) {
    std::size_t end = i;
    while (end < formula.size() && (std::isalpha(static_cast<unsigned char>(formula[end])) ||
                                    (end > i && std::isdigit(static_cast<unsigned char>(formula[end]))))) {
      ++end;
    }
    const std::string word = formula.substr(i, std::max<std::size_t>(end - i, 1));
    const auto& names = structure.parameter_names();
    const auto name = std::find(names.begin(), names.end(), word);
    char number[40];
    if (name != names.end()) {
      std::snprintf(number, sizeof number, "(%.17g)", parameters[static_cast<std::size_t>(name - names.begin())]);
    }
    text += name != names.end() ? number : word;
    i += word.size();
  }
  return frac::FractionalTransferFunction::parse(text);
}

/// Cramer-Rao bound of the covariance of parameters and offset (last) for normal noise of standard deviation sigma on
/// each output: the inverse Fisher matrix.  From central differences of the exact output (step 1e-5 of the parameter:
/// errors 1e-10 of the truncated term and 1e-8 of rounding).
inline Eigen::MatrixXd time_cramer_rao(const frac::Structure& structure, const std::vector<double>& parameters,
                                       double sigma, const std::vector<double>& time, const std::vector<double>& input,
                                       frac::Hold hold) {
  const auto count = static_cast<Eigen::Index>(parameters.size());
  Eigen::MatrixXd gradient(static_cast<Eigen::Index>(time.size()), count + 1);
  for (Eigen::Index k = 0; k < count; ++k) {
    std::vector<double> above = parameters, below = parameters;
    const double step = 1e-5 * parameters[static_cast<std::size_t>(k)];
    above[static_cast<std::size_t>(k)] += step;
    below[static_cast<std::size_t>(k)] -= step;
    const std::vector<double> high = exact_output(model_of(structure, above), time, input, hold);
    const std::vector<double> low = exact_output(model_of(structure, below), time, input, hold);
    for (std::size_t i = 0; i < time.size(); ++i) {
      gradient(static_cast<Eigen::Index>(i), k) = (high[i] - low[i]) / (2 * step * sigma);
    }
  }
  gradient.col(count).setConstant(1 / sigma);
  return (gradient.transpose() * gradient).llt().solve(Eigen::MatrixXd::Identity(count + 1, count + 1));
}

}  // namespace support
