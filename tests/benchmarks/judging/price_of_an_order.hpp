// SPDX-License-Identifier: BSD-3-Clause
// What one fractional order more costs an integer-order truth.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <vector>

#include "benchmarks/judging/least_squares.hpp"

namespace judging {

/// Expected log odds (Savage, Dickey) for the order 1 against any order in [0.5, 1.5], all as likely:
/// -ln(sqrt(2 pi) sigma_a erf(1/(sqrt 8 sigma_a))), which is 0 where the data say nothing about the order.  sigma_a is
/// the Cramer-Rao bound of the order beside `parameters` and whatever enters linearly, whose columns are `others`.
/// `curve(parameters, order)` gives rows over their standard deviation; information is `scale` times that of the rows.
inline double price_of_an_order(const std::function<std::vector<double>(const std::vector<double>&, double)>& curve,
                                const std::vector<double>& parameters, Columns others, double scale) {
  constexpr double step = 1e-5;
  const auto difference = [](const std::vector<double>& high, const std::vector<double>& low, double width) {
    std::vector<double> result(high.size());
    for (std::size_t i = 0; i < high.size(); ++i) result[i] = (high[i] - low[i]) / (2 * width);
    return result;
  };
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    std::vector<double> high = parameters;
    std::vector<double> low = parameters;
    const double width = step * std::abs(parameters[i]);
    high[i] += width;
    low[i] -= width;
    others.push_back(difference(curve(high, 1), curve(low, 1), width));
  }
  const std::vector<double> order = difference(curve(parameters, 1 + step), curve(parameters, 1 - step), step);
  const double information = scale * std::pow(norm_of(solve_least_squares(others, order).second), 2);
  if (!(information > 0)) return 0;
  const double sigma = 1 / std::sqrt(information);
  return -std::log(std::sqrt(2 * std::numbers::pi) * sigma * std::erf(1 / (std::sqrt(8.0) * sigma)));
}

}  // namespace judging
