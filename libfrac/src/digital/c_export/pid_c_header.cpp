// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "c_text.hpp"
#include "digital/section_kernel.hpp"

namespace frac {
namespace {

detail::CSections sections_of(const PidOperator& design, const char* prefix) {
  const auto size = static_cast<std::ptrdiff_t>(design.size);
  const auto taps = static_cast<std::ptrdiff_t>(design.tap_count);
  return {prefix,
          {design.taps.begin(), design.taps.begin() + taps},
          design.output,
          design.direct,
          {design.rates.begin(), design.rates.begin() + size},
          {design.weights.begin(), design.weights.begin() + size}};
}

std::string anti_windup_text(AntiWindup method) {
  if (method == AntiWindup::back_calculation) {
    return R"(    const REAL correction = -(excess * @tracking_share@) * @inverse_tracking@;
)";
  }
  if (method == AntiWindup::conditional_integration) {
    return R"(    const REAL pushes = integral_input * @integral_gain@;
    REAL correction = @zero@;
    if ((excess > @zero@) == (pushes > @zero@)) {
      const REAL needed = excess * @inverse_integral_gain@;
      const REAL size_needed = needed < @zero@ ? -needed : needed;
      const REAL size_input = integral_input < @zero@ ? -integral_input : integral_input;
      correction = size_needed < size_input ? -needed : -integral_input;
    }
)";
  }
  return "    const REAL correction = @zero@;\n";
}

template <typename Real>
std::string text_of(const FractionalPidDesign& design, const CHeaderOptions& options) {
  const detail::CText c(options);
  const PidCoefficients<Real> k(design);
  const detail::CSections integral = sections_of(design.integral(), "integral");
  const detail::CSections derivative = sections_of(design.derivative(), "derivative");

  std::string text = c.opening(options.comment);
  text += c.filled(R"(typedef struct {
)") + c.section_members(integral) +
          c.section_members(derivative) + c.filled(R"(  REAL integrator;
  REAL integrator_lost;
  REAL lag;
  REAL track_output;
  REAL output;    /* the last one */
  REAL unlimited; /* the last one before the limits */
  int is_tracking;
  int saturated; /* 1: the last output was cut at a limit */
  int bad_input; /* 1: the last input was refused and the output held */
} NAME_state;

)");
  text += c.section_functions(integral) + c.section_functions(derivative);

  const auto cleared = [&](const detail::CSections& sections) { return c.section_rest(sections, c.literal(0)); };
  const bool follows_input = derivative.has_state() && !k.differentiates;
  std::string body =
      std::string(R"(/* At rest, all signals 0. */
static inline void NAME_reset(NAME_state *s)
{
)") + (integral.has_state() || derivative.has_state() ? "  int i;\n" : "") +
      cleared(integral) + cleared(derivative) + R"(  s->integrator = s->integrator_lost = @zero@;
  s->lag = s->track_output = s->unlimited = @zero@;
  s->output = @rest_output@;
  s->is_tracking = s->saturated = s->bad_input = 0;
}

/* Call once before the first step. */
static inline void NAME_init(NAME_state *s)
{
  NAME_reset(s);
}

/* At rest after signals that had been constant at these values: no kick of the derivative at the start. */
static inline void NAME_reset_at(NAME_state *s, REAL setpoint, REAL measured)
{
)" + (follows_input ? "  int i;\n" : "") +
      R"(  const REAL input = @derivative_setpoint_weight@ * setpoint - measured;
  if (!(input <= @most@ && input >= -@most@)) {
    s->bad_input = 1;
    return;
  }
  NAME_reset(s);
  s->lag = input;
)" + (follows_input ? c.section_rest(derivative, "s->lag") : "") +
      R"(}

/* The next output will be this one: call before every step while another source drives the plant. */
static inline void NAME_track(NAME_state *s, REAL output)
{
)" + (integral.has_state() ? "  int i;\n" : "") +
      R"(  if (!(output <= @most@ && output >= -@most@)) {
    s->bad_input = 1;
    return;
  }
  s->is_tracking = 1;
  s->track_output = output < @minimum@ ? @minimum@ : @maximum@ < output ? @maximum@ : output;
)" + cleared(integral) +
      R"(}

