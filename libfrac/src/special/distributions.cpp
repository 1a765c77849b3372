// SPDX-License-Identifier: BSD-3-Clause
#include "special/distributions.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numbers>

namespace frac::detail {

double normal_above(double value) {
  return std::erfc(value / std::numbers::sqrt2) / 2;
}

double student_t_above(double value, double degrees) {
  return cdf(complement(boost::math::students_t(degrees), value));
}

double chi_squared_above(double value, double degrees) {
  return cdf(complement(boost::math::chi_squared(degrees), value));
}

double fisher_f_above(double value, double degrees, double degrees_below) {
  // Two degrees have a closed form.
  if (degrees == 2) return std::exp(-degrees_below / 2 * std::log1p(2 * value / degrees_below));
  return cdf(complement(boost::math::fisher_f(degrees, degrees_below), value));
}

double gamma_above(double value, double shape) {
  return cdf(complement(boost::math::gamma_distribution<>(shape), value));
}

double gamma_below(double value, double shape) {
  return cdf(boost::math::gamma_distribution<>(shape), value);
}

double student_t_quantile(double chance, double degrees) {
  return quantile(boost::math::students_t(degrees), chance);
}

double chi_squared_quantile(double chance, double degrees) {
  return quantile(boost::math::chi_squared(degrees), chance);
}

double fisher_f_quantile(double chance, double degrees, double degrees_below) {
  return quantile(boost::math::fisher_f(degrees, degrees_below), chance);
}

}  // namespace frac::detail
