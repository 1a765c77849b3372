// SPDX-License-Identifier: BSD-3-Clause
#include "power_train.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
// Up to this |u|, so on the whole unit circle, the expansion about the origin needs at most 60 terms, none of them
// large against the sum.
constexpr double near_origin = 3.3;

// B_2k/(2k)! of Euler and Maclaurin.
constexpr std::array<long double, 12> bernoulli_over_factorial{1.0L / 12,
                                                               -1.0L / 720,
                                                               1.0L / 30240,
                                                               -1.0L / 1209600,
                                                               1.0L / 47900160,
                                                               -691.0L / 1307674368000,
                                                               1.0L / 74724249600,
                                                               -3617.0L / 10670622842880000,
                                                               43867.0L / 5109094217170944000,
                                                               -174611.0L / 802857662698291200000.0L,
                                                               77683.0L / 14101100039391805440000.0L,
                                                               -236364091.0L / 1693824136731743669452800000.0L};

// Powers of the first terms of a zeta function, for orders that fall or rise by one.
class ZetaTerms {
 public:
  /// Terms of sum_(i >= 0) (i + v)^-s.
  ZetaTerms(long double s, long double v) : s_(s), v_(v) {
    for (int i = 0; i <= terms; ++i) power_[static_cast<std::size_t>(i)] = std::pow(i + v, -s);
  }
  void lower_order() {
    for (int i = 0; i <= terms; ++i) power_[static_cast<std::size_t>(i)] *= i + v_;
    s_ -= 1;
  }
  /// The sum by Euler-Maclaurin, for -5 < s.  The terms are as large as 6^5, which long double bears.
  [[nodiscard]] long double sum() const {
    long double sum = 0;
    for (std::size_t i = 0; i < terms; ++i) sum += power_[i];
    const long double from = terms + v_;
    long double part = power_[terms];
    sum += from * part / (s_ - 1) + part / 2;
    part *= s_ / from;
    for (std::size_t k = 0; k < bernoulli_over_factorial.size(); ++k) {
      sum += bernoulli_over_factorial[k] * part;
      const long double next = s_ + 2 * static_cast<long double>(k) + 1;
      part *= next * (next + 1) / (from * from);
    }
    return sum;
  }

 private:
  static constexpr int terms = 5;
  long double s_;
  long double v_;
  std::array<long double, terms + 1> power_;
};

// zeta(p) for p from 1 on, rising by one: nine terms and Euler-Maclaurin.
class RiemannZeta {
 public:
  explicit RiemannZeta(double p) : p_(p) {
    for (int k = 1; k <= last; ++k) power_[static_cast<std::size_t>(k)] = std::pow(k, -p);
  }
  void raise_order() {
    for (int k = 1; k <= last; ++k) power_[static_cast<std::size_t>(k)] /= k;
    p_ += 1;
  }
  [[nodiscard]] double value() const {
    double part = power_[last];
    double rest = last * part / (p_ - 1) + part / 2;
    part *= p_ / last;
    for (std::size_t k = 0; k < 8; ++k) {
      rest += static_cast<double>(bernoulli_over_factorial[k]) * part;
      const double next = p_ + 2 * static_cast<double>(k) + 1;
      part *= next * (next + 1) / (last * last);
    }
    for (std::size_t k = last; k-- > 1;) rest += power_[k];
    return rest;
  }

 private:
  static constexpr int last = 10;
  double p_;
  std::array<double, last + 1> power_;
};

// cos(p pi/2) of any p, exact for whole numbers.
double cos_quarter_turns(double p) {
  const double turned = p - 4 * std::round(p / 4);
  if (std::abs(turned) <= 0.5) return std::cos(turned * pi / 2);
  if (std::abs(turned) >= 1.5) return -std::cos((2 - std::abs(turned)) * pi / 2);
  return std::sin((1 - std::abs(turned)) * pi / 2);
}

// sum_(k >= 1) cos(p pi/2 - 2 pi k v)/k^p
double hurwitz_cosines(double p, double v) {
  double sum = 0;
  for (int k = 1; k < 2000; ++k) {
    const double share = std::pow(k, -p);
    sum += share * cos_quarter_turns(p - 4 * std::fmod(k * v, 1.0));
    if (share < 1e-18) break;
  }
  return sum;
}

}  // namespace

PowerTrain::PowerTrain(double a, double v) : a_(a), v_(v), has_closed_form_(v == 1 && (a == 1 || a == 2 || a == 3)) {
  for (std::size_t j = 0; j < 3; ++j) {
    if (a > 1 || j < 2) gamma_[j] = std::tgamma(1 + a - static_cast<double>(j));
  }
}

