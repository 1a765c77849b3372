// SPDX-License-Identifier: BSD-3-Clause
#include "mittag_leffler_contour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/wide_vectors.hpp"
#include "reciprocal_gamma.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

// e^-40 is a fiftieth of the rounding unit: the three errors of the rule, from the branch point, from the growth of
// e^{w^2} on the right and from leaving out the tail, are held there relative to the scale of the result.
constexpr double accuracy = 40;
// A line nearer to the origin keeps e^{c^2} and with it the rounding small, at the price of nodes: e^{2.6} and 26.
constexpr double usual_line = 1.6;
// Towards alpha = 1 the values at z < 0 fade with 1 - alpha and the weights do not.
constexpr double line_near_one = 0.8;

// The product without the check for NaN that the standard's operator carries.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// a e^x with an overflow that stays infinite and a zero that stays zero.
Complex scaled_exp(Complex x, Complex a) {
  const double magnitude = std::exp(x.real());
  const double re = a.real() * std::cos(x.imag()) - a.imag() * std::sin(x.imag());
  const double im = a.real() * std::sin(x.imag()) + a.imag() * std::cos(x.imag());
  return {re == 0 ? 0 : re * magnitude, im == 0 ? 0 : im * magnitude};
}

}  // namespace

MittagLefflerContour::MittagLefflerContour(double alpha, double beta, double offset)
    : alpha_(alpha),
      beta_(beta),
      offset_(offset),
      power_(2 * (alpha - beta) + 1),
      leading_(reciprocal_gamma(beta - alpha)) {
  choose_line();
  place_nodes();
}

// The integrand is e^{w^2} w^-p on the way to the branch point.  Stopping the shifted line at w = p h/(2 pi) bounds
// that error by exp(p (1 + ln(2 pi/(h p))) - 2 pi c/h); shifting it right to the stationary point bounds the other.
// Both are to be small against the integrand at its saddle sqrt(p/2), which is the scale of 1/Gamma.
void MittagLefflerContour::choose_line() {
  const double p = -power_;
  line_ = alpha_ > 0.95 && alpha_ < 1 ? line_near_one : usual_line;
  double scale = 0;
  if (p > 2) {
    line_ = std::max(line_, std::sqrt(p / 2) + 1);
    scale = p / 2 * (1 - std::log(p / 2));
  }
  step_ = 2 * pi * line_ / accuracy;
  const auto excess = [&] {
    const double rate = 2 * pi / step_;
    const double left = (p > 0 ? p * (1 + std::log(rate / p)) : 0) - rate * line_;
    const double x = (rate + std::sqrt(std::max(0.0, rate * rate + 8 * p))) / 4;
    const double right = x * x - p * std::log(x) - rate * (x - line_);
    return std::max(left, right) - scale + accuracy - 1;
  };
  while (excess() > 0) step_ *= 0.97;
  least_pole_ = std::max(p, 1.0) * step_ / (2 * pi);
  count_ = 0;
  const double top = p > 0 ? scale : 0;
  for (;;) {
    const double y = (static_cast<double>(count_) + offset_) * step_;
    const double size = line_ * line_ - y * y - p / 2 * std::log(line_ * line_ + y * y);
    if ((y > line_ && size < top - accuracy) || count_ == capacity) break;
    ++count_;
  }
}

void MittagLefflerContour::place_nodes() {
  for (std::size_t k = 0; k < count_; ++k) {
    const double y = (static_cast<double>(k) + offset_) * step_;
    const double log_modulus = std::log(line_ * line_ + y * y) / 2;
    const double argument = std::atan2(y, line_);
    const double weight = (y == 0 ? 0.5 : 1) * step_ / pi;
    const double a = weight * std::exp((line_ - y) * (line_ + y) + power_ * log_modulus);
    const double a_argument = 2 * line_ * y + power_ * argument;
    const double v = std::exp(2 * alpha_ * log_modulus);
    const double v_argument = 2 * alpha_ * argument;
    a_re_[k] = a * std::cos(a_argument);
    a_im_[k] = a * std::sin(a_argument);
    v_re_[k] = v * std::cos(v_argument);
    v_im_[k] = v * std::sin(v_argument);
    av_re_[k] = a_re_[k] * v_re_[k] - a_im_[k] * v_im_[k];
    const double av_im = a_re_[k] * v_im_[k] + a_im_[k] * v_re_[k];
    v_im_square_[k] = v_im_[k] * v_im_[k];
    a_cross_[k] = a_im_[k] * v_im_[k];
    av_cross_[k] = av_im * v_im_[k];
  }
  // Full lanes: nodes without weight, far from every z.
  for (; count_ % lanes != 0; ++count_) {
    a_re_[count_] = a_im_[count_] = av_re_[count_] = v_im_[count_] = 0;
    v_im_square_[count_] = a_cross_[count_] = av_cross_[count_] = 0;
    v_re_[count_] = 1e30;
  }
}

