// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/power_term.hpp"

namespace frac::detail {

/// Terms by falling order, equal orders added up, those that cancel to rounding dropped.
[[nodiscard]] std::vector<PowerTerm> collected(std::vector<PowerTerm> terms);

/// Sum of two sums.
[[nodiscard]] std::vector<PowerTerm> merged(const std::vector<PowerTerm>& a, const std::vector<PowerTerm>& b);

/// @throws std::invalid_argument  the product has too many terms to be of use.
[[nodiscard]] std::vector<PowerTerm> product(const std::vector<PowerTerm>& a, const std::vector<PowerTerm>& b);

/// Each term times factor s^order.
[[nodiscard]] std::vector<PowerTerm> scaled(std::vector<PowerTerm> terms, double factor, double order);

/// Multiplies a list of factors by another one; equal sums become one factor.
void multiply(std::vector<PowerFactor>& factors, const PowerFactor& by);
[[nodiscard]] std::vector<PowerTerm> expanded(const std::vector<PowerFactor>& factors);

/// A product of powers of sums with its expansion.
struct PowerProduct {
  std::vector<PowerFactor> factors;  // empty where only the expansion is known
  std::vector<PowerTerm> terms;

  [[nodiscard]] bool is_factored() const noexcept { return !factors.empty(); }
  /// Terms of highest and lowest order.
  [[nodiscard]] const PowerTerm& front() const { return terms.front(); }
  [[nodiscard]] const PowerTerm& back() const { return terms.back(); }
  /// The sums whose product it is, each as often as its power says: all the terms that decide where one dominates.
  template <typename Visit>
  void for_each_sum(const Visit& visit) const {
    if (!is_factored()) visit(terms, 1);
    for (const PowerFactor& factor : factors) visit(factor.sum, factor.power);
  }
};
[[nodiscard]] PowerProduct scaled(PowerProduct product, double factor, double order);
/// Keeps the factors where one of the two has some.
[[nodiscard]] PowerProduct product(const PowerProduct& a, const PowerProduct& b);

}  // namespace frac::detail
