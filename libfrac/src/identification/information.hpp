#pragma once

#include <span>

namespace frac::detail {

/// Goodness of fit of a residual vector left by a model with that many parameters the residuals can tell apart.
struct Information {
  double cost;  // sum of squares
  double rms;
  double max_residual;
  /// n ln(cost/n) + 2 k + 2 k (k + 1)/(n - k - 1) with k = parameters + 1, the variance being estimated too (Hurvich,
  /// Tsai 1989); infinity when n <= k + 1.
  double aicc;
  double bic;  // n ln(cost/n) + k ln n (Schwarz 1978)
};

/// @param unit  root mean square of the weighted data; residuals below 1e-14 of it are rounding.
[[nodiscard]] Information information(std::span<const double> residual, std::size_t parameters, double unit);

}  // namespace frac::detail
