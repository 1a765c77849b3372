// SPDX-License-Identifier: BSD-3-Clause
#include "robust.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "base/median.hpp"
#include "search_starts.hpp"

namespace frac::detail {
namespace {

/// Residuals below this, in units of the data, are rounding.
constexpr double rounding = 1e-13;

}  // namespace

double tuning_constant(Loss loss) {
  return loss == Loss::huber ? 1.345 : 2.385;
}

double loss_cost(std::span<const double> residual, std::size_t per_point, const LocalOptions& options) {
  double sum = 0;
  for (std::size_t i = 0; i < residual.size(); i += per_point) {
    double square = 0;
    for (std::size_t k = 0; k < per_point; ++k) square += residual[i + k] * residual[i + k];
    sum += loss_at(options.loss, std::sqrt(square) / options.loss_scale).cost;
  }
  return sum * options.loss_scale * options.loss_scale;
}

double robust_spread(std::span<const double> residual) {
  std::vector<double> size(residual.begin(), residual.end());
  for (double& value : size) value = std::abs(value);
  return robust_deviation(std::move(size));
}

std::vector<std::size_t> outliers(std::span<const double> residual, std::size_t per_point) {
  std::vector<std::size_t> points;
  const double limit = std::max(5 * robust_spread(residual), rounding);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const std::size_t point = i / per_point;
    if (std::abs(residual[i]) > limit && (points.empty() || points.back() != point)) points.push_back(point);
  }
  return points;
}

LocalOptions robust_refinement(Residuals& residuals, Loss loss, std::optional<double> scale, LocalSolution& solution) {
  LocalOptions options;
  options.loss = loss;
  if (scale) {
    options.loss_scale = *scale;
    residuals.set_loss(options.loss, options.loss_scale);
    solution = local_solve(residuals, solution.theta, options);
    return options;
  }
  double spread = robust_spread(residuals_at(residuals, solution.theta));
  for (int pass = 0; pass < 30 && spread > 0; ++pass) {
    options.loss_scale = tuning_constant(loss) * spread;
    residuals.set_loss(options.loss, options.loss_scale);
    solution = local_solve(residuals, solution.theta, options);
    const double next = robust_spread(residuals_at(residuals, solution.theta));
    const bool settled = std::abs(next - spread) <= 1e-3 * spread;
    spread = next;
    if (settled) break;
  }
  return options;
}

LocalOptions robust_search(Residuals& residuals, Loss loss, std::optional<double> scale, std::uint64_t seed,
                           LocalSolution& solution) {
  constexpr int most_places = 24, enough_returns = 4;
  constexpr double equally_good = 1e-3;
  LocalOptions options = robust_refinement(residuals, loss, scale, solution);
  double spread = robust_spread(residuals_at(residuals, solution.theta));
  std::mt19937_64 generator(seed);
  const auto delay_step = [](const ParameterMap::Free& free, double step) {
    return step * (free.upper - free.lower) / 20;
  };
  int returns = 0;
  for (int place = 0; place < most_places && returns < enough_returns; ++place) {
    if (!(spread > rounding) || residuals.map().free().empty()) break;
    const std::vector<double> start =
        drawn_about(residuals.map(), solution.theta, place % 2 == 0 ? 0.5 : 2, generator, delay_step);
    if (!std::isfinite(residuals.cost(start))) continue;
    LocalOptions quick = options;
    quick.iterations = 40;
    quick.cost_tolerance = 1e-7;
    LocalSolution found = local_solve(residuals, start, quick);
    if (!(found.objective < solution.objective * (1 - equally_good))) {
      returns += found.objective <= solution.objective * (1 + equally_good) ? 1 : 0;
      continue;
    }
    const LocalOptions refined = robust_refinement(residuals, loss, scale, found);
    const double narrower = robust_spread(residuals_at(residuals, found.theta));
    const bool better = scale ? found.objective < solution.objective : narrower < spread;
    if (better) {
      solution = std::move(found);
      options = refined;
      spread = narrower;
      returns = 0;
    } else {
      residuals.set_loss(options.loss, options.loss_scale);
    }
  }
  return options;
}

std::vector<double> residuals_at(const Residuals& residuals, std::span<const double> theta) {
  std::vector<double> residual(residuals.count());
  residuals.evaluate(theta, residual.data(), nullptr);
  return residual;
}

}  // namespace frac::detail
