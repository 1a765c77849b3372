// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace frac::detail {

/// Logarithms of a grid of frequencies, from which real powers of all of them follow at the cost of an exponential.
class PowerGrid {
 public:
  /// omega > 0.  Does nothing where the grid is the last one.
  void prepare(std::span<const double> omega);

  /// ln omega.
  [[nodiscard]] std::span<const double> log_omega() const noexcept { return log_omega_; }

  /// omega^order at points [first, first + result.size()), exact for the orders -1, 0, 1/2, 1 and 2 where real_power()
  /// is, and within (1 + |order|/2) units of the last place elsewhere.
  void powers(double order, std::size_t first, std::span<double> result) const;

 private:
  std::vector<double> omega_;
  std::vector<double> log_omega_;
  std::vector<double> exponent_;  // omega = 2^(exponent + rest), exponent whole, |rest| <= 1/2
  std::vector<double> rest_;
  double largest_exponent_ = 0;
};

}  // namespace frac::detail
