// SPDX-License-Identifier: BSD-3-Clause
#include "power_sum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace frac::detail {
namespace {

// Orders that differ by rounding alone, as 0.1 + 0.2 and 0.3 do, are one order.
constexpr double order_tolerance = 1e-13;
constexpr std::size_t most_terms = 10'000;

}  // namespace

std::vector<PowerTerm> collected(std::vector<PowerTerm> terms) {
  std::stable_sort(terms.begin(), terms.end(),
                   [](const PowerTerm& a, const PowerTerm& b) { return a.order > b.order; });
  std::vector<PowerTerm> result;
  for (const PowerTerm& term : terms) {
    if (!result.empty() &&
        result.back().order - term.order <= order_tolerance * std::max(1.0, std::abs(result.back().order))) {
      result.back().coefficient += term.coefficient;
    } else {
      result.push_back(term);
    }
  }
  std::erase_if(result, [](const PowerTerm& term) { return term.coefficient == 0; });
  return result;
}

std::vector<PowerTerm> merged(const std::vector<PowerTerm>& a, const std::vector<PowerTerm>& b) {
  std::vector<PowerTerm> all = a;
  all.insert(all.end(), b.begin(), b.end());
  std::vector<PowerTerm> sizes = all;
  for (PowerTerm& term : sizes) term.coefficient = std::abs(term.coefficient);
  std::vector<PowerTerm> sum = collected(std::move(all));
  const std::vector<PowerTerm> size = collected(std::move(sizes));
  std::erase_if(sum, [&](const PowerTerm& term) {
    const auto own = std::find_if(size.begin(), size.end(), [&](const PowerTerm& each) {
      return std::abs(each.order - term.order) <= 1e-12 * std::max(1.0, std::abs(term.order));
    });
    return own != size.end() &&
           std::abs(term.coefficient) <= 4 * std::numeric_limits<double>::epsilon() * own->coefficient;
  });
  return sum;
}

std::vector<PowerTerm> product(const std::vector<PowerTerm>& a, const std::vector<PowerTerm>& b) {
  if (a.size() * b.size() > most_terms) {
    throw std::invalid_argument("expanding it makes more than " + std::to_string(most_terms) + " terms");
  }
  std::vector<PowerTerm> terms;
  terms.reserve(a.size() * b.size());
  for (const PowerTerm& x : a) {
    for (const PowerTerm& y : b) terms.push_back({x.coefficient * y.coefficient, x.order + y.order});
  }
  return collected(std::move(terms));
}

std::vector<PowerTerm> scaled(std::vector<PowerTerm> terms, double factor, double order) {
  for (PowerTerm& term : terms) {
    term.coefficient *= factor;
    term.order += order;
  }
  return terms;
}

}  // namespace frac::detail
