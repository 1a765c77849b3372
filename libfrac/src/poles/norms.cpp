// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "frac/stability.hpp"
#include "frequency_axis.hpp"
#include "laplace_image.hpp"

namespace frac {
namespace {

using detail::LaplaceImage;
using detail::RootCluster;
constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

LaplaceImage image(const FractionalTransferFunction& model) {
  return {detail::numerator_of(model), detail::denominator_of(model)};
}

long double long_log_gain(const LaplaceImage& image, long double u) {
  const auto log_modulus = [&](const detail::PowerProduct& product) {
    long double sum_of_logs = 0;
    product.for_each_sum([&](const std::vector<PowerTerm>& terms, int power) {
      std::complex<long double> sum = 0;
      for (const PowerTerm& term : terms) {
        const long double order = term.order;
        sum += static_cast<long double>(term.coefficient) *
               std::polar(std::exp(order * u), order * (std::numbers::pi_v<long double> / 2));
      }
      sum_of_logs += power * std::log(std::abs(sum));
    });
    return sum_of_logs;
  };
  return log_modulus(image.numerator()) - log_modulus(image.denominator());
}

}  // namespace

PeakGain h_infinity_norm(const FractionalTransferFunction& model) {
  if (analyse_stability(model).stability != Stability::stable)
    return {infinity, std::numeric_limits<double>::quiet_NaN()};
  const LaplaceImage y = image(model);
  const detail::FrequencyAxis axis(y, 0);
  const auto limit = [](double order, const PowerTerm& top, const PowerTerm& bottom) {
    return order == 0 ? std::abs(top.coefficient / bottom.coefficient) : 0.0;
  };
  PeakGain best{limit(detail::order_at_origin(model), model.numerator().back(), model.denominator().back()), 0};
  const double high = limit(detail::order_at_infinity(model), model.numerator().front(), model.denominator().front());
  if (high > best.gain) best = {high, infinity};
  // Up to where |G| is monotone towards its limits.
  constexpr double widest = 690;
  double first = std::min(y.lowest_corner(), 0.0) - 12;
  const detail::AxisLimit low(y, detail::AxisLimit::End::low);
  while (first > -widest && !low.gain_is_monotone(first)) first -= 2;
  double last = y.highest_corner() + 12;
  const detail::AxisLimit end(y, detail::AxisLimit::End::high);
  while (last < widest && !end.gain_is_monotone(last)) last += 2;
  const std::vector<double> points = axis.breakpoints(first, last);
  const auto slope = [&](double u) { return axis.log_slope(u).real(); };
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    if (!(slope(points[i]) > 0 && slope(points[i + 1]) <= 0)) continue;
    const double u = detail::bisected(slope, points[i], points[i + 1]);
    const double gain = std::exp(axis.log_gain(u));
    if (gain > best.gain) best = {gain, std::exp(u)};
  }
  return best;
}

double h2_norm(const FractionalTransferFunction& model) {
  const double origin = 2 * detail::order_at_origin(model) + 1;
  const double far = 2 * detail::order_at_infinity(model) + 1;
  const Stability stability = analyse_stability(model).stability;
  const bool has_stable_poles = stability == Stability::stable || stability == Stability::integrating;
  if (!has_stable_poles || origin <= 0 || far >= 0) return infinity;
  const LaplaceImage y = image(model);
  const detail::FrequencyAxis axis(y, 0);
  // |G|^2 omega falls as omega^origin and omega^far outwards: 1e-17 of it is left beyond the ends.
  const double first = y.lowest_corner() - 3 - 40 / origin;
  const double last = y.highest_corner() + 3 - 40 / far;
  // About a resonance panels grow with the distance from it.  On the narrow ones ln omega is counted from the resonance
  // and the gain taken in long double: a double would be short of 1e-12 at damping ratios below 1e-4.
  struct Corner {
    double at;
    double reference;
    bool is_narrow;
  };
  std::vector<Corner> corners{{first, 0, false}, {last, 0, false}};
  for (const RootCluster& pole : y.poles().clusters) {
    const double width = std::max(1e-12, std::abs(pole.log_s.imag() - pi / 2));
    const double middle = pole.log_s.real();
    if (!(middle > first && middle < last)) continue;
    corners.push_back({middle, middle, width < 0.01});
    for (double offset = width; offset < 2; offset *= 3) {
      for (const double each : {-offset, offset}) {
        if (middle + each > first && middle + each < last) {
          corners.push_back({middle + each, middle, width < 0.01 && offset < 30 * width});
        }
      }
    }
  }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.at < b.at; });
  const auto integral = [](const auto& density, double from, double to) {
    return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(density, from, to, 12, 1e-14);
  };
  double sum = 0;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Corner& a = corners[i];
    const Corner& b = corners[i + 1];
    if (b.at - a.at < 1e-14) continue;
    if (a.is_narrow || b.is_narrow) {
      const double reference = a.is_narrow ? a.reference : b.reference;
      const auto density = [&](double offset) {
        const long double u = static_cast<long double>(reference) + offset;
        return static_cast<double>(std::exp(2 * long_log_gain(y, u) + u));
      };
      sum += integral(density, a.at - reference, b.at - reference);
    } else {
      sum += integral([&](double u) { return std::exp(2 * axis.log_gain(u) + u); }, a.at, b.at);
    }
  }
  return std::sqrt(sum / pi);
}

}  // namespace frac
