// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace frac::detail {

/// Product of two polynomials, coefficients by rising power.
template <typename Number>
[[nodiscard]] std::vector<Number> polynomial_product(const std::vector<Number>& a, const std::vector<Number>& b) {
  std::vector<Number> product(a.size() + b.size() - 1, Number(0));
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) product[i + k] += a[i] * b[k];
  }
  return product;
}

}  // namespace frac::detail
