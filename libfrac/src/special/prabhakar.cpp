// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "base/number_text.hpp"
#include "frac/mittag_leffler.hpp"
#include "mittag_leffler_contour.hpp"
#include "reciprocal_gamma.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using Extended = long double;
using ExtendedComplex = std::complex<Extended>;
constexpr double largest_root = 1000;

// e^s s^-beta (1 - z s^-alpha)^-gamma: on the principal sheet the last power is cut along the segments from 0 to the
// roots of s^alpha = z alone.  Extended precision, because the power multiplies the rounding of what it is taken of by
// gamma |s|/(alpha distance to a root), and because for beta < 0 the path meets values up to Gamma(1 - beta) of which
// the integral may be a small part.
class Integrand {
 public:
  Integrand(double alpha, double beta, double gamma, Complex z) : alpha_(alpha), beta_(beta), gamma_(gamma), z_(z) {}
  ExtendedComplex operator()(ExtendedComplex s) const { return std::exp(logarithm(s)); }
  [[nodiscard]] ExtendedComplex logarithm(ExtendedComplex s) const {
    const ExtendedComplex log_s = std::log(s);
    return s - beta_ * log_s - gamma_ * std::log(Extended{1} - z_ * std::exp(-alpha_ * log_s));
  }

 private:
  Extended alpha_, beta_, gamma_;
  ExtendedComplex z_;
};

// Panels of length 1 with no singularity nearer than 1: 20 Gauss points leave (2 + sqrt(5))^-40 = 1e-25.
template <typename Function>
ExtendedComplex along(const Function& f, ExtendedComplex from, ExtendedComplex to) {
  const Extended panels = std::ceil(std::abs(to - from));
  const ExtendedComplex half = (to - from) / (2 * panels);
  const auto& node = boost::math::quadrature::gauss<Extended, 20>::abscissa();
  const auto& weight = boost::math::quadrature::gauss<Extended, 20>::weights();
  ExtendedComplex sum = 0;
  for (Extended panel = 0; panel < panels; ++panel) {
    const ExtendedComplex middle = from + half * (2 * panel + 1);
    for (std::size_t i = 0; i < node.size(); ++i) {
      sum += weight[i] * (f(middle + half * node[i]) + f(middle - half * node[i]));
    }
  }
  return sum * half;
}

// Re s at which |e^s s^-beta| has fallen to e^-45, below the rounding of a double.
Extended left_end(double beta) {
  constexpr Extended fall = 45;
  Extended distance = fall;
  for (int i = 0; i < 20; ++i) distance = fall + std::max(0.0, -beta) * std::log(distance);
  return -distance;
}

// Right of all roots and of beta, above and below all roots.
struct Rectangle {
  Extended left, right, height;
};

// Largest ln|f| on the upper half of the path, which is where rounding comes from; sampled, since the integrand varies
// over distances of the margin, at least 1.
Extended log_peak(const Integrand& f, const Rectangle& path) {
  Extended peak = f.logarithm({path.right, 0}).real();
  constexpr int samples = 24;
  for (int i = 0; i <= samples; ++i) {
    const Extended share = static_cast<Extended>(i) / samples;
    peak = std::max({peak, f.logarithm({path.right, share * path.height}).real(),
                     f.logarithm({path.right + share * (path.left - path.right), path.height}).real(),
                     f.logarithm({path.right, -share * path.height}).real(),
                     f.logarithm({path.right + share * (path.left - path.right), -path.height}).real()});
  }
  return peak;
}

// From -infinity below to -infinity above, at the distance from the roots and from 0 that makes the integrand least
// there: a larger one tames the power at the roots, up to some gamma, and pays with e^s and, for beta < 0, s^-beta.
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
  const Integrand f(alpha, beta, gamma, z);
  Rectangle path{};
  Extended least = std::numeric_limits<Extended>::infinity();
  const double widest = std::max(1.0, gamma * std::min(1.0, std::abs(z)));
  for (double margin = widest;; margin = std::max(1.0, margin / 1.5)) {
    const Rectangle next{left_end(beta), std::max(right + margin, beta), height + margin};
    const Extended peak = log_peak(f, next);
    if (peak < least) {
      least = peak;
      path = next;
    }
    if (margin <= 1) break;
  }
  const ExtendedComplex top_right(path.right, path.height);
  const ExtendedComplex top_left(path.left, path.height);
  const ExtendedComplex upper = along(f, path.right, top_right) + along(f, top_right, top_left);
  ExtendedComplex integral;
  if (z.imag() == 0) {
    integral = upper - std::conj(upper);
  } else {
    integral = upper + along(f, std::conj(top_left), std::conj(top_right)) + along(f, std::conj(top_right), path.right);
  }
  return Complex(integral / ExtendedComplex(0, 2 * std::numbers::pi_v<Extended>));
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
