// SPDX-License-Identifier: BSD-3-Clause
#include "reciprocal_gamma.hpp"

#include <cmath>

namespace frac::detail {

double reciprocal_gamma(double x) {
  if (x <= 0 && x == std::floor(x)) return 0;
  if (x > 171) return 0;
  // Gamma itself underflows below -170, where its reciprocal is still a number for a while.
  if (x < -160) {
    const double sign = std::fmod(std::floor(x), 2) == 0 ? 1 : -1;
    return sign * std::exp(-std::lgamma(x));
  }
  return 1 / std::tgamma(x);
}

long double reciprocal_gamma(long double x) {
  if (x <= 0 && x == std::floor(x)) return 0;
  return x > 1700 ? 0 : 1 / std::tgamma(x);
}

}  // namespace frac::detail
