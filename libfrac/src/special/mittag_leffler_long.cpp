// SPDX-License-Identifier: BSD-3-Clause
#include "mittag_leffler_long.hpp"

#include <cmath>
#include <numbers>

#include "reciprocal_gamma.hpp"

namespace frac::detail {
namespace {

using Real = long double;
using Complex = std::complex<Real>;
constexpr Real pi = std::numbers::pi_v<Real>;

// The error of the rule, e^-46, is a fifth of the rounding unit.
constexpr Real line = 1;
constexpr Real step = 2 * pi * line / 46;
constexpr int most_terms = 80;

// The product without the check for NaN that the standard's operator carries.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace

// The largest node weighs about Gamma(1 - beta + alpha (m + 1))/|z|^(m + 1).
int LongMittagLeffler::chosen_power(Real log_modulus) const {
  const auto log_weight = [&](int m) {
    return std::lgamma(1 - Real(beta_) + Real(alpha_) * (m + 1)) - static_cast<Real>(m + 1) * log_modulus;
  };
  int power = 0;
  Real least = log_weight(0);
  for (const int direction : {1, -1}) {
    for (int m = direction; std::abs(m) <= (direction > 0 ? 12 : most_terms); m += direction) {
      if (1 - beta_ + alpha_ * (m + 1) < 1) break;
      const Real weight = log_weight(m);
      if (!(weight < least)) break;
      least = weight;
      power = m;
    }
  }
  return power;
}

// On the principal sheet, where sqrt(s) has a positive real part.
std::vector<LongMittagLeffler::Pole> LongMittagLeffler::poles(Complex z) const {
  std::vector<Pole> result;
  const Real theta = std::arg(z);
  const Real log_radius = std::log(std::abs(z)) / Real(alpha_);
  for (Real j = std::ceil((-pi * Real(alpha_) - theta) / (2 * pi));; ++j) {
    const Real argument = (theta + 2 * pi * j) / Real(alpha_);
    if (argument > pi) return result;
    if (argument > -pi) result.push_back({argument, log_radius});
  }
}

Real LongMittagLeffler::coefficient(int j) {
  std::vector<Real>& list = j < 0 ? falling_ : rising_;
  const auto index = static_cast<std::size_t>(j < 0 ? -j - 1 : j);
  while (list.size() <= index) {
    const auto next = static_cast<Real>(list.size());
    // The product is exact, and the argument good to a part in 2^64: beside a zero of 1/Gamma that decides.
    list.push_back(reciprocal_gamma(Real(beta_) + Real(alpha_) * (j < 0 ? -next - 1 : next)));
  }
  return list[index];
}

// e^{w^2} w^(2 (alpha - beta + alpha m) + 1)/(w^(2 alpha) - z) on w = line + i (k + offset) step.
const std::vector<LongMittagLeffler::Node>& LongMittagLeffler::nodes(int power, bool shifted) {
  std::vector<Node>& list = nodes_[{power, shifted}];
  if (!list.empty()) return list;
  const Real exponent = 2 * (Real(alpha_) * (power + 1) - Real(beta_)) + 1;
  const Real peak = std::sqrt(exponent / 2);
  const auto log_size = [&](Real y) { return line * line - y * y + exponent / 2 * std::log(line * line + y * y); };
  const Real least = log_size(peak) - 50;
  for (int k = 0;; ++k) {
    const Real y = (k + (shifted ? Real(0) : Real(0.5))) * step;
    if (y > peak && log_size(y) < least) return list;
    const Real log_modulus = std::log(line * line + y * y) / 2;
    const Real argument = std::atan2(y, line);
    const Real weight = (y == 0 ? 0.5L : 1.0L) * step / pi;
    list.push_back({std::polar(weight * std::exp((line - y) * (line + y) + exponent * log_modulus),
                               2 * line * y + exponent * argument),
                    std::polar(std::exp(2 * Real(alpha_) * log_modulus), 2 * Real(alpha_) * argument)});
  }
}

void LongMittagLeffler::add_terms(Complex z, int power, Sum& sum) {
  const Complex inverse = Real(1) / z;
  Complex part = 1;
  for (int j = 1; j <= power; ++j) {
    part = times(part, inverse);
    const Complex term = -coefficient(-j) * part;
    sum.add(term, times(term, inverse) * static_cast<Real>(-j));
  }
  Complex slope = 0;  // j z^(j-1)
  for (int j = 0; j < -power; ++j) {
    sum.add(coefficient(j) * part, coefficient(j) * slope);
    slope = times(slope, z) + part;
    part = times(part, z);
  }
}

void LongMittagLeffler::add_nodes(Complex z, int power, bool shifted, Sum& sum) {
  Complex value = 0;
  Complex slope = 0;
  for (const Node& node : nodes(power, shifted)) {
    for (const bool upper : {true, false}) {
      const Complex a = upper ? node.weight : std::conj(node.weight);
      const Complex d = (upper ? node.v : std::conj(node.v)) - z;
      const Real norm = d.real() * d.real() + d.imag() * d.imag();
      const Complex inverse(d.real() / norm, -d.imag() / norm);
      const Complex part = times(a, inverse);
      value += part;
      slope += times(part, inverse);
    }
  }
  // z^-m, m = power.
  const Complex base = power > 0 ? Real(1) / z : z;
  Complex factor = 1;
  for (int j = 0; j < std::abs(power); ++j) factor = times(factor, base);
  sum.add(times(factor, value), times(factor, slope - times(value, static_cast<Real>(power) / z)));
}

// As in MittagLefflerContour.
void LongMittagLeffler::add_pole(Complex z, const Pole& pole, bool shifted, Sum& sum) const {
  const Complex log_s(pole.log_radius, pole.argument);
  const Complex s = std::exp(log_s);
  const Complex w = std::exp(log_s / Real(2));
  const Complex leaving = std::exp(Complex(0, shifted ? 0 : pi) - 2 * pi / step * (w - line));
  const Complex exponent = s + (1 - Real(beta_)) * log_s;
  if (exponent.real() < -11000) return;
  const Complex residue = std::exp(exponent) / Real(alpha_);
  // A pole far left of the line is none of the rule's.
  if (!std::isfinite(std::abs(leaving))) return;
  const Complex quotient = Real(1) / (Real(1) - leaving);
  const Complex value = times(residue, quotient);
  const Complex inner = (s + Real(1) - Real(beta_)) - times(times(quotient, leaving), 2 * pi / step * w) / Real(2);
  sum.add(value, times(value, inner) / (Real(alpha_) * z));
}

LongMittagLeffler::ValueAndDerivative LongMittagLeffler::operator()(std::complex<double> argument) {
  const Complex z(argument.real(), argument.imag());
  const std::vector<Pole> all = poles(z);
  bool shifted = false;
  for (const Pole& pole : all) {
    const Complex w = std::exp(Complex(pole.log_radius, pole.argument) / Real(2));
    const Real x = (w.real() - line) / step;
    const Real y = w.imag() / step - 0.5L;
    shifted = shifted || (std::abs(x) < 0.25L && std::abs(y - std::round(y)) < 0.25L);
  }
  const int power = chosen_power(std::log(std::abs(z)));
  Sum sum;
  add_terms(z, power, sum);
  add_nodes(z, power, shifted, sum);
  for (const Pole& pole : all) add_pole(z, pole, shifted, sum);
  const auto rounded = [&](Complex x) {
    return std::complex<double>(static_cast<double>(x.real()), z.imag() == 0 ? 0 : static_cast<double>(x.imag()));
  };
  return {rounded(sum.value), rounded(sum.slope)};
}

}  // namespace frac::detail
