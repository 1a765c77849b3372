// SPDX-License-Identifier: BSD-3-Clause
#include "frac/mittag_leffler.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "frac/cancellation.hpp"
#include "mittag_leffler_contour.hpp"
#include "mittag_leffler_long.hpp"
#include "reciprocal_gamma.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using detail::MittagLefflerContour;
using ValueAndDerivative = MittagLefflerContour::ValueAndDerivative;
constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

void check_orders(double alpha, double beta, const char* function) {
  if (!(alpha > 0 && alpha <= 100)) {
    throw std::invalid_argument(std::string(function) + ": alpha = " + detail::number_text(alpha) +
                                "; allowed is above 0 to 100");
  }
  if (!(std::abs(beta) <= 50)) {
    throw std::invalid_argument(std::string(function) + ": beta = " + detail::number_text(beta) +
                                "; allowed is -50 to 50");
  }
}

void check_argument(Complex z, const std::string& name, const char* function) {
  if (!std::isfinite(z.real()) || !std::isfinite(z.imag())) {
    throw std::invalid_argument(std::string(function) + ": " + name + " = " + detail::number_text(z.real()) +
                                (z.imag() == 0 ? "" : " + " + detail::number_text(z.imag()) + " i") + " is not finite");
  }
}

// Orders rarely change from one call to the next, and the nodes cost more than a value; two orders take turns where
// beta is a pole of Gamma.
const MittagLefflerContour& contour(double alpha, double beta, double offset) {
  thread_local std::array<std::optional<MittagLefflerContour>, 4> latest;
  thread_local std::size_t oldest = 0;
  for (const std::optional<MittagLefflerContour>& each : latest) {
    if (each && each->is(alpha, beta, offset)) return *each;
  }
  oldest = (oldest + 1) % latest.size();
  return latest[oldest].emplace(alpha, beta, offset);
}

const MittagLefflerContour& contour(double alpha, double beta) {
  return contour(alpha, beta, 0.5);
}

const MittagLefflerContour& contour(double alpha, double beta, const MittagLefflerContour::Poles& poles) {
  const MittagLefflerContour& usual = contour(alpha, beta);
  return usual.has_pole_at_node(poles) ? contour(alpha, beta, 0) : usual;
}

// An infinity whose sign was lost by inf - inf; no other NaN can arise from finite arguments.
Complex overflowed(Complex value) {
  return {std::isnan(value.real()) ? infinity : value.real(), std::isnan(value.imag()) ? infinity : value.imag()};
}

// sum z^k/Gamma(alpha k + beta) and its derivative, where the terms fall from the start or cancel little.
ValueAndDerivative series(double alpha, double beta, Complex z) {
  Complex value = detail::reciprocal_gamma(beta);
  Complex slope = 0;
  Complex power = 1;  // z^(k-1)
  for (int k = 1; k < 1000; ++k) {
    // Far below zero the rounding of the sum would outweigh that of the value.
    const double coefficient =
        beta < -1 ? static_cast<double>(detail::reciprocal_gamma(static_cast<long double>(alpha) * k + beta))
                  : detail::reciprocal_gamma(alpha * k + beta);
    const Complex slope_term = power * (k * coefficient);
    power *= z;
    const Complex term = power * coefficient;
    value += term;
    slope += slope_term;
    if (alpha * k + beta > 2 && std::abs(term) <= 1e-18 * std::abs(value) &&
        std::abs(slope_term) <= 1e-18 * std::abs(slope)) {
      break;
    }
  }
  return {value, slope};
}

// Residues and four terms of the expansion in 1/z: |z| > 1e8 makes the fifth smaller than the rounding of the first
// that is not zero.
ValueAndDerivative far_out(double alpha, double beta, Complex z) {
  Complex value = 0;
  Complex slope = 0;
  const Complex inverse = 1.0 / z;
  Complex power = 1;
  for (int k = 1; k <= 4; ++k) {
    power *= inverse;
    const double coefficient = detail::reciprocal_gamma(beta - alpha * k);
    value -= power * coefficient;
    slope += power * inverse * (k * coefficient);
  }
  const double theta = std::arg(z);
  const double log_radius = std::log(std::abs(z)) / alpha;
  for (double j = std::ceil((-pi * alpha - theta) / (2 * pi));; ++j) {
    const double argument = (theta + 2 * pi * j) / alpha;
    if (argument > pi) break;
    if (argument <= -pi) continue;
    const double radius = std::exp(log_radius);
    // On the imaginary axis of s to within rounding the growth is lost in the argument all the same.
    const double growth = radius * std::cos(argument) + (1 - beta) * log_radius;
    if (!(growth > -745)) continue;
    if (!(growth < 745) || !std::isfinite(radius)) {
      const double angle = std::isfinite(radius) ? radius * std::sin(argument) + (1 - beta) * argument : 0;
      const double re = std::cos(angle) < 0 ? -infinity : infinity;
      const double im = argument == 0 ? 0 : (std::sin(angle) < 0 ? -infinity : infinity);
      return {{re, im}, {re, im}};
    }
    const Complex residue = std::polar(std::exp(growth) / alpha, radius * std::sin(argument) + (1 - beta) * argument);
    const Complex s = std::polar(radius, argument);
    value += residue;
    slope += residue * (s + 1.0 - beta) * inverse / alpha;
  }
  if (z.imag() == 0) return {value.real(), slope.real()};
  return {value, slope};
}

