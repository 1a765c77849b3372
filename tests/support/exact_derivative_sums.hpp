// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "support/reference_table.hpp"

namespace support {

/// A sum of Gruenwald-Letnikov weights over samples of t^m, from a table.
struct DerivativeSum {
  double order;
  double step;
  std::vector<double> samples;
  double value;  // for exact samples
  /// Ours are rounded, relative to t^m by (m + 1) eps.  The derivative of order q of that rounding is at most
  /// h^-q sum|w_k| <= h^-q 2^(q+1) times as large as the samples, which grow up to the last.
  double rounding;
};
inline std::vector<DerivativeSum> exact_derivative_sums() {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  std::vector<DerivativeSum> sums;
  for (const auto& row : reference_table("gl_sum_exact.csv")) {
    DerivativeSum sum{row[0], row[4], {}, row[5], 0};
    const double power = row[1];
    for (double k = 0; k <= row[3]; ++k) sum.samples.push_back(std::pow(k * sum.step, power));
    sum.rounding = (power + 1) * eps * std::pow(2, sum.order + 1) * std::pow(sum.step, -sum.order) * sum.samples.back();
    sums.push_back(std::move(sum));
  }
  return sums;
}

}  // namespace support
