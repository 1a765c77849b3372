// SPDX-License-Identifier: BSD-3-Clause
// The fractional PID of frac/digital/fractional_pid.hpp in whole numbers, for processors without a floating-point unit.
// Follows q31_pid_state.h and q31_section.c for "integral" and "derivative".  Set-point and measured value are fractions
// of the input range times 2^31, outputs of the output range.  Within a step, errors are fractions of 4 input ranges
// times 2^30, which leaves room for what anti-windup adds; the output is summed as a fraction of its range times 2^48.

static inline int64_t NAME_limited(int64_t value, int64_t limit)
{
  return value > limit ? limit : value < -limit ? -limit : value;
}

/* At rest, all signals 0. */
static inline void NAME_reset(NAME_state *s)
{
#if HAS_ANY_STATE
  int i;
#endif
#if HAS_INTEGRAL_TAPS
  for (i = 0; i < INTEGRAL_PAST; ++i) s->integral_past[i] = 0;
#endif
#if HAS_DERIVATIVE_TAPS
  for (i = 0; i < DERIVATIVE_PAST; ++i) s->derivative_past[i] = 0;
#endif
#if HAS_INTEGRAL_SECTIONS
  for (i = 0; i < INTEGRAL_SIZE; ++i) s->integral_part[i] = 0;
#endif
#if HAS_DERIVATIVE_SECTIONS
  for (i = 0; i < DERIVATIVE_SIZE; ++i) s->derivative_part[i] = 0;
#endif
#if HAS_DERIVATIVE
  s->lag = 0;
#endif
  s->integrator = 0;
  s->track_output = 0;
  s->output = REST_OUTPUT;
  s->is_tracking = s->saturated = 0;
}

/* Call once before the first step. */
static inline void NAME_init(NAME_state *s)
{
  NAME_reset(s);
}

/* The next output will be this one: call before every step while another source drives the plant. */
static inline void NAME_track(NAME_state *s, int32_t output)
{
#if HAS_INTEGRAL_STATE
  int i;
#endif
#if HAS_INTEGRAL_TAPS
  for (i = 0; i < INTEGRAL_PAST; ++i) s->integral_past[i] = 0;
#endif
#if HAS_INTEGRAL_SECTIONS
  for (i = 0; i < INTEGRAL_SIZE; ++i) s->integral_part[i] = 0;
#endif
  s->is_tracking = 1;
  s->track_output = output < MINIMUM ? MINIMUM : output > MAXIMUM ? MAXIMUM : output;
}

/* Shifts of negative numbers keep the sign, as compilers for all processors do. */
static inline int32_t NAME_step(NAME_state *s, int32_t setpoint, int32_t measured)
{
  const int64_t lowest = (int64_t)MINIMUM * 131072, highest = (int64_t)MAXIMUM * 131072;
  const int64_t largest = (int64_t)1 << INTEGRATOR_LIMIT_BITS; /* 16 output ranges */
  const int32_t half = setpoint >> 1;
  const int32_t error = half - (measured >> 1); /* fraction of the input range times 2^30 */
  const int32_t proportional = error - (int32_t)(((int64_t)SETPOINT_GAP * half) >> 30);
  int64_t sum = (((int64_t)KP * proportional) >> KP_SHIFT) + (s->integrator >> INTEGRATOR_EXTRA);
  int64_t excess;
#if HAS_INTEGRAL
  int32_t integral_input = error >> 2;
#if HAS_INTEGRAL_TAPS
  int32_t integral_x = NAME_integral_tapped(s, integral_input);
#endif
  int64_t increment = INTEGRAL_OUTPUT >> INTEGRAL_SHIFT;
#endif
#if HAS_DERIVATIVE
  const int32_t input = (error - (int32_t)(((int64_t)DERIVATIVE_SETPOINT_GAP * half) >> 30)) >> 2;
  const int32_t difference = input - (int32_t)((s->lag + ((int64_t)1 << 29)) >> 30);
  int32_t derivative_input;
#if HAS_DERIVATIVE_TAPS
  int32_t derivative_x;
#endif
  s->lag += (int64_t)LAG_SHARE * difference;
#if FOLLOWS_LAG
  derivative_input = (int32_t)((s->lag + ((int64_t)1 << 29)) >> 30);
#else
  derivative_input = difference;
#endif
#if HAS_DERIVATIVE_TAPS
  derivative_x = NAME_derivative_tapped(s, derivative_input);
#endif
  sum += DERIVATIVE_OUTPUT >> DERIVATIVE_SHIFT;
#if HAS_DERIVATIVE_TAPS_ALONE
  NAME_derivative_advance(s, derivative_input);
#elif HAS_DERIVATIVE_TAPS
  NAME_derivative_advance(s, derivative_input, derivative_x);
#elif HAS_DERIVATIVE_SECTIONS
  NAME_derivative_advance(s, derivative_input);
#endif
#endif
#if HAS_INTEGRAL
  sum += increment >> INTEGRATOR_HALVED;
#endif
  if (s->is_tracking) {
    const int64_t shift = NAME_limited((int64_t)s->track_output * 131072 - sum, (int64_t)1 << 52);
    s->integrator = NAME_limited(s->integrator + shift * ((int64_t)1 << INTEGRATOR_EXTRA), largest);
    sum += shift;
    s->is_tracking = 0;
  }
  excess = sum > highest ? sum - highest : sum < lowest ? sum - lowest : 0;
  s->saturated = excess != 0;
#if BACK_CALCULATION
  if (s->saturated) {
    const int64_t wanted = -((TRACKING * NAME_limited(excess >> 18, INT32_MAX)) >> TRACKING_SHIFT);
    const int64_t limited = NAME_limited(integral_input + wanted, ((int64_t)1 << 30) - 1);
    const int64_t change = (HIGH_GAIN * (limited - integral_input)) >> HIGH_GAIN_SHIFT;
    integral_input = (int32_t)limited;
#if HAS_INTEGRAL_TAPS
    integral_x = NAME_integral_tapped(s, integral_input);
#endif
    increment += change;
    sum += change >> INTEGRATOR_HALVED;
  }
#endif
  sum = (sum + 65536) >> 17;
  s->output = sum > MAXIMUM ? MAXIMUM : sum < MINIMUM ? MINIMUM : (int32_t)sum;
#if HAS_INTEGRAL
  s->integrator = NAME_limited(s->integrator + increment, largest);
#if HAS_INTEGRAL_TAPS_ALONE
  NAME_integral_advance(s, integral_input);
#elif HAS_INTEGRAL_TAPS
  NAME_integral_advance(s, integral_input, integral_x);
#elif HAS_INTEGRAL_SECTIONS
  NAME_integral_advance(s, integral_input);
#endif
#endif
  return s->output;
}