MittagLefflerContour::Poles MittagLefflerContour::poles(double alpha, Complex z) {
  Poles result;
  const double theta = std::atan2(z.imag(), z.real());
  double j = std::ceil((-pi * alpha - theta) / (2 * pi));
  if ((theta + 2 * pi * j) / alpha > pi) return result;
  result.log_radius = std::log(std::hypot(z.real(), z.imag())) / alpha;
  result.radius = std::exp(result.log_radius);
  const double w_radius = std::sqrt(result.radius);
  for (; result.count < result.w.size(); ++j) {
    const double argument = (theta + 2 * pi * j) / alpha;
    if (argument > pi) break;
    if (argument <= -pi) continue;
    result.argument[result.count] = argument;
    result.w[result.count] = {w_radius * std::cos(argument / 2), w_radius * std::sin(argument / 2)};
    ++result.count;
  }
  return result;
}

bool MittagLefflerContour::has_pole_at_node(const Poles& poles) const {
  for (std::size_t j = 0; j < poles.count; ++j) {
    const double x = (poles.w[j].real() - line_) / step_;
    const double y = poles.w[j].imag() / step_ - offset_;
    if (std::abs(x) < 0.25 && std::abs(y - std::round(y)) < 0.25) return true;
  }
  return false;
}

template <bool with_derivative>
FRACFIT_INLINE inline MittagLefflerContour::ValueAndDerivative MittagLefflerContour::over_nodes(Complex z) const {
  double sum_re[lanes] = {}, sum_im[lanes] = {}, slope_re[lanes] = {}, slope_im[lanes] = {};
  const double x = z.real();
  const double y = z.imag();
  for (std::size_t k = 0; k < count_; k += lanes) {
    for (std::size_t i = 0; i < lanes; ++i) {
      const double a_re = a_re_[k + i], a_im = a_im_[k + i];
      const double d_re = v_re_[k + i] - x;
      const double upper_im = v_im_[k + i] - y, lower_im = -v_im_[k + i] - y;
      const double upper_square = d_re * d_re + upper_im * upper_im;
      const double lower_square = d_re * d_re + lower_im * lower_im;
      const double inverse = 1 / (upper_square * lower_square);
      const double upper = inverse * lower_square, lower = inverse * upper_square;
      const double upper_re = (a_re * d_re + a_im * upper_im) * upper;
      const double upper_part = (a_im * d_re - a_re * upper_im) * upper;
      const double lower_re = (a_re * d_re - a_im * lower_im) * lower;
      const double lower_part = (-a_im * d_re - a_re * lower_im) * lower;
      sum_re[i] += upper_re + lower_re;
      sum_im[i] += upper_part + lower_part;
      if constexpr (with_derivative) {
        slope_re[i] +=
            (upper_re * d_re + upper_part * upper_im) * upper + (lower_re * d_re + lower_part * lower_im) * lower;
        slope_im[i] +=
            (upper_part * d_re - upper_re * upper_im) * upper + (lower_part * d_re - lower_re * lower_im) * lower;
      }
    }
  }
  Complex value = 0;
  Complex slope = 0;
  for (std::size_t i = 0; i < lanes; ++i) {
    value += Complex(sum_re[i], sum_im[i]);
    slope += Complex(slope_re[i], slope_im[i]);
  }
  return {value, slope};
}