static inline REAL NAME_step(NAME_state *s, REAL setpoint, REAL measured)
{
  const REAL proportional_input = @setpoint_weight@ * setpoint - measured;
  const REAL difference_input = @derivative_setpoint_weight@ * setpoint - measured;
  const REAL error = setpoint - measured;
  const REAL largest = @largest_input@;
  const REAL proportional = @kp@ * proportional_input;
  const REAL difference = difference_input - s->lag;
  const REAL lagged = s->lag + @lag_share@ * difference;
  const REAL derivative_input = )" +
      (k.differentiates ? "difference * @inverse_lag_time@" : "lagged") + R"(;
  const REAL derivative_tapped = NAME_derivative_tapped(s, derivative_input);
  const REAL derivative = @kd@ * NAME_derivative_output(s, derivative_tapped);
  REAL integral_input = @ki@ * error;
  REAL integral_tapped = NAME_integral_tapped(s, integral_input);
  REAL integral_filtered = NAME_integral_output(s, integral_tapped);
  REAL sum = proportional + (s->integrator + @half_time@ * integral_filtered) + derivative;
  REAL excess, increment, next;
  if (!(proportional_input <= largest && proportional_input >= -largest && difference_input <= largest &&
        difference_input >= -largest && error <= largest && error >= -largest && sum <= @most@ && sum >= -@most@)) {
    s->bad_input = 1;
    return s->output;
  }
  s->bad_input = 0;
  if (s->is_tracking) {
    const REAL shift = s->track_output - sum;
    s->integrator += shift;
    s->integrator_lost = @zero@;
    sum = s->track_output;
    s->is_tracking = 0;
  }
  excess = sum > @maximum@ ? sum - @maximum@ : sum < @minimum@ ? sum - @minimum@ : @zero@;
  s->saturated = excess > @zero@ || excess < @zero@;
  if (s->saturated) {
)" + anti_windup_text(k.anti_windup) +
      R"(    const REAL change = @high_gain@ * correction;
    integral_input += correction;
    integral_tapped += @integral_tap@ * correction;
    integral_filtered += change;
    sum += @half_time@ * change;
  }
  s->output = sum > @maximum@ ? @maximum@ : sum < @minimum@ ? @minimum@ : sum;
  s->unlimited = sum;
)" + (integral.has_state() ? "  NAME_integral_advance(s, integral_input, integral_tapped);\n" : "") +
      (derivative.has_state() ? "  NAME_derivative_advance(s, derivative_input, derivative_tapped);\n" : "") +
      R"(  s->lag = lagged > @tiny@ || lagged < -@tiny@ ? lagged : @zero@;
  increment = @sample_time@ * integral_filtered + s->integrator_lost;
  next = s->integrator + increment;
  s->integrator_lost = increment - (next - s->integrator);
  s->integrator = next;
  return s->output;
}
)";
  const auto number = [&](Real value) { return c.literal(static_cast<double>(value)); };
  text += c.filled(body, {{"zero", c.literal(0)},
                          {"most", number(std::numeric_limits<Real>::max())},
                          {"largest_input", number(k.largest_input)},
                          {"tiny", number(detail::negligible_state<Real>)},
                          {"kp", number(k.kp)},
                          {"ki", number(k.ki)},
                          {"kd", number(k.kd)},
                          {"setpoint_weight", number(k.setpoint_weight)},
                          {"derivative_setpoint_weight", number(k.derivative_setpoint_weight)},
                          {"sample_time", number(k.sample_time)},
                          {"half_time", number(k.half_time)},
                          {"lag_share", number(k.lag_share)},
                          {"inverse_lag_time", number(k.inverse_lag_time)},
                          {"rest_output", number(std::clamp(Real(0), k.minimum, k.maximum))},
                          {"minimum", "(" + number(k.minimum) + ")"},
                          {"maximum", "(" + number(k.maximum) + ")"},
                          {"tracking_share", number(k.tracking_share)},
                          {"inverse_tracking", number(k.inverse_tracking)},
                          {"integral_tap", number(k.integral_tap)},
                          {"integral_gain", number(k.integral_gain)},
                          {"inverse_integral_gain", number(k.inverse_integral_gain)},
                          {"high_gain", number(static_cast<Real>(design.integral().high_gain))}});
  return c.closed(std::move(text));
}

}  // namespace

std::string c_header(const FractionalPidDesign& design, const CHeaderOptions& options) {
  return options.precision == Precision::float_type ? text_of<float>(design, options)
                                                    : text_of<double>(design, options);
}

}  // namespace frac
