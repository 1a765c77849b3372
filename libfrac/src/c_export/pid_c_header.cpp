#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "../digital/section_kernel.hpp"
#include "c_text.hpp"

namespace frac {
namespace {

detail::CSections sections_of(const PidOperator& design, const char* prefix) {
  const auto size = static_cast<std::ptrdiff_t>(design.size);
  return {prefix,
          design.output,
          design.direct,
          {design.rates.begin(), design.rates.begin() + size},
          {design.weights.begin(), design.weights.begin() + size}};
}

std::string clear_text(const detail::CSections& sections) {
  if (sections.rates.empty()) return "";
  return "  for (i = 0; i < " + std::to_string(sections.rates.size()) + "; ++i) s->" + sections.prefix + "_v[i] = s->" +
         sections.prefix + "_lost[i] = @zero@;\n";
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

  const bool has_sections = !integral.rates.empty() || !derivative.rates.empty();
  std::string body = std::string(R"(/* At rest, all signals 0. */
static inline void NAME_reset(NAME_state *s)
{
)") + (has_sections ? "  int i;\n" : "") +
                     clear_text(integral) + clear_text(derivative) + R"(  s->integrator = s->integrator_lost = @zero@;
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
)" + (derivative.rates.empty() || k.differentiates ? "" : "  int i;\n") +
                     R"(  const REAL input = @derivative_setpoint_weight@ * setpoint - measured;
  if (!(input <= @most@ && input >= -@most@)) {
    s->bad_input = 1;
    return;
  }
  NAME_reset(s);
  s->lag = input;
)" +
                     (derivative.rates.empty() || k.differentiates
                          ? ""
                          : "  for (i = 0; i < " + std::to_string(derivative.rates.size()) +
                                "; ++i) s->derivative_v[i] = s->lag / NAME_derivative_rate[i];\n") +
                     R"(}

/* The next output will be this one: call before every step while another source drives the plant. */
static inline void NAME_track(NAME_state *s, REAL output)
{
)" + (integral.rates.empty() ? "" : "  int i;\n") +
                     R"(  if (!(output <= @most@ && output >= -@most@)) {
    s->bad_input = 1;
    return;
  }
  s->is_tracking = 1;
  s->track_output = output < @minimum@ ? @minimum@ : @maximum@ < output ? @maximum@ : output;
)" + clear_text(integral) +
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
  const REAL derivative = @kd@ * NAME_derivative_output(s, derivative_input);
  REAL integral_input = @ki@ * error;
  REAL integral_filtered = NAME_integral_output(s, integral_input);
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
    integral_filtered += change;
    sum += @half_time@ * change;
  }
  s->output = sum > @maximum@ ? @maximum@ : sum < @minimum@ ? @minimum@ : sum;
  s->unlimited = sum;
)" + (integral.rates.empty() ? "" : "  NAME_integral_advance(s, integral_input);\n") +
                     (derivative.rates.empty() ? "" : "  NAME_derivative_advance(s, derivative_input);\n") +
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