template <bool with_derivative>
MittagLefflerContour::ValueAndDerivative MittagLefflerContour::evaluate(Complex z, const Poles& poles) const {
  auto [value, slope] = with_wide_vectors([&]() FRACFIT_INLINE { return over_nodes<with_derivative>(z); });
  const double rate = 2 * pi / step_;
  for (std::size_t j = 0; j < poles.count; ++j) {
    const Complex w = poles.w[j];
    const double argument = poles.argument[j];
    const double decay = -rate * (w.real() - line_);
    if (decay > 745 || std::sqrt(poles.radius) < least_pole_) continue;
    Complex quotient = 1;
    Complex leaving = 0;
    if (decay > -accuracy) {
      const double size = std::exp(decay);
      const double angle = 2 * pi * offset_ - rate * w.imag();
      leaving = {size * std::cos(angle), size * std::sin(angle)};
      const Complex d(1 - leaving.real(), -leaving.imag());
      quotient = std::conj(d) / std::norm(d);
    }
    const Complex s(poles.radius * std::cos(argument), argument == 0 ? 0 : poles.radius * std::sin(argument));
    const Complex exponent = s + (1 - beta_) * Complex(poles.log_radius, argument);
    if (exponent.real() < -745) continue;
    const Complex part = quotient / alpha_;
    value += scaled_exp(exponent, part);
    if constexpr (with_derivative) {
      // d/dz of e^s s^(1-beta) quotient(w) with ds/dz = s/(alpha z), dw/dz = w/(2 alpha z).
      const Complex inner = (s + 1.0 - beta_) - times(times(quotient, leaving), rate * w) / 2.0;
      slope += scaled_exp(exponent, times(part, inner) / (alpha_ * z));
    }
  }
  if (z.imag() == 0) return {value.real(), slope.real()};
  return {value, slope};
}

Complex MittagLefflerContour::value(Complex z, const Poles& poles) const {
  return evaluate<false>(z, poles).value;
}

MittagLefflerContour::ValueAndDerivative MittagLefflerContour::value_and_derivative(Complex z,
                                                                                    const Poles& poles) const {
  return evaluate<true>(z, poles);
}

// 2 Re sum a/(v - z).  Where 1/Gamma(beta - alpha), the coefficient of -1/z far out, is small against the weights, the
// terms cancel to it; z E_{alpha,beta}(z) = E_{alpha,beta-alpha}(z) - 1/Gamma(beta - alpha) then has it exactly.
template <bool cancels_far_out>
FRACFIT_INLINE inline void MittagLefflerContour::negative_blocks(std::span<const double> z, double* value) const {
  constexpr std::size_t block = 8;
  // Eight doubles, at any address.
  typedef double Vector __attribute__((vector_size(8 * block), aligned(8), may_alias));
  for (std::size_t start = 0; start < z.size(); start += block) {
    const std::size_t size = std::min(block, z.size() - start);
    Vector at;
    for (std::size_t i = 0; i < block; ++i) at[i] = z[start + std::min(i, size - 1)];
    const auto is_far = at < -1.0;
    Vector sum{};
    // Four nodes share one division.
    for (std::size_t k = 0; k < count_; k += lanes) {
      Vector part[lanes], norm[lanes];
#pragma GCC unroll 4
      for (std::size_t i = 0; i < lanes; ++i) {
        const std::size_t n = k + i;
        const Vector re = v_re_[n] - at;
        norm[i] = re * re + v_im_square_[n];
        if constexpr (cancels_far_out) {
          const double near = a_re_[n], far = av_re_[n];
          const double near_cross = a_cross_[n], far_cross = av_cross_[n];
          part[i] = (is_far ? +far : +near) * re + (is_far ? +far_cross : +near_cross);
        } else {
          part[i] = a_re_[n] * re + a_cross_[n];
        }
      }
      const Vector first = part[0] * norm[1] + part[1] * norm[0];
      const Vector second = part[2] * norm[3] + part[3] * norm[2];
      const Vector first_norm = norm[0] * norm[1];
      const Vector second_norm = norm[2] * norm[3];
      sum += (first * second_norm + second * first_norm) / (first_norm * second_norm);
    }
    sum *= 2;
    if constexpr (cancels_far_out) sum = is_far ? (sum - leading_) / at : sum;
    for (std::size_t i = 0; i < size; ++i) value[start + i] = sum[i];
  }
}

void MittagLefflerContour::negative_values(std::span<const double> z, double* value) const {
  if (std::abs(leading_) < 0.2) {
    with_wide_vectors([&]() FRACFIT_INLINE { negative_blocks<true>(z, value); });
  } else {
    with_wide_vectors([&]() FRACFIT_INLINE { negative_blocks<false>(z, value); });
  }
}

}  // namespace frac::detail