void PowerTrain::prepare_terms() const {
  has_terms_ = true;
  for (int n = 0; n <= most_terms; ++n) power_[static_cast<std::size_t>(n)] = std::pow(n + v_, a_ - 2);
  for (std::size_t j = 0; j < 3; ++j) {
    double binomial = 1;
    for (int i = 0; i < rest_order; ++i) {
      rest_binomial_[j][static_cast<std::size_t>(i)] = binomial;
      binomial *= (a_ - static_cast<double>(j) - i) / (i + 1);
    }
  }
}

// zeta(1 - p, v) = 2 Gamma(p)/(2 pi)^p sum_(k >= 1) cos(p pi/2 - 2 pi k v)/k^p (Hurwitz): for v = 1, where the sum is
// one of Riemann's, for p above 1, else for p from 6 on.
void PowerTrain::prepare_zeta() const {
  has_zeta_ = true;
  const int first = a_ > 1 ? 0 : 1;  // a = 1: zeta(1) is not wanted
  double scale = 1;                  // (2 pi)^m/m!
  double gamma_ratio = 0;            // Gamma(p)/m!
  std::optional<ZetaTerms> low;
  std::optional<RiemannZeta> high;
  const auto is_high = [&](double p) { return v_ == 1 ? p > 1 : p >= 6; };
  if (!is_high(a_ - 1)) low.emplace(2 - static_cast<long double>(a_), v_);
  const double factor = 2 * std::pow(2 * pi, 1 - a_);
  for (int m = 0; m < zeta_terms + 2; ++m) {
    const double p = a_ - 1 + m;
    double& entry = zeta_[static_cast<std::size_t>(m)];
    if (is_high(p)) {
      gamma_ratio = gamma_ratio == 0 ? std::tgamma(p) / std::tgamma(m + 1.0) : gamma_ratio * (p - 1) / m;
      if (v_ == 1) {
        high ? high->raise_order() : void(high.emplace(p));
        entry = factor * gamma_ratio * cos_quarter_turns(p) * high->value();
      } else {
        entry = factor * gamma_ratio * hurwitz_cosines(p, v_);
      }
    } else {
      if (m >= first) entry = scale * static_cast<double>(low->sum());
      low->lower_order();
    }
    scale *= 2 * pi / (m + 1);
  }
  for (std::size_t m = 0; m < zeta_terms; ++m) {
    const double n = static_cast<double>(m);
    series_[m] = {zeta_[m + 2] * ((n + 1) * (n + 2) / (4 * pi * pi)), zeta_[m + 1] * ((n + 1) / (2 * pi)), zeta_[m]};
  }
}

std::array<double, 3> PowerTrain::at_origin() const {
  require_zeta();
  constexpr double turn = 2 * pi;
  return {zeta_[2] * 2 / (turn * turn), zeta_[1] / turn, zeta_[0]};
}

Complex TrainPoint::log_distance() const {
  if (!has_log_) {
    log_distance_ = {0.5 * std::log(std::norm(u)), std::atan2(-u.imag(), -u.real())};
    has_log_ = true;
  }
  return log_distance_;
}

TrainPoint::TrainPoint(Complex at) : u(at) {
  const double half_sine = std::sin(0.5 * u.imag()), half_cosine = std::cos(0.5 * u.imag());
  const double growth = std::expm1(u.real());
  const double size = 1 + growth;
  turned = {size * (1 - 2 * half_sine * half_sine), size * 2 * half_sine * half_cosine};
  const Complex rest(2 * size * half_sine * half_sine - growth, -turned.imag());
  inverse_rest = std::conj(rest) / std::norm(rest);
}

std::array<Complex, 3> PowerTrain::operator()(const TrainPoint& point) const {
  if (has_closed_form_) return in_closed_form(point);
  if (std::norm(point.u) > near_origin * near_origin && point.u.real() < 0) return by_terms(point);
  return about_origin(point);
}

// sum (n + 1)^b x^n, x = e^u, is 1/w, 1/w^2, (1 + x)/w^3 and (1 + 4 x + x^2)/w^4 for b = 0 to 3, w = 1 - x.
std::array<Complex, 3> PowerTrain::in_closed_form(const TrainPoint& point) const {
  const Complex one = point.inverse_rest;
  const Complex two = one * one;
  if (a_ == 1) return {two, one, 0};
  const Complex x = point.turned;
  const Complex three = (1.0 + x) * two * one;
  if (a_ == 2) return {three, two, one};
  return {(1.0 + x * (4.0 + x)) * two * two, three, two};
}

