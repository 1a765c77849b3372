// SPDX-License-Identifier: BSD-3-Clause
#include "power_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/wide_vectors.hpp"
#include "special/exact_power.hpp"

namespace frac::detail {
namespace {

// 2^(order (exponent + rest)).  An exponent has at most 11 bits, so its products with the upper 41 and the lower 12
// bits of the order are exact, and only order rest and the exponential round.
FRACFIT_INLINE inline void exponentials(double order, const double* exponent, const double* rest, std::size_t count,
                                        double* result) {
  // Adding 3/2 2^52 rounds to a whole number and leaves it in the low bits of the sum.
  constexpr double rounding = 0x1.8p52;
  const auto upper = std::bit_cast<double>(std::bit_cast<std::uint64_t>(order) & ~std::uint64_t{0xfff});
  const double lower = order - upper;
  for (std::size_t i = 0; i < count; ++i) {
    const double large = upper * exponent[i];
    const double small = order * rest[i] + lower * exponent[i];
    const double shifted = (large + small) + rounding;
    const double whole = shifted - rounding;
    const double x = ((large - whole) + small) * std::numbers::ln2;
    // Taylor's series of e^x, |x| <= ln2/2 and a little: the first term left out, x^14/14!, is below 5e-18.
    double sum = 1.0 / 6227020800.0;
    sum = sum * x + 1.0 / 479001600.0;
    sum = sum * x + 1.0 / 39916800.0;
    sum = sum * x + 1.0 / 3628800.0;
    sum = sum * x + 1.0 / 362880.0;
    sum = sum * x + 1.0 / 40320.0;
    sum = sum * x + 1.0 / 5040.0;
    sum = sum * x + 1.0 / 720.0;
    sum = sum * x + 1.0 / 120.0;
    sum = sum * x + 1.0 / 24.0;
    sum = sum * x + 1.0 / 6.0;
    sum = sum * x + 0.5;
    sum = sum * x + 1.0;
    const auto scale = (std::bit_cast<std::uint64_t>(shifted) + 1023) << 52;
    result[i] = (1.0 + x * sum) * std::bit_cast<double>(scale);
  }
}

}  // namespace

void PowerGrid::prepare(std::span<const double> omega) {
  if (std::equal(omega.begin(), omega.end(), omega_.begin(), omega_.end())) return;
  omega_.assign(omega.begin(), omega.end());
  log_omega_.resize(omega.size());
  exponent_.resize(omega.size());
  rest_.resize(omega.size());
  largest_exponent_ = 0;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    log_omega_[i] = std::log(omega[i]);
    int exponent = 0;
    double mantissa = std::frexp(omega[i], &exponent);  // in [1/2, 1)
    if (mantissa < std::numbers::sqrt2 / 2) {
      mantissa *= 2;
      --exponent;
    }
    exponent_[i] = exponent;
    rest_[i] = std::log2(mantissa);
    largest_exponent_ = std::max(largest_exponent_, std::abs(exponent_[i]) + 1);
  }
}

void PowerGrid::powers(double order, std::size_t first, std::span<double> result) const {
  const bool special = order == 0 || order == 0.5 || std::abs(order) == 1 || order == 2;
  // Beyond 2^1000 the scale has no normal double.
  if (special || !(std::abs(order) * largest_exponent_ < 1000)) {
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = real_power(omega_[first + i], order);
    return;
  }
  with_wide_vectors([&]() FRACFIT_INLINE {
    exponentials(order, exponent_.data() + first, rest_.data() + first, result.size(), result.data());
  });
}

}  // namespace frac::detail
