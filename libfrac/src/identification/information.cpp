#include "information.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace frac::detail {

Information information(std::span<const double> residual, std::size_t parameters, double unit) {
  const auto n = static_cast<double>(residual.size());
  const auto k = static_cast<double>(parameters) + 1;
  Information result{};
  for (const double r : residual) {
    result.cost += r * r;
    result.max_residual = std::max(result.max_residual, std::abs(r));
  }
  result.rms = std::sqrt(result.cost / n);
  // Exact data leave rounding only; the floor keeps the logarithm finite so that then the parameter count decides.
  const double log_likelihood_term = n * std::log(std::max(result.cost / n, 1e-28 * unit * unit));
  result.aicc =
      n > k + 1 ? log_likelihood_term + 2 * k + 2 * k * (k + 1) / (n - k - 1) : std::numeric_limits<double>::infinity();
  result.bic = log_likelihood_term + k * std::log(n);
  return result;
}

}  // namespace frac::detail
