// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "frac/power_term.hpp"

// Sums of powers of s, whatever their coefficients are: numbers, numbers with their derivatives, or forms in
// parameters. A term has a member `order` and, found with it, three functions:
//   void add_to(Term& sum, const Term& term)      adds a term of equal order,
//   Term times(const Term& a, const Term& b)      the product, orders included,
//   bool is_nothing(const Term& term)             contributes nothing.
namespace frac::detail {

/// Orders that differ by rounding alone, as 0.1 + 0.2 and 0.3 do, are one order.
constexpr double order_tolerance = 1e-13;
constexpr std::size_t most_terms = 10'000;
/// Powers of sums are multiplied out up to this one.
constexpr double largest_expanded_power = 100;

/// a + b, and 0 where they cancel to rounding, as 0.1 + 0.2 and -0.3 do.
[[nodiscard]] inline double sum_or_nothing(double a, double b) {
  const double sum = a + b;
  constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
  return std::abs(sum) <= rounding * (std::abs(a) + std::abs(b)) ? 0 : sum;
}

inline void add_to(PowerTerm& sum, const PowerTerm& term) {
  sum.coefficient = sum_or_nothing(sum.coefficient, term.coefficient);
}
[[nodiscard]] inline PowerTerm times(const PowerTerm& a, const PowerTerm& b) {
  return {a.coefficient * b.coefficient, a.order + b.order};
}
[[nodiscard]] inline bool is_nothing(const PowerTerm& term) {
  return term.coefficient == 0;
}

/// By falling order, terms of equal order as one, those that contribute nothing dropped.
template <typename Term>
[[nodiscard]] std::vector<Term> collected_terms(std::vector<Term> terms) {
  std::stable_sort(terms.begin(), terms.end(), [](const Term& a, const Term& b) { return a.order > b.order; });
  std::vector<Term> result;
  for (Term& term : terms) {
    const bool is_new = result.empty() || result.back().order - term.order >
                                              order_tolerance * std::max(1.0, std::abs(result.back().order));
    if (is_new) {
      result.push_back(std::move(term));
    } else {
      add_to(result.back(), term);
    }
  }
  std::erase_if(result, [](const Term& term) { return is_nothing(term); });
  return result;
}

/// @throws std::invalid_argument  the product has too many terms to be of use.
template <typename Term>
[[nodiscard]] std::vector<Term> product_of_terms(const std::vector<Term>& a, const std::vector<Term>& b) {
  if (a.size() * b.size() > most_terms) {
    throw std::invalid_argument("expanding it makes more than " + std::to_string(most_terms) + " terms");
  }
  std::vector<Term> terms;
  terms.reserve(a.size() * b.size());
  for (const Term& x : a) {
    for (const Term& y : b) terms.push_back(times(x, y));
  }
  return collected_terms(std::move(terms));
}

}  // namespace frac::detail