std::array<Complex, 3> PowerTrain::by_terms(const TrainPoint& point) const {
  if (!has_terms_) prepare_terms();
  const Complex u = point.u, x = point.turned;
  const int terms = std::min(most_terms, static_cast<int>(std::ceil(60 / std::abs(u))));
  std::array<Complex, 3> sum{};
  Complex power_of_x = 1;
  for (int n = 0; n < terms; ++n) {
    const Complex part = power_of_x * power_[static_cast<std::size_t>(n)];
    const double instant = n + v_;
    sum[2] += part;
    sum[1] += part * instant;
    sum[0] += part * (instant * instant);
    power_of_x *= x;
    if (std::norm(power_of_x) < 1e-40) return sum;
  }
  // 1/(1 - x e^t) = sum e_i t^i applied as an operator to the power at the first instant left out.
  std::array<Complex, rest_order> e;
  std::array<double, rest_order> inverse_factorial;
  inverse_factorial[0] = 1;
  for (std::size_t i = 1; i < rest_order; ++i) inverse_factorial[i] = inverse_factorial[i - 1] / static_cast<double>(i);
  e[0] = point.inverse_rest;
  const Complex ratio = x * e[0];
  double factorial = 1;
  const double from = terms + v_;
  const double power = power_[static_cast<std::size_t>(terms)];
  std::array<Complex, 3> rest{e[0], e[0], e[0]};
  double scale = 1;
  for (std::size_t i = 1; i < rest_order; ++i) {
    Complex inner = 0;
    for (std::size_t m = 0; m < i; ++m) inner += e[m] * inverse_factorial[i - m];
    e[i] = ratio * inner;
    factorial *= static_cast<double>(i);
    scale /= from;
    for (std::size_t j = 0; j < 3; ++j) rest[j] += e[i] * (rest_binomial_[j][i] * factorial * scale);
  }
  sum[2] += power_of_x * power * rest[2];
  sum[1] += power_of_x * (power * from) * rest[1];
  sum[0] += power_of_x * (power * from * from) * rest[0];
  return sum;
}

// sum_n zeta(j - a - n, v) u^n/n!, by real and imaginary parts: the products of complex numbers look for infinities.
std::array<Complex, 3> PowerTrain::zeta_series(Complex u) const {
  require_zeta();
  constexpr double turn = 2 * pi;
  const double re = u.real() / turn, im = u.imag() / turn;
  std::array<double, 3> sum_re{}, sum_im{};
  double power_re = 1, power_im = 0;
  for (std::size_t m = 0; m < zeta_terms; ++m) {
    for (std::size_t j = 0; j < 3; ++j) {
      sum_re[j] += series_[m][j] * power_re;
      sum_im[j] += series_[m][j] * power_im;
    }
    const double next = power_re * re - power_im * im;
    power_im = power_re * im + power_im * re;
    power_re = next;
    if (power_re * power_re + power_im * power_im < 1e-34) break;
  }
  return {Complex(sum_re[0], sum_im[0]), Complex(sum_re[1], sum_im[1]), Complex(sum_re[2], sum_im[2])};
}

std::array<Complex, 3> PowerTrain::about_origin(const TrainPoint& point) const {
  const Complex u = point.u;
  std::array<Complex, 3> sum = zeta_series(u);
  const Complex singular = std::exp(-(1 + a_) * point.log_distance());
  const Complex shift = v_ == 1 ? std::conj(point.turned) / std::norm(point.turned) : std::exp(-u * v_);
  sum[0] = shift * (sum[0] + gamma_[0] * singular);
  sum[1] = shift * (sum[1] - gamma_[1] * singular * u);
  sum[2] = a_ > 1 ? shift * (sum[2] + gamma_[2] * singular * u * u) : 0;
  return sum;
}

PowerTrain::Split PowerTrain::split(Complex u) const {
  Split result{zeta_series(u), gamma_[0] * std::exp(-(1 + a_) * std::log(-u) - u * v_)};
  for (Complex& each : result.regular) each *= std::exp(-u * v_);
  return result;
}

std::array<double, 3> power_sums_of_one_sign(double a, double v) {
  std::array<double, 3> sums{};
  ZetaTerms terms(2 - static_cast<long double>(a), v);
  for (std::size_t j = 3; j-- > 0;) {
    // zeta(1), of a ramp's second derivative, is not wanted.
    if (a > 1 || j < 2) sums[j] = static_cast<double>(terms.sum());
    terms.lower_order();
  }
  return sums;
}

}  // namespace backlash::detail