// (e^z - 1)/z, its real and imaginary part without cancellation.
Complex relative_exponential(Complex z) {
  const double half_sine = std::sin(z.imag() / 2);
  const double re = std::expm1(z.real()) * std::cos(z.imag()) - 2 * half_sine * half_sine;
  const double im = z.imag() == 0 ? 0 : std::exp(z.real()) * std::sin(z.imag());
  return Complex(re, im) / z;
}

std::optional<Complex> elementary(double alpha, double beta, Complex z) {
  if (alpha == 1 && beta == 1) return z.imag() == 0 ? Complex(std::exp(z.real())) : std::exp(z);
  if (alpha == 1 && beta == 2) return relative_exponential(z);
  if (alpha != 2 || (beta != 1 && beta != 2 && beta != 3)) return std::nullopt;
  if (z.imag() == 0) {
    const bool turns = z.real() < 0;
    const double root = std::sqrt(std::abs(z.real()));
    if (beta == 1) return turns ? std::cos(root) : std::cosh(root);
    if (beta == 2) return (turns ? std::sin(root) : std::sinh(root)) / root;
    const double half = turns ? std::sin(root / 2) : std::sinh(root / 2);
    return half / root * (half / root) * 2.0;
  }
  const Complex root = std::sqrt(z);
  if (beta == 1) return std::cosh(root);
  if (beta == 2) return std::sinh(root) / root;
  const Complex half = std::sinh(root / 2.0) / root;
  return 2.0 * half * half;
}

// Beyond alpha = 2: E_{alpha,beta}(z) = (1/m) sum over the m-th roots of z of E_{alpha/m,beta}(root).
template <typename Evaluate>
ValueAndDerivative over_roots(double alpha, double beta, Complex z, const Evaluate& evaluate) {
  const double m = std::ceil(alpha / 2);
  const double radius = std::pow(std::abs(z), 1 / m);
  ValueAndDerivative sum{0, 0};
  for (double j = 0; j < m; ++j) {
    const Complex root = std::polar(radius, (std::arg(z) + 2 * pi * j) / m);
    const ValueAndDerivative part = evaluate(alpha / m, beta, root);
    sum.value += part.value / m;
    sum.derivative += part.derivative * (root / (m * z)) / m;
  }
  if (z.imag() == 0) return {sum.value.real(), sum.derivative.real()};
  return sum;
}

// Near 0 the series needs few terms; above alpha = 2 they fall fast enough to serve until |z|^(1/alpha) = 3, where the
// largest is e^3 at most.
bool series_serves(double alpha, Complex z) {
  return std::abs(z) <= (alpha > 2 ? std::pow(3.0, alpha) : 0.01);
}

constexpr double far_radius = 1e8;
// Below it the weights of the contour, as large as Gamma(-beta), may outgrow the result.
constexpr double lowest_beta_of_contour = -1;

bool is_pole_of_gamma(double x) {
  return x <= 0 && x == std::floor(x);
}

double negative_value(const MittagLefflerContour& rule, double z) {
  double result = 0;
  rule.negative_values({&z, 1}, &result);
  return result;
}

bool has_fixed_rational(double alpha, double beta, double z) {
  return alpha < 1 && z < -0.01 && z >= -far_radius && beta >= lowest_beta_of_contour && !is_pole_of_gamma(beta);
}

ValueAndDerivative long_value(double alpha, double beta, Complex z) {
  thread_local std::optional<detail::LongMittagLeffler> latest;
  if (!latest || !latest->is(alpha, beta)) latest.emplace(alpha, beta);
  const auto [value, derivative] = (*latest)(z);
  return {value, derivative};
}

