// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/dead_time.hpp"
#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "formula/power_sum.hpp"
#include "frac/digital/digital_filter.hpp"
#include "poles/laplace_image.hpp"
#include "special/phi_functions.hpp"
#include "time_response/exponential_sum.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using detail::expm1;

[[noreturn]] void refuse(const std::string& why) {
  throw std::invalid_argument("filter_design: " + why);
}

// (e^z - 1 - z)/z
Complex second_change(Complex z) {
  if (std::abs(z) > 0.5) return (expm1(z) - z) / z;
  Complex sum = 0;
  Complex term = z / 2.0;
  for (int k = 3; k < 20; ++k) {
    sum += term;
    term *= z / static_cast<double>(k);
  }
  return sum;
}

// A recursion that grows would overflow long before the horizon.
void refuse_unstable(const detail::PowerSumRoots& poles) {
  // A pole on the axis is found to within rounding of it.
  constexpr double rounding = 1e-9;
  for (const auto& pole : poles.clusters) {
    if (pole.log_s.imag() >= std::numbers::pi / 2 - rounding - pole.spread) continue;
    const Complex place = std::exp(pole.log_s);
    const std::string real = detail::short_text(place.real());
    refuse("the model is unstable, with " +
           (pole.is_conjugate ? "a pole at " + real
                              : "poles at " + real + " +- " + detail::short_text(place.imag()) + " i") +
           " rad/s; allowed is a stable or integrating model");
  }
}

void check(double sample_time, double tolerance, double horizon) {
  if (!(sample_time > 0 && std::isfinite(sample_time))) {
    refuse("sample_time = " + detail::number_text(sample_time) + " s; allowed is above 0, finite");
  }
  if (!(tolerance >= 1e-13 && tolerance <= 0.1)) {
    refuse("tolerance = " + detail::number_text(tolerance) + "; allowed is 1e-13 to 0.1");
  }
  if (!(horizon >= 1 && horizon <= 1e12)) {
    refuse("horizon = " + detail::number_text(horizon) + " samples; allowed is 1 to 1e12");
  }
}

/// Powers of s that the model follows at high and at low frequency.
struct EndOrders {
  double high, low;
};
EndOrders checked_orders(const FractionalTransferFunction& model) {
  const EndOrders orders{model.numerator().front().order - model.denominator().front().order,
                         model.numerator().back().order - model.denominator().back().order};
  if (orders.high > 0) {
    refuse("the model grows as s^" + detail::number_text(orders.high) +
           " at high frequency; allowed is a proper model (a power of s has digital_power())");
  }
  if (orders.low <= -2) {
    refuse("the model integrates more than once (s^" + detail::number_text(orders.low) +
           " at low frequency); allowed is above s^-2");
  }
  return orders;
}

detail::SampledDeadTime checked_dead_time(double delay, double sample_time, bool integrates) {
  const detail::SampledDeadTime dead_time = detail::sampled_dead_time(delay, sample_time);
  const auto& [late, whole, rest] = dead_time;
  constexpr double most_late = 1e6;
  if (!(late <= most_late)) refuse("dead time of " + detail::number_text(late) + " samples; allowed is up to 1e6");
  if (integrates && rest > 0) {
    refuse("dead time of " + detail::number_text(late) +
           " samples with an integration; allowed is a whole number of samples");
  }
  return dead_time;
}

/// Step response of the model without its integration and dead time: constant + sum weight (e^{rate t} - 1).
/// @param theta  instant within a sample from which on it is read
detail::ExponentialSum step_response(const FractionalTransferFunction& model, double sample_time, double theta,
                                     double tolerance, double horizon, bool integrates) {
  const detail::LaplaceImage step(detail::scaled(detail::numerator_of(model), 1, integrates ? 1 : 0),
                                  detail::scaled(detail::denominator_of(model), 1, 1));
  if (!step.poles().complete) {
    throw std::domain_error("filter_design: the poles of the model could not be counted: " +
                            std::string(step.poles().trouble));
  }
  refuse_unstable(step.poles());
  return detail::exponential_sum(step, theta * sample_time, horizon * sample_time, tolerance, integrates ? 1 : 0,
                                 integrates ? 2 : 1);
}

/// With rate = 1 - e^{r T} a term answers a constant by -weight rate v, and a ramp over one interval by
/// -weight rate (1 + change) v, change = (e^{rT} - 1 - rT)/(rT); what is left over falls to the previous input, for
/// which a section of rate 1 stands.
/// @param high_gain  of the model
void add_sections(const detail::ExponentialSum& sum, double theta, double high_gain, DigitalFilterDesign& design) {
  const double sample_time = design.sample_time;
  const bool integrates = design.integrators > 0, is_late = theta < 1;
  double after_step = sum.constants[0];
  double after_ramp = integrates ? sum.constants[0] + sum.constants[1] / sample_time : 0;
  for (const detail::Exponential& term : sum.terms) {
    after_step += (term.weight * expm1(term.rate * (theta * sample_time))).real();
    if (integrates) after_ramp += (term.weight * second_change(term.rate * sample_time)).real();
  }
  design.sections.direct = is_late ? after_step : integrates ? after_ramp : high_gain;
  double previous = is_late ? 0 : after_step - design.sections.direct;
  for (const detail::Exponential& term : sum.terms) {
    const Complex z = term.rate * sample_time;
    const Complex rate = -expm1(z);
    const Complex ramp = integrates ? second_change(z) : 0;
    Complex weight = -term.weight * rate * (1.0 + ramp);
    if (is_late) {
      weight *= std::exp(term.rate * (theta * sample_time));
    } else {
      previous += (term.weight * (rate + ramp)).real();
    }
    if (term.rate.imag() == 0) {
      design.sections.rates.push_back(rate.real());
      design.sections.weights.push_back(weight.real());
    } else {
      design.pair_rates.push_back(rate);
      design.pair_weights.push_back(weight);
    }
  }
  if (previous != 0) {
    design.sections.rates.push_back(1);
    design.sections.weights.push_back(previous);
  }
}

}  // namespace

DigitalFilterDesign filter_design(const FractionalTransferFunction& model, double sample_time, double tolerance,
                                  double horizon) {
  check(sample_time, tolerance, horizon);
  const EndOrders orders = checked_orders(model);
  const bool integrates = orders.low <= -1;
  const auto [late, whole, rest] = checked_dead_time(model.delay(), sample_time, integrates);
  const double theta = 1 - rest;
  const detail::ExponentialSum sum = step_response(model, sample_time, theta, tolerance, horizon, integrates);

  DigitalFilterDesign design;
  design.sample_time = sample_time;
  design.rule = IntegratorRule::held;
  design.integrators = integrates ? 1 : 0;
  // Read within the interval, the output is known one sample later.
  design.dead_samples = static_cast<std::size_t>(whole) + (rest > 0 ? 1 : 0);
  const double high_gain =
      orders.high == 0 ? model.numerator().front().coefficient / model.denominator().front().coefficient : 0;
  add_sections(sum, theta, high_gain, design);
  return design;
}

}  // namespace frac
