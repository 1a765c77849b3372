// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/judging/record_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "benchmarks/judging/least_squares.hpp"
#include "benchmarks/judging/price_of_an_order.hpp"

namespace judging {
namespace {

constexpr std::size_t kMostExponentials = 8;
/// Standard deviation of a record without noise over its largest output: what the inversion of the transform leaves.
constexpr double kInversionError = 1e-9;

/// Rows over the standard deviation of the noise, whitened.
std::vector<double> whitened(const Record& record, const std::vector<double>& y) {
  double largest = 0;
  for (const double value : record.exact) largest = std::fmax(largest, std::abs(value));
  const double sigma = std::fmax(record.sigma, kInversionError * largest);
  const double innovation = std::sqrt(1 - record.correlation * record.correlation);
  std::vector<double> rows(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    rows[i] = i == 0 ? y[i] / sigma : (y[i] - record.correlation * y[i - 1]) / (sigma * innovation);
  }
  return rows;
}

/// Step responses of 1/(s^2 + b1 s + b0) and s/(s^2 + b1 s + b0); poles are kept apart and off 0 by a millionth.
std::pair<double, double> step_of_pair(double b1, double b0, double t) {
  const Complex root = std::sqrt(Complex(b1 * b1 / 4 - b0, 0));
  Complex p1 = -b1 / 2 + root;
  Complex p2 = -b1 / 2 - root;
  const double size = std::abs(p1) + std::abs(p2) + 1e-9;
  if (std::abs(p1 - p2) < 1e-6 * size) p2 += 1e-6 * size;
  if (std::abs(p1) < 1e-6) p1 += 1e-6;
  if (std::abs(p2) < 1e-6) p2 += 2e-6;
  const Complex e1 = std::exp(p1 * t);
  const Complex e2 = std::exp(p2 * t);
  return {(1.0 / (p1 * p2) + (e1 / p1 - e2 / p2) / (p1 - p2)).real(), ((e1 - e2) / (p1 - p2)).real()};
}

Columns exponentials(const Record& record, const std::vector<double>& theta, std::size_t order) {
  const double delay = theta.size() > order ? theta[order] : 0;
  Columns columns;
  const auto add = [&](const std::function<double(double)>& response) {
    columns.push_back(
        whitened(record, respond(record, [&](double t) { return t < delay ? 0.0 : response(t - delay); })));
  };
  for (std::size_t i = 0; i + 1 < order; i += 2) {
    add([&](double t) { return step_of_pair(theta[i], theta[i + 1], t).first; });
    add([&](double t) { return step_of_pair(theta[i], theta[i + 1], t).second; });
  }
  if (order % 2 == 1) {
    const double p = theta[order - 1];
    add([p](double t) { return std::abs(p * t) < 1e-9 ? t : -std::expm1(-p * t) / p; });
  }
  add([](double) { return 1.0; });
  columns.push_back(whitened(record, std::vector<double>(record.time.size(), 1)));
  return columns;
}

double price(const Record& record, std::size_t parameters) {
  return 0.5 * static_cast<double>(parameters) * std::log(static_cast<double>(record.time.size()));
}

/// Least price of sums of exponentials; fills the bound's rational rival.
double best_rational(const System& system, const Record& record, Bound* bound) {
  const double length = record.time.back();
  const double slowest = 0.3 / length;
  const double fastest = 0.5 * static_cast<double>(record.time.size()) / length;
  const std::vector<double> target = whitened(record, record.exact);
  double best = std::numeric_limits<double>::infinity();
  const bool delayed = system.delay > 0;
  for (std::size_t order = 1; order <= kMostExponentials; ++order) {
    const std::size_t parameters = 2 * order + 2 + (delayed ? 1 : 0);
    if (price(record, parameters) >= best) break;
    for (const double damping : {1.0, 0.3}) {
      for (const double top : {fastest, std::sqrt(slowest * fastest) * 3}) {
        std::vector<double> theta;
        const auto rate = [&](double part) { return slowest * std::pow(top / slowest, part); };
        const auto count = static_cast<double>(order);
        for (std::size_t i = 0; i + 1 < order; i += 2) {
          const double a = rate((static_cast<double>(i) + 0.5) / count);
          const double b = rate((static_cast<double>(i) + 1.5) / count);
          theta.push_back(damping * (a + b));
          theta.push_back(a * b);
        }
        if (order % 2 == 1) theta.push_back(rate((count - 0.5) / count));
        if (delayed) theta.push_back(1.1 * system.delay);
        const ProjectedFit fit = fit_by_projection(
            [&](const std::vector<double>& t) { return exponentials(record, t, order); }, target, theta, 25);
        const double loss = 0.5 * fit.cost;
        if (loss + price(record, parameters) < best) {
          best = loss + price(record, parameters);
          bound->rational_order = static_cast<int>(order);
          bound->rational_delay = delayed;
          bound->rational_loss = loss;
        }
      }
    }
  }
  return best;
}

}  // namespace

Bound record_bound(const Kind& kind, const System& system, const Record& record) {
  Bound bound;
  if (kind.fractional) {
    const auto own = static_cast<std::size_t>(system.free_parameters(true)) + 1;
    bound.log_odds = best_rational(system, record, &bound) - price(record, own);
    bound.deviation = std::sqrt(2 * bound.rational_loss);
    return bound;
  }
  const auto curve = [&](const std::vector<double>& p, double order) {
    System moved = system;
    moved.parameters = p;
    moved.order = order;
    return whitened(record, respond(record, [&](double t) { return step_response(moved, t); }));
  };
  const Columns others = {whitened(record, record.exact), whitened(record, std::vector<double>(record.time.size(), 1))};
  bound.log_odds = price_of_an_order(curve, system.parameters, others, 1);
  bound.deviation = std::sqrt(0.5);
  bound.fractional_name = "order-freed";
  return bound;
}

}  // namespace judging
