// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace frac::detail {

/// Goodness of fit of a residual vector left by a model with that many parameters the residuals can tell apart.
struct Information {
  double cost;  // sum of squares
  double rms;
  double max_residual;
  double aicc, bic;  // information_criteria()
};

/// @param unit  root mean square of the weighted data; residuals below 1e-14 of it are rounding.
[[nodiscard]] Information information(std::span<const double> residual, std::size_t parameters, double unit);

}  // namespace frac::detail
