// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace frac::detail {

/// Frees values along a record of the correlation of first-order noise, r from sample to sample: of each value the
/// r^d-th part of the one before, d samples earlier, is taken away, and what is left is brought back to the variance it
/// would have had, 1/(1 - r^(2d)).  First-order noise becomes white noise of the same variance.
class FirstOrderWhitening {
 public:
  /// @param index  of the values among the samples, rising
  /// @param r      0 <= r < 1
  FirstOrderWhitening(const std::vector<std::size_t>& index, double r);

  [[nodiscard]] bool changes_nothing() const noexcept { return carried_.empty(); }
  /// @param values  one for each index
  void apply(std::span<double> values) const;

 private:
  std::vector<double> carried_, factor_;  // empty where r is 0
};

}  // namespace frac::detail
