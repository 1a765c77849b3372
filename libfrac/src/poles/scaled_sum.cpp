// SPDX-License-Identifier: BSD-3-Clause
#include "scaled_sum.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

#include "frac/cancellation.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

// |c e^{q zeta}| over e^scale.
double modulus_of(const PowerTerm& term, Complex zeta, double scale) {
  return std::abs(term.coefficient) * std::exp(term.order * zeta.real() - scale);
}
// The term itself, turned by its angle and sign.
// @param modulus  by modulus_of()
Complex part_of(const PowerTerm& term, Complex zeta, double modulus) {
  const double angle = term.order * zeta.imag();
  const double signed_modulus = term.coefficient < 0 ? -modulus : modulus;
  if (angle == 0) return signed_modulus;
  return {signed_modulus * std::cos(angle), signed_modulus * std::sin(angle)};
}

// e^x less the first `order` terms of its series.
Complex exponential_rest(Complex x, int order) {
  Complex term = 1;
  Complex start = 0;
  for (int j = 0; j < order; ++j) {
    start += term;
    term *= x / static_cast<double>(j + 1);
  }
  if (std::abs(x) > order + 2) return std::exp(x) - start;
  Complex rest = 0;
  for (int j = order; j < order + 60; ++j) {
    rest += term;
    if (std::abs(term) <= 1e-18 * std::abs(rest)) break;
    term *= x / static_cast<double>(j + 1);
  }
  return rest;
}

}  // namespace

namespace {

/// @param log_size  of a term's coefficient, from its place among the terms
template <typename LogSize>
ScaledSum sum_of(const std::vector<PowerTerm>& terms, Complex zeta, const LogSize& log_size) {
  // Every search for roots comes through here.
  throw_if_cancelled();
  double scale = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    scale = std::max(scale, log_size(i) + terms[i].order * zeta.real());
  }
  ScaledSum sum{0, 0, scale, 0};
  for (const PowerTerm& term : terms) {
    const double modulus = modulus_of(term, zeta, scale);
    const Complex value = part_of(term, zeta, modulus);
    sum.value += value;
    sum.slope += term.order * value;
    sum.magnitude += modulus;
  }
  return sum;
}

}  // namespace

ScaledSum scaled_sum(const std::vector<PowerTerm>& terms, Complex zeta) {
  return sum_of(terms, zeta, [&](std::size_t i) { return std::log(std::abs(terms[i].coefficient)); });
}

ScaledSum scaled_sum(const std::vector<PowerTerm>& terms, const std::vector<double>& log_size, Complex zeta) {
  return sum_of(terms, zeta, [&](std::size_t i) { return log_size[i]; });
}

ScaledSum scaled_sum(const PowerProduct& product, Complex zeta) {
  if (!product.is_factored()) return scaled_sum(product.terms, zeta);
  ScaledSum whole{1, 0, 0, 0};
  for (const PowerFactor& factor : product.factors) {
    const ScaledSum sum = scaled_sum(factor.sum, zeta);
    const double size = std::abs(sum.value);
    for (int i = 0; i < factor.power; ++i) {
      whole.slope = whole.slope * sum.value + whole.value * sum.slope;
      whole.magnitude = whole.magnitude * size + std::abs(whole.value) * sum.magnitude;
      whole.value *= sum.value;
      whole.scale += sum.scale;
    }
  }
  return whole;
}

TaylorStart taylor_start(const std::vector<PowerTerm>& terms, Complex zeta, int count) {
  const double scale = scaled_sum(terms, zeta).scale;
  TaylorStart start{std::vector<Complex>(static_cast<std::size_t>(count), 0.0),
                    std::vector<double>(static_cast<std::size_t>(count), 0.0)};
  for (const PowerTerm& term : terms) {
    const Complex value = part_of(term, zeta, modulus_of(term, zeta, scale));
    double factor = 1;  // order^j/j!
    for (std::size_t j = 0; j < start.coefficient.size(); factor *= term.order / static_cast<double>(++j)) {
      start.coefficient[j] += factor * value;
      start.rounding[j] += std::abs(factor * value) * (4 + std::abs(term.order * zeta));
    }
  }
  return start;
}

DeflatedSum deflated_sum(const std::vector<PowerTerm>& terms, Complex zeta, Complex offset, int order) {
  const double scale = scaled_sum(terms, zeta).scale;
  DeflatedSum sum{0, 0};
  for (const PowerTerm& term : terms) {
    const Complex part =
        part_of(term, zeta, modulus_of(term, zeta, scale)) * exponential_rest(term.order * offset, order);
    sum.value += part;
    sum.magnitude += std::abs(part);
  }
  return sum;
}

}  // namespace frac::detail
