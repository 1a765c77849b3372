// SPDX-License-Identifier: BSD-3-Clause
// The fractional PID of frac/digital/fractional_pid.hpp, operation for operation, so that both give the same bits.
// Follows pid_state.h and section_filter.c for "integral" and "derivative".

/* At rest, all signals 0. */
static inline void NAME_reset(NAME_state *s)
{
#if HAS_ANY_STATE
  int i;
#endif
#if HAS_INTEGRAL_TAPS
  for (i = 0; i < INTEGRAL_TAPS; ++i) s->integral_past[i] = ZERO;
#endif
#if HAS_INTEGRAL_SECTIONS
  for (i = 0; i < INTEGRAL_SIZE; ++i) s->integral_v[i] = s->integral_lost[i] = ZERO;
#endif
#if HAS_DERIVATIVE_TAPS
  for (i = 0; i < DERIVATIVE_TAPS; ++i) s->derivative_past[i] = ZERO;
#endif
#if HAS_DERIVATIVE_SECTIONS
  for (i = 0; i < DERIVATIVE_SIZE; ++i) s->derivative_v[i] = s->derivative_lost[i] = ZERO;
#endif
  s->integrator = s->integrator_lost = ZERO;
  s->lag = s->track_output = s->unlimited = ZERO;
  s->output = REST_OUTPUT;
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
#if FOLLOWS_INPUT
  int i;
#endif
  const REAL input = DERIVATIVE_SETPOINT_WEIGHT * setpoint - measured;
  if (!(input <= MOST && input >= -MOST)) {
    s->bad_input = 1;
    return;
  }
  NAME_reset(s);
  s->lag = input;
#if FOLLOWS_INPUT
#if HAS_DERIVATIVE_TAPS
  for (i = 0; i < DERIVATIVE_TAPS; ++i) s->derivative_past[i] = s->lag;
#endif
#if HAS_DERIVATIVE_SECTIONS
  for (i = 0; i < DERIVATIVE_SIZE; ++i) {
    s->derivative_v[i] = NAME_derivative_tapped(s, s->lag) / NAME_derivative_rate[i];
    s->derivative_lost[i] = ZERO;
  }
#endif
#endif
}

/* The next output will be this one: call before every step while another source drives the plant. */
static inline void NAME_track(NAME_state *s, REAL output)
{
#if HAS_INTEGRAL_STATE
  int i;
#endif
  if (!(output <= MOST && output >= -MOST)) {
    s->bad_input = 1;
    return;
  }
  s->is_tracking = 1;
  s->track_output = output < MINIMUM ? MINIMUM : MAXIMUM < output ? MAXIMUM : output;
#if HAS_INTEGRAL_TAPS
  for (i = 0; i < INTEGRAL_TAPS; ++i) s->integral_past[i] = ZERO;
#endif
#if HAS_INTEGRAL_SECTIONS
  for (i = 0; i < INTEGRAL_SIZE; ++i) s->integral_v[i] = s->integral_lost[i] = ZERO;
#endif
}

static inline REAL NAME_step(NAME_state *s, REAL setpoint, REAL measured)
{
  const REAL proportional_input = SETPOINT_WEIGHT * setpoint - measured;
  const REAL difference_input = DERIVATIVE_SETPOINT_WEIGHT * setpoint - measured;
  const REAL error = setpoint - measured;
  const REAL largest = LARGEST_INPUT;
  const REAL proportional = KP * proportional_input;
  const REAL difference = difference_input - s->lag;
  const REAL lagged = s->lag + LAG_SHARE * difference;
#if DIFFERENTIATES
  const REAL derivative_input = difference * INVERSE_LAG_TIME;
#else
  const REAL derivative_input = lagged;
#endif
  const REAL derivative_tapped = NAME_derivative_tapped(s, derivative_input);
  const REAL derivative = KD * NAME_derivative_output(s, derivative_tapped);
  REAL integral_input = KI * error;
  REAL integral_tapped = NAME_integral_tapped(s, integral_input);
  REAL integral_filtered = NAME_integral_output(s, integral_tapped);
  REAL sum = proportional + (s->integrator + HALF_TIME * integral_filtered) + derivative;
  REAL excess, increment, next;
  if (!(proportional_input <= largest && proportional_input >= -largest && difference_input <= largest &&
        difference_input >= -largest && error <= largest && error >= -largest && sum <= MOST && sum >= -MOST)) {
    s->bad_input = 1;
    return s->output;
  }
  s->bad_input = 0;
  if (s->is_tracking) {
    const REAL shift = s->track_output - sum;
    s->integrator += shift;
    s->integrator_lost = ZERO;
    sum = s->track_output;
    s->is_tracking = 0;
  }
  excess = sum > MAXIMUM ? sum - MAXIMUM : sum < MINIMUM ? sum - MINIMUM : ZERO;
  s->saturated = excess > ZERO || excess < ZERO;
  if (s->saturated) {
#if BACK_CALCULATION
    const REAL correction = -(excess * TRACKING_SHARE) * INVERSE_TRACKING;
#elif CONDITIONAL_INTEGRATION
    const REAL pushes = integral_input * INTEGRAL_GAIN;
    REAL correction = ZERO;
    if ((excess > ZERO) == (pushes > ZERO)) {
      const REAL needed = excess * INVERSE_INTEGRAL_GAIN;
      const REAL size_needed = needed < ZERO ? -needed : needed;
      const REAL size_input = integral_input < ZERO ? -integral_input : integral_input;
      correction = size_needed < size_input ? -needed : -integral_input;
    }
#else
    const REAL correction = ZERO;
#endif
    const REAL change = HIGH_GAIN * correction;
    integral_input += correction;
    integral_tapped += INTEGRAL_TAP * correction;
    integral_filtered += change;
    sum += HALF_TIME * change;
  }
  s->output = sum > MAXIMUM ? MAXIMUM : sum < MINIMUM ? MINIMUM : sum;
  s->unlimited = sum;
#if HAS_INTEGRAL_STATE
  NAME_integral_advance(s, integral_input, integral_tapped);
#endif
#if HAS_DERIVATIVE_STATE
  NAME_derivative_advance(s, derivative_input, derivative_tapped);
#endif
  s->lag = lagged > TINY || lagged < -TINY ? lagged : ZERO;
  increment = SAMPLE_TIME * integral_filtered + s->integrator_lost;
  next = s->integrator + increment;
  s->integrator_lost = increment - (next - s->integrator);
  s->integrator = next;
  return s->output;
}
