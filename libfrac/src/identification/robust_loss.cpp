#include "robust_loss.hpp"

#include <algorithm>
#include <cmath>

namespace frac::detail {

namespace {

/// Loss scales that keep 95 % efficiency on normal residuals (Huber 1981; Holland, Welsch 1977).
double tuning_constant(Loss loss) {
  return loss == Loss::huber ? 1.345 : 2.385;
}

}  // namespace

double robust_spread(std::vector<double> residual) {
  for (double& value : residual) value = std::abs(value);
  const auto middle = residual.begin() + static_cast<std::ptrdiff_t>(residual.size() / 2);
  std::nth_element(residual.begin(), middle, residual.end());
  return 1.4826 * *middle;
}

LocalOptions robust_options(const Residuals& residuals, const std::vector<double>& theta, Loss loss) {
  LocalOptions options;
  std::vector<double> residual(residuals.count());
  residuals.evaluate(theta, residual.data(), nullptr);
  const double spread = robust_spread(std::move(residual));
  // Most residuals are 0: there is nothing a loss could hold back.
  if (loss == Loss::none || !(spread > 0)) return options;
  options.loss = loss;
  options.loss_scale = tuning_constant(loss) * spread;
  return options;
}

LocalOptions robust_refinement(const Residuals& residuals, Loss loss, LocalSolution& solution) {
  LocalOptions options = robust_options(residuals, solution.theta, loss);
  for (int pass = 0; pass < 30 && options.loss != Loss::none; ++pass) {
    solution = local_solve(residuals, solution.theta, options);
    const LocalOptions next = robust_options(residuals, solution.theta, loss);
    const bool settled = std::abs(next.loss_scale - options.loss_scale) <= 1e-3 * options.loss_scale;
    options = next;
    if (settled) break;
  }
  return options;
}

}  // namespace frac::detail
