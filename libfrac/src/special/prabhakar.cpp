// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "frac/mittag_leffler.hpp"
#include "mittag_leffler_contour.hpp"
#include "reciprocal_gamma.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
constexpr double largest_root = 1000;

// e^s s^-beta (1 - z s^-alpha)^-gamma: on the principal sheet the last power is cut along the segments from 0 to the
// roots of s^alpha = z alone.
class Integrand {
 public:
  Integrand(double alpha, double beta, double gamma, Complex z) : alpha_(alpha), beta_(beta), gamma_(gamma), z_(z) {}
  Complex operator()(Complex s) const {
    const Complex log_s = std::log(s);
    return std::exp(s - beta_ * log_s - gamma_ * std::log(1.0 - z_ * std::exp(-alpha_ * log_s)));
  }

 private:
  double alpha_, beta_, gamma_;
  Complex z_;
};

// Panels of length 1 with no singularity nearer than 1: 20 Gauss points leave (2 + sqrt(5))^-40 = 1e-25.
template <typename Function>
Complex along(const Function& f, Complex from, Complex to) {
  const double panels = std::ceil(std::abs(to - from));
  const Complex half = (to - from) / (2 * panels);
  const auto& node = boost::math::quadrature::gauss<double, 20>::abscissa();
  const auto& weight = boost::math::quadrature::gauss<double, 20>::weights();
  Complex sum = 0;
  for (double panel = 0; panel < panels; ++panel) {
    const Complex middle = from + half * (2 * panel + 1);
    for (std::size_t i = 0; i < node.size(); ++i) {
      sum += weight[i] * (f(middle + half * node[i]) + f(middle - half * node[i]));
    }
  }
  return sum * half;
}

// From -infinity below to -infinity above, right of all roots.  Distance gamma from them and from 0 balances e^s
// against the growth of the power, as for 1/Gamma.
Complex contour_integral(double alpha, double beta, double gamma, Complex z) {
  double right = 0;
  double height = 0;
  const auto poles = detail::MittagLefflerContour::poles(alpha, z);
  if (poles.count > 0 && poles.radius > largest_root) {
    throw std::invalid_argument("prabhakar: the root |z|^(1/alpha) = " + detail::number_text(poles.radius) +
                                " on the principal sheet; allowed is up to 1000");
  }
  for (std::size_t j = 0; j < poles.count; ++j) {
    right = std::max(right, poles.radius * std::cos(poles.argument[j]));
    height = std::max(height, std::abs(poles.radius * std::sin(poles.argument[j])));
  }
  const double margin = std::max(1.0, gamma * std::min(1.0, std::abs(z)));
  right = std::max(right + margin, beta);
  height += margin;
  const double left = -45;  // e^-45 is below the rounding
  const Integrand f(alpha, beta, gamma, z);
  const Complex upper = along(f, {right, 0}, {right, height}) + along(f, {right, height}, {left, height});
  Complex integral;
  if (z.imag() == 0) {
    integral = upper - std::conj(upper);
  } else {
    integral = upper + along(f, {left, -height}, {right, -height}) + along(f, {right, -height}, {right, 0});
  }
  return integral / Complex(0, 2 * std::numbers::pi);
}

Complex series(double alpha, double beta, double gamma, Complex z) {
  Complex sum = detail::reciprocal_gamma(beta);
  Complex power = 1;
  for (int k = 1; k < 200; ++k) {
    power *= z * ((gamma + k - 1) / k);
    const Complex term = power * detail::reciprocal_gamma(alpha * k + beta);
    sum += term;
    if (alpha * k + beta > 2 && std::abs(term) <= 1e-18 * std::abs(sum)) break;
  }
  return sum;
}

}  // namespace

Complex prabhakar(double alpha, double beta, double gamma, Complex z) {
  if (!(alpha > 0 && alpha <= 2)) {
    throw std::invalid_argument("prabhakar: alpha = " + detail::number_text(alpha) + "; allowed is above 0 to 2");
  }
  if (!(std::abs(beta) <= 48)) {
    throw std::invalid_argument("prabhakar: beta = " + detail::number_text(beta) + "; allowed is -48 to 48");
  }
  if (!(gamma > 0 && gamma <= 100)) {
    throw std::invalid_argument("prabhakar: gamma = " + detail::number_text(gamma) + "; allowed is above 0 to 100");
  }
  if (!std::isfinite(z.real()) || !std::isfinite(z.imag())) {
    throw std::invalid_argument("prabhakar: z = " + detail::number_text(z.real()) + " + " +
                                detail::number_text(z.imag()) + " i is not finite");
  }
  if (gamma == 1) return mittag_leffler(alpha, beta, z);
  if (gamma == 2) return mittag_leffler_derivative(alpha, beta - alpha, z);
  if (std::abs(z) * gamma <= 0.01) return series(alpha, beta, gamma, z);
  const Complex value = contour_integral(alpha, beta, gamma, z);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {std::isnan(value.real()) ? infinity : value.real(), std::isnan(value.imag()) ? infinity : value.imag()};
}

double prabhakar(double alpha, double beta, double gamma, double z) {
  return prabhakar(alpha, beta, gamma, Complex(z)).real();
}

}  // namespace frac
