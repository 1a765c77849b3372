#include "detail/mittag_leffler_contour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "detail/reciprocal_gamma.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

// e^-40 is a fiftieth of the rounding unit: the three errors of the rule, from the branch point, from the growth of
// e^{w^2} on the right and from leaving out the tail, are held there relative to the scale of the result.
constexpr double accuracy = 40;
// A line nearer to the origin keeps e^{c^2} and with it the rounding small, at the price of nodes: e^{2.6} and 26.
constexpr double usual_line = 1.6;

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

// The integrand is e^{w^2} w^-p on the way to the branch point.  Stopping the shifted line at w = p h/(2 pi) bounds that
// error by exp(p (1 + ln(2 pi/(h p))) - 2 pi c/h); shifting it right to the stationary point bounds the other.  Both
// are to be small against the integrand at its saddle sqrt(p/2), which is the scale of 1/Gamma.
void MittagLefflerContour::choose_line() {
  const double p = -power_;
  line_ = usual_line;
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
    av_im_[k] = a_re_[k] * v_im_[k] + a_im_[k] * v_re_[k];
  }
}

// s = z^(1/alpha) on the principal sheet; those with |arg s| < pi have Re w > 0.
MittagLefflerContour::Poles MittagLefflerContour::poles(Complex z) const {
  Poles result;
  const double theta = std::arg(z);
  const double radius = std::pow(std::abs(z), 1 / alpha_);
  const double w_radius = std::sqrt(radius);
  if (!(w_radius > least_pole_)) return result;
  const double first = std::ceil((-pi * alpha_ - theta) / (2 * pi));
  for (double j = first; result.count < 4; ++j) {
    const double argument = (theta + 2 * pi * j) / alpha_;
    if (argument > pi) break;
    if (argument <= -pi) continue;
    const double cosine = std::cos(argument / 2);
    const double sine = std::sin(argument / 2);
    // s from the doubled angle, exact in the real case.
    result.pole[result.count++] = {
        {radius * std::cos(argument), argument == 0 ? 0 : radius * std::sin(argument)},
        {w_radius * cosine, argument == 0 ? 0 : w_radius * sine}};
  }
  return result;
}

bool MittagLefflerContour::has_pole_at_node(Complex z) const {
  const Poles near = poles(z);
  for (std::size_t j = 0; j < near.count; ++j) {
    const double x = (near.pole[j].w.real() - line_) / step_;
    const double y = near.pole[j].w.imag() / step_ - offset_;
    if (std::abs(x) < 0.25 && std::abs(y - std::round(y)) < 0.25) return true;
  }
  return false;
}

template <bool with_derivative>
MittagLefflerContour::ValueAndDerivative MittagLefflerContour::evaluate(Complex z) const {
  double sum_re = 0, sum_im = 0, slope_re = 0, slope_im = 0;
  const double x = z.real();
  const double y = z.imag();
  for (std::size_t k = 0; k < count_; ++k) {
    const double d_re = v_re_[k] - x;
    for (const double sign : {1.0, -1.0}) {
      const double a_im = sign * a_im_[k];
      const double d_im = sign * v_im_[k] - y;
      const double inverse = 1 / (d_re * d_re + d_im * d_im);
      const double q_re = (a_re_[k] * d_re + a_im * d_im) * inverse;
      const double q_im = (a_im * d_re - a_re_[k] * d_im) * inverse;
      sum_re += q_re;
      sum_im += q_im;
      if constexpr (with_derivative) {
        slope_re += (q_re * d_re + q_im * d_im) * inverse;
        slope_im += (q_im * d_re - q_re * d_im) * inverse;
      }
    }
  }
  Complex value(sum_re, sum_im);
  Complex slope(slope_re, slope_im);

  const Poles found = poles(z);
  for (std::size_t j = 0; j < found.count; ++j) {
    const auto& [s, w] = found.pole[j];
    const double rate = 2 * pi / step_;
    const double exponent_re = -rate * (w.real() - line_);
    if (exponent_re > 745) continue;
    // Below e^-45 the quotient is the residue itself.
    Complex quotient = 1;
    Complex leaving = 0;
    if (exponent_re > -45) {
      leaving = std::polar(std::exp(exponent_re), 2 * pi * offset_ - rate * w.imag());
      quotient = 1.0 / (1.0 - leaving);
    }
    const Complex log_s(2 * std::log(std::abs(w)), 2 * std::arg(w));
    const Complex exponent = s + (1 - beta_) * log_s;
    if (exponent.real() < -745) continue;
    const Complex part = quotient / alpha_;
    value += scaled_exp(exponent, part);
    if constexpr (with_derivative) {
      // d/dz of e^s s^(1-beta) quotient(w) with ds/dz = s/(alpha z), dw/dz = w/(2 alpha z).
      const Complex inner = (s + 1.0 - beta_) - times(times(quotient, leaving), rate * w) / 2.0;
      slope += scaled_exp(exponent, times(part, inner) / (alpha_ * z));
    }
  }
  if (y == 0) return {value.real(), slope.real()};
  return {value, slope};
}

Complex MittagLefflerContour::value(Complex z) const {
  return evaluate<false>(z).value;
}

MittagLefflerContour::ValueAndDerivative MittagLefflerContour::value_and_derivative(Complex z) const {
  return evaluate<true>(z);
}

// 2 Re sum a/(v - z).  Where 1/Gamma(beta - alpha), the coefficient of -1/z far out, is small against the weights the
// terms cancel to it; z E_{alpha,beta}(z) = E_{alpha,beta-alpha}(z) - 1/Gamma(beta - alpha) then has it exactly.
void MittagLefflerContour::negative_values(std::span<const double> z, double* value) const {
  constexpr std::size_t block = 8;
  const bool cancels_far_out = std::abs(leading_) < 0.2;
  const auto rational = [this](const Column& a_re, const Column& a_im, const double* at, double* sum) {
    for (std::size_t i = 0; i < block; ++i) sum[i] = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const double ar = a_re[k], ai = a_im[k] * v_im_[k], vr = v_re_[k], vv = v_im_[k] * v_im_[k];
      for (std::size_t i = 0; i < block; ++i) {
        const double d = vr - at[i];
        sum[i] += (ar * d + ai) / (d * d + vv);
      }
    }
    for (std::size_t i = 0; i < block; ++i) sum[i] *= 2;
  };
  for (std::size_t start = 0; start < z.size(); start += block) {
    const std::size_t size = std::min(block, z.size() - start);
    double at[block], direct[block], reduced[block];
    std::size_t far = 0;
    for (std::size_t i = 0; i < block; ++i) {
      at[i] = z[start + std::min(i, size - 1)];
      far += cancels_far_out && at[i] < -1 ? 1 : 0;
    }
    if (far < block) rational(a_re_, a_im_, at, direct);
    if (far > 0) rational(av_re_, av_im_, at, reduced);
    for (std::size_t i = 0; i < size; ++i) {
      const bool is_far = cancels_far_out && at[i] < -1;
      value[start + i] = is_far ? (reduced[i] - leading_) / at[i] : direct[i];
    }
  }
}

}  // namespace frac::detail
