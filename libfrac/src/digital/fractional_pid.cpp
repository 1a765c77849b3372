// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/fractional_pid.hpp"

#include <algorithm>
#include <cmath>

#include "section_kernel.hpp"
#include "tap_line.hpp"

namespace frac {
namespace {

template <typename Real>
bool is_sound(Real value) noexcept {
  return std::abs(value) <= std::numeric_limits<Real>::max();
}

}  // namespace

template <typename Real>
PidCoefficients<Real>::PidCoefficients(const FractionalPidDesign& design) noexcept {
  const FractionalPidConfig& config = design.config();
  const FractionalPidGains& gains = config.gains;
  const double time = config.sample_time;
  kp = static_cast<Real>(gains.kp);
  ki = static_cast<Real>(gains.ki);
  kd = static_cast<Real>(gains.kd);
  setpoint_weight = static_cast<Real>(config.setpoint_weight);
  derivative_setpoint_weight = static_cast<Real>(config.derivative_setpoint_weight);
  sample_time = static_cast<Real>(time);
  half_time = static_cast<Real>(time / 2);
  inverse_lag_time = static_cast<Real>(1 / (config.derivative_filter_time + time));
  lag_share = static_cast<Real>(time / (config.derivative_filter_time + time));
  differentiates = gains.mu >= 1;
  const double most = std::numeric_limits<Real>::max();
  minimum = static_cast<Real>(std::clamp(config.minimum, -most, most));
  maximum = static_cast<Real>(std::clamp(config.maximum, -most, most));
  anti_windup = gains.ki != 0 ? config.anti_windup : AntiWindup::none;
  const double gain = time / 2 * design.integral().high_gain;
  const double tracking = design.tracking_time() > 0 ? std::pow(design.tracking_time(), -gains.lambda) : 0;
  integral_tap = design.integral().taps.empty() ? Real(1) : static_cast<Real>(design.integral().taps[0]);
  integral_gain = static_cast<Real>(gain);
  inverse_integral_gain = static_cast<Real>(1 / gain);
  inverse_tracking = static_cast<Real>(tracking);
  tracking_share = static_cast<Real>(1 / (1 + gain * tracking));
}

template <typename Real>
void FractionalPid<Real>::Filter::set(const PidFilter& design) noexcept {
  const auto fill = [](auto& numbers, const std::vector<double>& from, Real beyond) {
    std::fill(std::transform(from.begin(), from.end(), numbers.begin(), [](double x) { return static_cast<Real>(x); }),
              numbers.end(), beyond);
  };
  output = design.sections.output;
  direct = static_cast<Real>(design.sections.direct);
  high_gain = static_cast<Real>(design.high_gain);
  tap_count = design.taps.size();
  sections = design.sections.rates.size();
  size = detail::whole_groups(sections);
  fill(tap, design.taps, 0);
  fill(rate, design.sections.rates, 1);
  fill(weight, design.sections.weights, 0);
}

template <typename Real>
Real FractionalPid<Real>::Filter::through_taps(Real input) const noexcept {
  static_assert(PidFilter::most_taps <= kept);
  if (tap_count == 0) return input;
  const Real* const before = inputs();
  return detail::tapped(
      tap.data(), tap_count, [before](std::size_t k) { return before[k]; }, input);
}

template <typename Real>
Real FractionalPid<Real>::Filter::output_for(Real x) const noexcept {
  if (size == 0) return direct * x;
  const Real sum = output == SectionOutput::state
                       ? detail::state_sum(weight.data(), state.data(), size)
                       : detail::change_sum(rate.data(), weight.data(), state.data(), size, x);
  return direct * x + sum;
}

template <typename Real>
void FractionalPid<Real>::Filter::advance(Real input, Real x) noexcept {
  newest = (newest + kept - 1) % kept;
  past[newest] = past[newest + kept] = input;
  if (size != 0) detail::advance_states<Real>({rate.data(), weight.data(), state.data(), lost.data(), size}, x);
}

template <typename Real>
void FractionalPid<Real>::Filter::rest_at(Real input) noexcept {
  past.fill(input);
  const Real x = through_taps(input);
  for (std::size_t i = 0; i < size; ++i) {
    state[i] = x / rate[i];
    lost[i] = 0;
  }
}

// A state times its rate is the input seen through a low-pass filter, a smooth function of the logarithm of the corner
// frequency: the new filter's are read off between the old one's.  Faster corners see the input itself; slower ones
// what the slowest saw.
template <typename Real>
void FractionalPid<Real>::Filter::inherit(const Filter& old, Real input, Real factor, Real time_ratio) noexcept {
  newest = 0;
  past.fill(input);
  // Samples of another sample time are not those between which the new one's lie.
  if (time_ratio == 1) {
    for (std::size_t k = 0; k < kept; ++k) past[k] = past[k + kept] = old.inputs()[k] * factor;
  }
  const Real x = through_taps(input);
  std::size_t k = 0;
  for (std::size_t i = 0; i < size; ++i) {
    lost[i] = 0;
    Real seen = x;
    const Real corner = rate[i] * time_ratio;
    if (i < sections && old.sections > 0) {
      while (k < old.sections && old.rate[k] < corner) ++k;
      if (k == 0) {
        seen = old.rate[0] * old.state[0];
      } else if (k < old.sections) {
        const Real below = old.rate[k - 1] * old.state[k - 1];
        const Real above = old.rate[k] * old.state[k];
        seen = below + (above - below) * (std::log(corner / old.rate[k - 1]) / std::log(old.rate[k] / old.rate[k - 1]));
      }
      seen *= factor;
    }
    state[i] = i < sections ? seen / rate[i] : 0;
  }
}

template <typename Real>
FractionalPid<Real>::FractionalPid(const FractionalPidConfig& config) : FractionalPid(FractionalPidDesign(config)) {}

template <typename Real>
FractionalPid<Real>::FractionalPid(const FractionalPidDesign& design) noexcept {
  set(design);
  reset();
}

template <typename Real>
std::optional<FractionalPid<Real>> FractionalPid<Real>::try_make(const FractionalPidConfig& config, std::string& why) {
  try {
    return FractionalPid(config);
  } catch (const std::exception& failure) {
    why = failure.what();
    return std::nullopt;
  }
}

template <typename Real>
void FractionalPid<Real>::set(const FractionalPidDesign& design) noexcept {
  c_ = PidCoefficients<Real>(design);
  integral_.set(design.integral());
  derivative_.set(design.derivative());
}

template <typename Real>
typename FractionalPid<Real>::Parts FractionalPid<Real>::parts(const Inputs& in) const noexcept {
  Parts p;
  p.proportional = c_.kp * in.proportional;
  const Real difference = in.derivative - lag_;
  p.lagged = lag_ + c_.lag_share * difference;
  p.derivative_input = c_.differentiates ? difference * c_.inverse_lag_time : p.lagged;
  p.derivative_tapped = derivative_.through_taps(p.derivative_input);
  p.derivative = c_.kd * derivative_.output_for(p.derivative_tapped);
  p.integral_input = c_.ki * in.error;
  p.integral_tapped = integral_.through_taps(p.integral_input);
  p.integral_filtered = integral_.output_for(p.integral_tapped);
  p.integral = integrator_ + c_.half_time * p.integral_filtered;
  p.sum = p.proportional + p.integral + p.derivative;
  return p;
}

template <typename Real>
Real FractionalPid<Real>::advance(const Inputs& in) noexcept {
  const bool inputs_are_sound = std::abs(in.proportional) <= c_.largest_input &&
                                std::abs(in.derivative) <= c_.largest_input && std::abs(in.error) <= c_.largest_input;
  Parts p = inputs_are_sound ? parts(in) : Parts{};
  if (!inputs_are_sound || !is_sound(p.sum)) {
    bad_input_ = true;
    return output_;
  }
  bad_input_ = false;
  if (is_tracking_) {
    const Real shift = track_output_ - p.sum;
    integrator_ += shift;
    integrator_lost_ = 0;
    p.integral += shift;
    p.sum = track_output_;
    is_tracking_ = false;
  }
  const Real excess = p.sum > c_.maximum ? p.sum - c_.maximum : p.sum < c_.minimum ? p.sum - c_.minimum : 0;
  saturated_ = excess != 0;
  if (saturated_) {
    Real correction = 0;
    if (c_.anti_windup == AntiWindup::back_calculation) {
      // sum = what it would be + integral_gain (limit - sum)/tracking_time^lambda, solved for the correction.
      correction = -(excess * c_.tracking_share) * c_.inverse_tracking;
    } else if (c_.anti_windup == AntiWindup::conditional_integration) {
      const Real pushes = p.integral_input * c_.integral_gain;
      if ((excess > 0) == (pushes > 0)) {
        const Real needed = excess * c_.inverse_integral_gain;
        correction = std::abs(needed) < std::abs(p.integral_input) ? -needed : -p.integral_input;
      }
    }
    const Real change = integral_.high_gain * correction;
    p.integral_input += correction;
    p.integral_tapped += c_.integral_tap * correction;
    p.integral_filtered += change;
    p.sum += c_.half_time * change;
  }
  output_ = p.sum > c_.maximum ? c_.maximum : p.sum < c_.minimum ? c_.minimum : p.sum;

  unlimited_ = p.sum;
  integral_.advance(p.integral_input, p.integral_tapped);
  derivative_.advance(p.derivative_input, p.derivative_tapped);
  lag_ = std::abs(p.lagged) > detail::negligible_state<Real> ? p.lagged : 0;
  const Real increment = c_.sample_time * p.integral_filtered + integrator_lost_;
  const Real sum = integrator_ + increment;
  integrator_lost_ = increment - (sum - integrator_);
  integrator_ = sum;
  last_ = in;
  return output_;
}

template <typename Real>
Real FractionalPid<Real>::step(Real setpoint, Real measured) noexcept {
  return advance({c_.setpoint_weight * setpoint - measured, c_.derivative_setpoint_weight * setpoint - measured,
                  setpoint - measured, setpoint});
}

template <typename Real>
void FractionalPid<Real>::track(Real output) noexcept {
  if (!is_sound(output)) {
    bad_input_ = true;
    return;
  }
  is_tracking_ = true;
  track_output_ = std::clamp(output, c_.minimum, c_.maximum);
  integral_.rest_at(0);
}

template <typename Real>
void FractionalPid<Real>::reset() noexcept {
  reset(0, 0);
}

template <typename Real>
void FractionalPid<Real>::reset(Real setpoint, Real measured) noexcept {
  const Real input = c_.derivative_setpoint_weight * setpoint - measured;
  if (!is_sound(input)) {
    bad_input_ = true;
    return;
  }
  integral_.rest_at(0);
  integrator_ = integrator_lost_ = 0;
  lag_ = input;
  derivative_.rest_at(c_.differentiates ? 0 : lag_);
  is_tracking_ = false;
  last_ = {};
  unlimited_ = 0;
  // The output that stands after a refused first input obeys the limits too.
  output_ = std::clamp(Real(0), c_.minimum, c_.maximum);
  saturated_ = bad_input_ = false;
}

template <typename Real>
void FractionalPid<Real>::adopt(const FractionalPidDesign& design) noexcept {
  const Parts before = parts(last_);
  const FractionalPid old = *this;
  set(design);
  const Real time_ratio = old.c_.sample_time / c_.sample_time;
  integral_.inherit(old.integral_, c_.ki * last_.error, old.c_.ki != 0 ? c_.ki / old.c_.ki : 0, time_ratio);
  last_.proportional += (c_.setpoint_weight - old.c_.setpoint_weight) * last_.setpoint;
  const Real shift = (c_.derivative_setpoint_weight - old.c_.derivative_setpoint_weight) * last_.setpoint;
  last_.derivative += shift;
  lag_ += shift;
  const Real difference = last_.derivative - lag_;
  const Real now = c_.differentiates ? difference * c_.inverse_lag_time : lag_ + c_.lag_share * difference;
  if (c_.differentiates == old.c_.differentiates && shift == 0) {
    derivative_.inherit(old.derivative_, now, 1, time_ratio);
  } else {
    derivative_.rest_at(now);
  }
  integrator_ += before.sum - parts(last_).sum;
  output_ = std::clamp(output_, c_.minimum, c_.maximum);
  track_output_ = std::clamp(track_output_, c_.minimum, c_.maximum);
}

template struct PidCoefficients<float>;
template struct PidCoefficients<double>;
template class FractionalPid<float>;
template class FractionalPid<double>;

}  // namespace frac
