#include "power_sum.hpp"

#include <algorithm>
#include <cmath>
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
