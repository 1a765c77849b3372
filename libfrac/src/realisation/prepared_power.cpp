// SPDX-License-Identifier: BSD-3-Clause
#include "prepared_power.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "approximation/ladder_sensitivity.hpp"
#include "approximation/realised_order.hpp"
#include "base/number_text.hpp"
#include "ladder_table.hpp"
#include "special/exact_power.hpp"

namespace frac::detail {

using Complex = std::complex<double>;

void PreparedPower::prepare(const Realisation& realisation, double order) {
  order_ = order;
  sum_.reset();
  if (std::holds_alternative<ExactRealisation>(realisation)) {
    method_ = Method::exact;
    exact_order_ = order;
    exact_phase_ = quarter_turns(order);
    return;
  }
  check_realised_order(order, "power of s through " + to_string(realisation));
  if (const auto* recursive = std::get_if<OustaloupRealisation>(&realisation)) {
    // The ladder of oustaloup(), see there, in the form evaluated fastest.
    method_ = Method::oustaloup;
    exact_order_ = std::trunc(order);
    exact_phase_ = quarter_turns(exact_order_);
    const double fractional = order - exact_order_;
    log_upper_ = std::log(recursive->band.upper);
    rung_ = (log_upper_ - std::log(recursive->band.lower)) / recursive->poles;
    gain_ = std::pow(recursive->band.upper, fractional);
    zero_by_pole_ = std::exp(-fractional * rung_);
    poles_.resize(static_cast<std::size_t>(recursive->poles));
    for (std::size_t i = 0; i < poles_.size(); ++i) {
      poles_[i] = std::exp(std::log(recursive->band.lower) + (static_cast<double>(i) + 0.5 + fractional / 2) * rung_);
    }
    return;
  }
  if (const auto* ladder = std::get_if<LadderRealisation>(&realisation)) {
    method_ = Method::smooth_ladder;
    exact_order_ = std::trunc(order);
    exact_phase_ = quarter_turns(exact_order_);
    const double fractional = order - exact_order_;
    reciprocal_ = fractional < 0;
    log_centre_ = (std::log(ladder->band().lower) + std::log(ladder->band().upper)) / 2;
    centre_ = std::exp(log_centre_);
    ladder->table().evaluate(std::abs(fractional), log_poles_, log_poles_by_order_);
    poles_.resize(log_poles_.size());
    double log_gain = std::abs(fractional) * log_centre_;
    for (std::size_t i = 0; i < poles_.size(); ++i) {
      poles_[i] = std::exp(log_poles_[i]);
      log_gain += log_poles_[i];
    }
    gain_ = std::exp(log_gain);
    return;
  }
  const auto& sampled = std::get<GrunwaldLetnikovRealisation>(realisation);
  sample_time_ = sampled.sample_time;
  scale_ = std::pow(sampled.sample_time, -order);
  if (!std::isfinite(scale_) || scale_ == 0) {
    throw std::invalid_argument("grunwald-letnikov: sample_time = " + number_text(sampled.sample_time) +
                                " s to the power " + number_text(-order) + " is out of the range of double precision");
  }
  method_ = sampled.memory_length == 0 ? Method::all_samples : Method::finite_memory;
  if (method_ == Method::finite_memory) sum_.emplace(order, sampled.memory_length);
}

Complex PreparedPower::ladder(double omega) const {
  // Each factor is scaled by the larger of p and omega: factors then stay within [z/p, 2], so that neither product can
  // leave the range of double with the at most 1000 poles.
  Complex numerator = gain_;
  double denominator = 1;
  for (const double pole : poles_) {
    const double ratio = omega <= pole ? omega / pole : pole / omega;
    const double square = ratio * ratio;
    const double real = omega <= pole ? zero_by_pole_ + square : zero_by_pole_ * square + 1;
    numerator *= Complex(real, ratio * (1 - zero_by_pole_));
    denominator *= 1 + square;
  }
  return numerator / denominator;
}

Complex PreparedPower::ladder_log_derivative(double omega) const {
  // d z_i/d order = -z_i rung/2 and d p_i/d order = p_i rung/2.
  Complex sum = 0;
  const auto add_share = [&](double root) {  // root/(j omega + root)
    if (omega <= root) {
      const double ratio = omega / root;
      sum += Complex(1, -ratio) / (1 + ratio * ratio);
    } else {
      const double ratio = root / omega;
      sum += Complex(ratio * ratio, -ratio) / (1 + ratio * ratio);
    }
  };
  for (const double pole : poles_) {
    add_share(pole);
    add_share(pole * zero_by_pole_);
  }
  return log_upper_ - sum * (rung_ / 2);
}

Complex PreparedPower::smooth_ladder(double omega) const {
  const double scaled = omega / centre_;
  Complex product = gain_;
  // The zero next below a pole is the reciprocal of its mirror: with it no partial product leaves the range of double.
  for (std::size_t i = 0; i < poles_.size(); ++i) {
    const double zero = 1 / poles_[poles_.size() - 1 - i];
    const double pole = poles_[i];
    // (j w + z)/(j w + p) divided by the larger of p and w above and below.
    const double larger = std::max(pole, scaled);
    const double p = pole / larger;
    const double w = scaled / larger;
    product *= Complex(zero / larger * p + w * w, w * (p - zero / larger)) / (p * p + w * w);
  }
  return reciprocal_ ? 1.0 / product : product;
}

// d/d order of ln H; the fractional part and, with it, the sign of the exponent turn together where it is negative.
Complex PreparedPower::smooth_ladder_log_derivative(double omega) const {
  const double scaled = omega / centre_;
  Complex sum = log_centre_;
  for (std::size_t i = 0; i < poles_.size(); ++i) {
    sum += log_poles_by_order_[i] * ladder_sensitivity(scaled, poles_[i]);
  }
  return sum;
}

PowerResponse PreparedPower::all_samples(double omega) const {
  // (1 - e^{-jx})/h = (2/h) sin(x/2) e^{j (pi - x)/2}: no cancellation at small x = omega h.
  const double x = omega * sample_time_;
  const double magnitude = 2 * std::sin(x / 2) / sample_time_;
  const double lag = order_ * (-x / 2);
  const Complex value = real_power(magnitude, order_) * (quarter_turns(order_) * Complex(std::cos(lag), std::sin(lag)));
  return {value, value * Complex(std::log(magnitude), (std::numbers::pi - x) / 2)};
}

PowerResponse PreparedPower::finite_memory(double omega) const {
  const GrunwaldLetnikovSum::Value sum = (*sum_)(omega * sample_time_);
  return {scale_ * sum.value, scale_ * (sum.by_order - std::log(sample_time_) * sum.value)};
}

Complex PreparedPower::value(double omega) const {
  switch (method_) {
    case Method::exact:
      return real_power(omega, exact_order_) * exact_phase_;
    case Method::oustaloup: {
      const Complex whole = real_power(omega, exact_order_) * exact_phase_;
      return order_ == exact_order_ ? whole : whole * ladder(omega);
    }
    case Method::smooth_ladder: {
      const Complex whole = real_power(omega, exact_order_) * exact_phase_;
      return order_ == exact_order_ ? whole : whole * smooth_ladder(omega);
    }
    case Method::all_samples:
      return all_samples(omega).value;
    case Method::finite_memory:
      break;
  }
  return finite_memory(omega).value;
}

PowerResponse PreparedPower::response(double omega, double log_omega) const {
  switch (method_) {
    case Method::exact: {
      const Complex result = value(omega);
      return {result, result * Complex(log_omega, std::numbers::pi / 2)};
    }
    case Method::oustaloup: {
      const Complex result = value(omega);
      return {result, result * ladder_log_derivative(omega)};
    }
    case Method::smooth_ladder: {
      const Complex result = value(omega);
      return {result, result * smooth_ladder_log_derivative(omega)};
    }
    case Method::all_samples:
      return all_samples(omega);
    case Method::finite_memory:
      break;
  }
  return finite_memory(omega);
}

}  // namespace frac::detail
