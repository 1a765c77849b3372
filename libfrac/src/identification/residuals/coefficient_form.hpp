// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "frac/structure.hpp"

namespace frac::detail {

/// factor * product of parameters to the given powers * s^order.
struct Monomial {
  double factor;
  std::vector<double> powers;  // one per parameter of the structure; 0 for orders and delays
  double order;
};

/// One power of s: its coefficient is the sum of the monomials, all of the same order.
struct CoefficientTerm {
  double order;
  std::vector<Monomial> monomials;

  [[nodiscard]] bool is_constant() const;
  /// The coefficient at given parameter values.
  [[nodiscard]] double value(std::span<const double> parameters) const;
  /// Its derivative by ln|parameter|.
  [[nodiscard]] double by_log(std::span<const double> parameters, std::size_t parameter) const;
};

/// exp(-delay s) sum of numerator terms / sum of denominator terms.
struct CoefficientForm {
  std::vector<CoefficientTerm> numerator, denominator;
  double delay;  // s
};

/// The structure as a ratio of sums of powers whose coefficients are written in its parameters.  Orders and delays are
/// numbers, taken from `parameters`; its other entries are not used.  Empty where the structure is no such ratio.
[[nodiscard]] std::optional<CoefficientForm> coefficient_form(const Structure& structure,
                                                              std::span<const double> parameters);

}  // namespace frac::detail
