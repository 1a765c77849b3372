// SPDX-License-Identifier: BSD-3-Clause
#include "power_sum.hpp"

#include <algorithm>
#include <utility>

#include "power_algebra.hpp"

namespace frac::detail {
std::vector<PowerTerm> collected(std::vector<PowerTerm> terms) {
  return collected_terms(std::move(terms));
}

std::vector<PowerTerm> merged(const std::vector<PowerTerm>& a, const std::vector<PowerTerm>& b) {
  std::vector<PowerTerm> all = a;
  all.insert(all.end(), b.begin(), b.end());
  return collected_terms(std::move(all));
}

std::vector<PowerTerm> product(const std::vector<PowerTerm>& a, const std::vector<PowerTerm>& b) {
  return product_of_terms(a, b);
}

std::vector<PowerTerm> scaled(std::vector<PowerTerm> terms, double factor, double order) {
  for (PowerTerm& term : terms) {
    term.coefficient *= factor;
    term.order += order;
  }
  return terms;
}

void multiply(std::vector<PowerFactor>& factors, const PowerFactor& by) {
  const auto same =
      std::find_if(factors.begin(), factors.end(), [&](const PowerFactor& each) { return each.sum == by.sum; });
  if (same == factors.end()) {
    factors.push_back(by);
  } else {
    same->power += by.power;
  }
}

std::vector<PowerTerm> expanded(const std::vector<PowerFactor>& factors) {
  std::vector<PowerTerm> result{{1, 0}};
  for (const PowerFactor& factor : factors) {
    for (int i = 0; i < factor.power; ++i) result = product(result, factor.sum);
  }
  return result;
}

PowerProduct scaled(PowerProduct product, double factor, double order) {
  product.terms = scaled(std::move(product.terms), factor, order);
  if (!product.is_factored() || (factor == 1 && order == 0)) return product;
  if (product.factors.front().sum.size() == 1 && product.factors.front().power == 1) {
    product.factors.front().sum = scaled(std::move(product.factors.front().sum), factor, order);
  } else {
    product.factors.insert(product.factors.begin(), {{{factor, order}}, 1});
  }
  return product;
}

PowerProduct product(const PowerProduct& a, const PowerProduct& b) {
  PowerProduct result{{}, product(a.terms, b.terms)};
  if (!a.is_factored() && !b.is_factored()) return result;
  for (const PowerProduct* each : {&a, &b}) {
    each->for_each_sum([&](const std::vector<PowerTerm>& sum, int power) { multiply(result.factors, {sum, power}); });
  }
  return result;
}

}  // namespace frac::detail
