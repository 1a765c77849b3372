// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "fixed_point_text.hpp"
#include "frac/digital/fixed_point.hpp"
#include "runtime_text.hpp"

namespace frac {
namespace fixed_point = detail::fixed_point;
using fixed_point::in_brackets;
using fixed_point::Operator;
using fixed_point::Product;

namespace {

// Errors are fractions of 4 input ranges; the sum has 48 bits below the output range, the integrator up to 58.
constexpr double room = 4;
constexpr int sum_bits = 48, most_integrator_bits = 58, input_bits = 30;

void check(const PidCoefficients<double>& k) {
  if (k.anti_windup == AntiWindup::conditional_integration)
    throw std::invalid_argument("fixed_point_header: fixed point has no conditional integration; back calculation is");
  for (const double weight : {k.setpoint_weight, k.derivative_setpoint_weight}) {
    if (!(weight >= 0 && weight <= 1))
      throw std::invalid_argument("fixed_point_header: a set-point weight of " + detail::number_text(weight) +
                                  "; fixed point takes 0 to 1");
  }
}

// The gains of a controller in whole numbers.
struct FixedPointPid {
  FixedPointPid(const FractionalPidDesign& design, double ratio_of_ranges);

  PidCoefficients<double> k;
  double ratio;  // input range over output range
  bool integrates, differs, tracks;
  Product kp, tracking, high;
  Operator integral, derivative;
  int integrator_bits = most_integrator_bits;

