// SPDX-License-Identifier: BSD-3-Clause
#include "frac/laplace_value.hpp"

#include <limits>

#include "laplace_image.hpp"

namespace frac {

std::complex<double> laplace_value(const FractionalTransferFunction& model, std::complex<double> s) {
  if (s == 0.0) {
    const double order = detail::order_at_origin(model);
    if (order > 0) return 0;
    const double ratio = model.numerator().back().coefficient / model.denominator().back().coefficient;
    return order < 0 ? ratio * std::numeric_limits<double>::infinity() : ratio;
  }
  const std::complex<double> zeta = std::log(s);
  const detail::ScaledSum numerator = detail::scaled_sum(detail::numerator_of(model), zeta);
  const detail::ScaledSum denominator = detail::scaled_sum(detail::denominator_of(model), zeta);
  return numerator.value / denominator.value * std::exp(numerator.scale - denominator.scale - model.delay() * s);
}

}  // namespace frac
