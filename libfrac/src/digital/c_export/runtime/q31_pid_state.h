// SPDX-License-Identifier: BSD-3-Clause
// State of a fractional PID in whole numbers.

typedef struct {
#if HAS_INTEGRAL_TAPS
  int32_t integral_past[INTEGRAL_PAST]; /* what the taps took in, the newest first */
#endif
#if HAS_DERIVATIVE_TAPS
  int32_t derivative_past[DERIVATIVE_PAST];
#endif
#if HAS_INTEGRAL_SECTIONS
  int64_t integral_part[INTEGRAL_SIZE];
#endif
#if HAS_DERIVATIVE_SECTIONS
  int64_t derivative_part[DERIVATIVE_SIZE];
#endif
#if HAS_DERIVATIVE
  int64_t lag; /* fraction of 4 input ranges times 2^60 */
#endif
  int64_t integrator;   /* fraction of the output range times 2^INTEGRATOR_BITS */
  int32_t track_output;
  int32_t output; /* the last one */
  int is_tracking;
  int saturated; /* 1: the last output was cut at a limit */
} NAME_state;