  [[nodiscard]] int derivative_shift() const { return derivative.scale() - sum_bits; }
  // Of the output over its range: by the integral's increment of one sample, and by all else.
  [[nodiscard]] double increment_error() const;
  [[nodiscard]] double error_bound() const;
  // Excess over a limit that the input of the integral can take back in one sample.
  [[nodiscard]] double exact_excess() const;
};

FixedPointPid::FixedPointPid(const FractionalPidDesign& design, double ratio_of_ranges)
    : k(design), ratio(ratio_of_ranges) {
  check(k);
  integrates = k.ki != 0;
  differs = k.kd != 0;
  tracks = integrates && k.anti_windup == AntiWindup::back_calculation;
  kp = fixed_point::product_of(std::ldexp(k.kp * ratio, sum_bits - input_bits));
  if (integrates) {
    integral = fixed_point::operator_of(design.integral(), k.sample_time * k.ki * room * ratio);
    integrator_bits = std::min(integral.scale(), most_integrator_bits);
    if (integrator_bits < sum_bits) fixed_point::refuse_gain(integral.largest);
  }
  if (differs) {
    const double gain = k.kd * (k.differentiates ? k.inverse_lag_time : 1);
    derivative = fixed_point::operator_of(design.derivative(), gain * room * ratio);
    if (derivative_shift() < 0) fixed_point::refuse_gain(derivative.largest);
  }
  if (tracks) {
    tracking = fixed_point::product_of(k.tracking_share * k.inverse_tracking / (k.ki * room * ratio));
    high = fixed_point::product_of(
        std::ldexp(k.sample_time * k.ki * design.integral().high_gain * room * ratio, integrator_bits - input_bits));
  }
}

// In units of 2^-30 of the input range: half a bit lost by halving each of two numbers, and, with a weight, half of
// its rounding, half of what it weighs and one of the product.
constexpr double of_error = 1, of_weighted = of_error + 2;
// Cut to fractions of 4 input ranges.
double cut_error(double of_number) {
  return (of_number / room + 1) * std::ldexp(1.0, -input_bits);
}

double FixedPointPid::increment_error() const {
  return integrates ? integral.error_with(cut_error(of_error)) + std::ldexp(1.0, -integrator_bits) : 0;
}

double FixedPointPid::error_bound() const {
  const double of_input = std::ldexp(1.0, -input_bits), half = of_input / 2;
  const double p = of_weighted * of_input * std::abs(k.kp) * ratio +
                   2 * std::ldexp(kp.rounding, input_bits - sum_bits) + std::ldexp(1.0, -sum_bits);
  double d = 0;
  if (differs) {
    // The lag follows what it is given with gain 1; its own value is rounded, and so is its share.
    const double weighted = cut_error(of_weighted);
    const double lag = weighted + half + half / k.lag_share;
    const double given = k.differentiates ? weighted + lag + half : lag + half;
    d = derivative.error_with(given) + std::ldexp(1.0, -sum_bits);
  }
  return p + d + increment_error() / 2 + std::ldexp(1.0, 2 - sum_bits) + std::ldexp(1.0, -32);
}

double FixedPointPid::exact_excess() const {
  if (!tracks) return std::numeric_limits<double>::infinity();
  // Set-point less measured value can fill two of the four input ranges.  The excess is held up to two output ranges.
  const double correction = k.tracking_share * k.inverse_tracking / (std::abs(k.ki) * ratio);
  return std::min(2.0, (room - 2) / correction);
}

detail::CWords words_of(const FixedPointPid& pid, double output_range, const std::string& name) {
  const PidCoefficients<double>& k = pid.k;
  const auto whole = [&](double value) {
    const double most = std::ldexp(1.0, 31);
    return std::clamp<std::int64_t>(std::llround(std::clamp(value / output_range * most, -most, most)), INT32_MIN,
                                    INT32_MAX);
  };
  // The least of 32 bits has no number of its own in C.
  const auto limit = [](std::int64_t value) {
    return value == INT32_MIN ? std::string("INT32_MIN") : in_brackets(value);
  };
  const auto share = [](double value) { return std::to_string(std::llround(std::ldexp(value, 30))); };
  const auto sum_of = [&](const Operator& parts, const std::string& prefix) {
    return fixed_point::output_of(parts, name, prefix, prefix + (parts.taps.taps.empty() ? "_input" : "_x"));
  };
  const std::int64_t minimum = whole(k.minimum), maximum = whole(k.maximum);
  return {{"INTEGRAL_OUTPUT", sum_of(pid.integral, "integral")},
          {"DERIVATIVE_OUTPUT", sum_of(pid.derivative, "derivative")},
          {"INTEGRAL_SHIFT", std::to_string(pid.integral.scale() - pid.integrator_bits)},
          {"INTEGRATOR_BITS", std::to_string(pid.integrator_bits)},
          {"INTEGRATOR_EXTRA", std::to_string(pid.integrator_bits - sum_bits)},
          {"INTEGRATOR_HALVED", std::to_string(pid.integrator_bits - sum_bits + 1)},
          {"INTEGRATOR_LIMIT_BITS", std::to_string(pid.integrator_bits + 4)},
          {"DERIVATIVE_SHIFT", std::to_string(pid.derivative_shift())},
          {"KP", in_brackets(pid.kp.number)},
          {"KP_SHIFT", std::to_string(pid.kp.shift)},
          {"SETPOINT_GAP", share(1 - k.setpoint_weight)},
          {"DERIVATIVE_SETPOINT_GAP", share(1 - k.derivative_setpoint_weight)},
          {"LAG_SHARE", share(k.lag_share)},
          {"TRACKING", in_brackets(pid.tracking.number)},
          {"TRACKING_SHIFT", std::to_string(pid.tracking.shift)},
          {"HIGH_GAIN", in_brackets(pid.high.number)},
          {"HIGH_GAIN_SHIFT", std::to_string(pid.high.shift)},
          {"MINIMUM", limit(minimum)},
          {"MAXIMUM", limit(maximum)},
          {"REST_OUTPUT", limit(std::clamp<std::int64_t>(0, minimum, maximum))}};
}

}  // namespace

FixedPointHeader fixed_point_header(const FractionalPidDesign& design, const FixedPointRanges& ranges,
                                    const CHeaderOptions& options) {
  fixed_point::check(ranges);
  const FixedPointPid pid(design, ranges.input / ranges.output);
  FixedPointHeader result;
  result.error_bound = pid.error_bound() * ranges.output;
  result.error_per_sample = pid.increment_error() * ranges.output;
  result.exact_excess = pid.exact_excess() * ranges.output;
  detail::CWords words = words_of(pid, ranges.output, options.name);
  detail::CConditions conditions{{"HAS_INTEGRAL", pid.integrates},
                                 {"HAS_DERIVATIVE", pid.differs},
                                 {"FOLLOWS_LAG", !pid.k.differentiates},
                                 {"BACK_CALCULATION", pid.tracks}};
  fixed_point::describe(pid.integral, "INTEGRAL", words, conditions);
  fixed_point::describe(pid.derivative, "DERIVATIVE", words, conditions);
  conditions["HAS_ANY_STATE"] = conditions["HAS_INTEGRAL_STATE"] || conditions["HAS_DERIVATIVE_STATE"];
  const CHeaderOptions stated = fixed_point::described(options, ranges, result);
  const detail::CText c(stated);
  result.text = c.closed(c.opening(stated.comment) + "#include <stdint.h>\n\n" +
                         c.filled(detail::runtime::q31_pid_state, words, conditions) +
                         fixed_point::functions_of(pid.integral, c, options.name, "integral", 30) +
                         fixed_point::functions_of(pid.derivative, c, options.name, "derivative", 30) +
                         c.filled(detail::runtime::q31_pid, words, conditions));
  return result;
}

}  // namespace frac
