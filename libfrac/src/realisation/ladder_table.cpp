// SPDX-License-Identifier: BSD-3-Clause
#include "ladder_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "approximation/log_pole_problem.hpp"

namespace frac::detail {
namespace {

// Newton's iteration for the mean of powers 2, 4, 8, each from the solution of the one before.
LogPoles power_optimal_log_poles(const UnitProblem& problem, int poles) {
  LogPoleProblem least(problem, poles);
  LogPoles current = starting_log_poles(problem, poles);
  least.evaluate(current);
  for (const int power : {2, 4, 8}) {
    // The last digits count at the last power alone.
    const double close = power == 8 ? 1e-11 : 1e-3;
    double damping = 1e-5;
    for (int i = 0; i < 40; ++i) {
      const std::vector<double> change = least.power_step(current, power, damping);
      if (change.empty()) break;
      const double mean = least.power_mean(power);
      double share = 1;
      for (; share > 1e-3; share /= 2) {
        const LogPoles trial = moved(current, change, share);
        if (!interlaced(trial)) continue;
        least.evaluate(trial);
        if (least.power_mean(power) <= mean * (1 + 1e-12)) {
          current = trial;
          break;
        }
      }
      const bool moved_on = share > 1e-3;
      if (!moved_on) {
        least.evaluate(current);
        if (damping > 1e-2) break;
      }
      damping = !moved_on || least.power_mean(power) > 0.5 * mean ? std::min(10 * damping, 0.1) : damping / 10;
      double largest = 0;
      for (const double each : change) largest = std::max(largest, std::abs(each));
      if (moved_on && share * largest < close) break;
    }
  }
  return current;
}

}  // namespace

LadderTable::LadderTable(double half_width, int poles) {
  constexpr std::size_t points = 24;
  std::vector<std::vector<double>> value(static_cast<std::size_t>(poles));
  for (std::size_t j = 0; j < points; ++j) {
    // (1 - cos)/2 without cancellation, and 1 - order likewise.
    const double angle = (static_cast<double>(j) + 0.5) * std::numbers::pi / points;
    const double order = std::pow(std::sin(angle / 2), 2);
    const double from_one = std::pow(std::cos(angle / 2), 2);
    const LogPoles log_poles = power_optimal_log_poles({order, half_width}, poles);
    for (std::size_t k = 0; k < value.size(); ++k) value[k].push_back(static_cast<double>(log_poles[k]));
    value.back().back() += std::log(from_one);
  }
  for (const std::vector<double>& row : value) {
    std::vector<double> coefficients(points);
    for (std::size_t m = 0; m < points; ++m) {
      for (std::size_t j = 0; j < points; ++j) {
        const double angle = static_cast<double>(m) * (static_cast<double>(j) + 0.5) * std::numbers::pi / points;
        // cos(angle of the point) = 1 - 2 order.
        coefficients[m] += (m == 0 ? 1.0 : 2.0) / points * row[j] * std::cos(angle);
      }
    }
    coefficients_.push_back(coefficients);
  }
}

void LadderTable::evaluate(double order, std::vector<double>& log_poles, std::vector<double>& by_order) const {
  const double x = 1 - 2 * order;
  log_poles.resize(coefficients_.size());
  by_order.resize(coefficients_.size());
  for (std::size_t k = 0; k < coefficients_.size(); ++k) {
    // Clenshaw's recurrence, differentiated along with it.
    double value = 0, value_before = 0, slope = 0, slope_before = 0;
    for (std::size_t m = coefficients_[k].size(); m-- > 1;) {
      const double next_slope = 2 * value + 2 * x * slope - slope_before;
      slope_before = slope;
      slope = next_slope;
      const double next = coefficients_[k][m] + 2 * x * value - value_before;
      value_before = value;
      value = next;
    }
    log_poles[k] = coefficients_[k][0] + x * value - value_before;
    by_order[k] = -2 * (value + x * slope - slope_before);
  }
  log_poles.back() -= std::log1p(-order);
  by_order.back() += 1 / (1 - order);
}

}  // namespace frac::detail
