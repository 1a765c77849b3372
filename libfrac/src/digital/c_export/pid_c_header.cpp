// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <string>

#include "c_text.hpp"
#include "runtime_text.hpp"
#include "tuned_header.hpp"

namespace frac {
namespace {

template <typename Real>
std::string text_of(const FractionalPidDesign& design, const CHeaderOptions& options, bool is_tuned) {
  const detail::CText c(options);
  const PidCoefficients<Real> k(design);
  const auto sections_of = [](const char* prefix, const PidFilter& filter) {
    return detail::c_sections(prefix, filter.taps, filter.sections);
  };
  const detail::CSections integral = sections_of("integral", design.integral());
  const detail::CSections derivative = sections_of("derivative", design.derivative());

  const auto number = [&](Real value) { return c.literal(static_cast<double>(value)); };
  detail::CWords words{{"MOST", number(std::numeric_limits<Real>::max())},
                       {"LARGEST_INPUT", number(k.largest_input)},
                       {"KP", number(k.kp)},
                       {"KI", number(k.ki)},
                       {"KD", number(k.kd)},
                       {"SETPOINT_WEIGHT", number(k.setpoint_weight)},
                       {"DERIVATIVE_SETPOINT_WEIGHT", number(k.derivative_setpoint_weight)},
                       {"SAMPLE_TIME", number(k.sample_time)},
                       {"HALF_TIME", number(k.half_time)},
                       {"LAG_SHARE", number(k.lag_share)},
                       {"INVERSE_LAG_TIME", number(k.inverse_lag_time)},
                       {"REST_OUTPUT", number(std::clamp(Real(0), k.minimum, k.maximum))},
                       {"MINIMUM", "(" + number(k.minimum) + ")"},
                       {"MAXIMUM", "(" + number(k.maximum) + ")"},
                       {"TRACKING_SHARE", number(k.tracking_share)},
                       {"INVERSE_TRACKING", number(k.inverse_tracking)},
                       {"INTEGRAL_TAP", number(k.integral_tap)},
                       {"INTEGRAL_GAIN", number(k.integral_gain)},
                       {"INVERSE_INTEGRAL_GAIN", number(k.inverse_integral_gain)},
                       {"HIGH_GAIN", number(static_cast<Real>(design.integral().high_gain))}};
  if (is_tuned) {
    words["KP"] = "s->kp";
    words["KI"] = "s->ki";
    words["KD"] = "s->kd";
    words["SETPOINT_WEIGHT"] = "s->setpoint_weight";
    words["DERIVATIVE_SETPOINT_WEIGHT"] = "s->derivative_setpoint_weight";
    words["MINIMUM"] = "s->minimum";
    words["MAXIMUM"] = "s->maximum";
    words["REST_OUTPUT"] = "s->minimum > 0 ? s->minimum : s->maximum < 0 ? s->maximum : 0";
  }
  detail::CConditions conditions{{"IS_TUNED", is_tuned},
                                 {"HAS_ANY_STATE", integral.has_state() || derivative.has_state()},
                                 {"DIFFERENTIATES", k.differentiates},
                                 {"FOLLOWS_INPUT", derivative.has_state() && !k.differentiates},
                                 {"BACK_CALCULATION", k.anti_windup == AntiWindup::back_calculation},
                                 {"CONDITIONAL_INTEGRATION", k.anti_windup == AntiWindup::conditional_integration}};
  describe(integral, words, conditions);
  describe(derivative, words, conditions);
  return c.closed(c.opening(options.comment) + c.filled(detail::runtime::pid_state, words, conditions) +
                  c.section_functions(integral, is_tuned) + c.section_functions(derivative, is_tuned) +
                  c.filled(detail::runtime::pid, words, conditions));
}

std::string text_of(const FractionalPidDesign& design, const CHeaderOptions& options, bool is_tuned) {
  return options.precision == Precision::float_type ? text_of<float>(design, options, is_tuned)
                                                    : text_of<double>(design, options, is_tuned);
}

}  // namespace

std::string c_header(const FractionalPidDesign& design, const CHeaderOptions& options) {
  return text_of(design, options, false);
}

std::string detail::tuned_c_header(const FractionalPidDesign& design, const CHeaderOptions& options) {
  return text_of(design, options, true);
}

}  // namespace frac