Complex value(double alpha, double beta, Complex z) {
  if (z == 0.0) return detail::reciprocal_gamma(beta);
  if (alpha > 2 && !series_serves(alpha, z)) {
    return over_roots(alpha, beta, z,
                      [](double a, double b, Complex root) {
                        return ValueAndDerivative{value(a, b, root), 0};
                      })
        .value;
  }
  if (const auto exact = elementary(alpha, beta, z)) return *exact;
  if (beta < lowest_beta_of_contour) return long_value(alpha, beta, z).value;
  if (series_serves(alpha, z)) return series(alpha, beta, z).value;
  if (std::abs(z) > far_radius) return far_out(alpha, beta, z).value;
  // 1/Gamma(beta) = 0 leaves a function that vanishes with z, which the rule would only meet to absolute accuracy.
  if (is_pole_of_gamma(beta) && std::abs(z) < 1) return z * value(alpha, beta + alpha, z);
  const auto poles = MittagLefflerContour::poles(alpha, z);
  return contour(alpha, beta, poles).value(z, poles);
}

ValueAndDerivative value_and_derivative(double alpha, double beta, Complex z) {
  if (z == 0.0) return series(alpha, beta, z);
  if (alpha <= 2 && beta < lowest_beta_of_contour) return long_value(alpha, beta, z);
  if (series_serves(alpha, z)) return series(alpha, beta, z);
  if (alpha == 1 && beta == 1) {
    const Complex exponential = value(1, 1, z);
    return {exponential, exponential};
  }
  if (alpha > 2) return over_roots(alpha, beta, z, value_and_derivative);
  if (std::abs(z) > far_radius) return far_out(alpha, beta, z);
  const auto poles = MittagLefflerContour::poles(alpha, z);
  return contour(alpha, beta, poles).value_and_derivative(z, poles);
}

}  // namespace

double mittag_leffler(double alpha, double beta, double z) {
  check_orders(alpha, beta, "mittag_leffler");
  check_argument(z, "z", "mittag_leffler");
  if (has_fixed_rational(alpha, beta, z)) return negative_value(contour(alpha, beta), z);
  return overflowed(value(alpha, beta, z)).real();
}

Complex mittag_leffler(double alpha, double beta, Complex z) {
  if (z.imag() == 0) return mittag_leffler(alpha, beta, z.real());
  check_orders(alpha, beta, "mittag_leffler");
  check_argument(z, "z", "mittag_leffler");
  return overflowed(value(alpha, beta, z));
}

void mittag_leffler(double alpha, double beta, std::span<const double> z, std::span<double> value) {
  check_orders(alpha, beta, "mittag_leffler");
  if (z.size() != value.size()) {
    throw std::invalid_argument("mittag_leffler: " + std::to_string(z.size()) + " arguments but room for " +
                                std::to_string(value.size()) + " values");
  }
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (!std::isfinite(z[i])) check_argument(z[i], "z[" + std::to_string(i) + "]", "mittag_leffler");
  }
  constexpr std::size_t longest_run = 65'536;  // a millisecond or two
  for (std::size_t i = 0; i < z.size();) {
    throw_if_cancelled();
    std::size_t end = i;
    while (end < z.size() && end - i < longest_run && has_fixed_rational(alpha, beta, z[end])) ++end;
    if (end > i) {
      contour(alpha, beta).negative_values(z.subspan(i, end - i), &value[i]);
      i = end;
    } else {
      value[i] = mittag_leffler(alpha, beta, z[i]);
      ++i;
    }
  }
}

std::vector<double> mittag_leffler(double alpha, double beta, std::span<const double> z) {
  std::vector<double> value(z.size());
  mittag_leffler(alpha, beta, z, value);
  return value;
}

std::vector<Complex> mittag_leffler(double alpha, double beta, std::span<const Complex> z) {
  check_orders(alpha, beta, "mittag_leffler");
  std::vector<Complex> value;
  value.reserve(z.size());
  for (std::size_t i = 0; i < z.size(); ++i) {
    throw_if_cancelled();
    check_argument(z[i], "z[" + std::to_string(i) + "]", "mittag_leffler");
    value.push_back(mittag_leffler(alpha, beta, z[i]));
  }
  return value;
}

double mittag_leffler_derivative(double alpha, double beta, double z) {
  return mittag_leffler_derivative(alpha, beta, Complex(z)).real();
}

Complex mittag_leffler_derivative(double alpha, double beta, Complex z) {
  check_orders(alpha, beta, "mittag_leffler_derivative");
  check_argument(z, "z", "mittag_leffler_derivative");
  return overflowed(value_and_derivative(alpha, beta, z).derivative);
}

}  // namespace frac
