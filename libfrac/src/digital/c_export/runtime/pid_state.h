// SPDX-License-Identifier: BSD-3-Clause
// State of a fractional PID: the filters of its integral and its derivative, and what is around them.

typedef struct {
#if IS_TUNED
  REAL kp, ki, kd, setpoint_weight, derivative_setpoint_weight, minimum, maximum; /* to be set from outside */
#endif
#if HAS_INTEGRAL_TAPS
  REAL integral_past[INTEGRAL_TAPS]; /* inputs, the newest first */
#endif
#if HAS_INTEGRAL_SECTIONS
  REAL integral_v[INTEGRAL_SIZE];    /* states */
  REAL integral_lost[INTEGRAL_SIZE]; /* of them, to rounding */
#if HAS_INTEGRAL_LEAK
  REAL integral_leak[INTEGRAL_SIZE]; /* leaving them in this step */
#endif
#endif
#if HAS_DERIVATIVE_TAPS
  REAL derivative_past[DERIVATIVE_TAPS]; /* inputs, the newest first */
#endif
#if HAS_DERIVATIVE_SECTIONS
  REAL derivative_v[DERIVATIVE_SIZE];    /* states */
  REAL derivative_lost[DERIVATIVE_SIZE]; /* of them, to rounding */
#if HAS_DERIVATIVE_LEAK
  REAL derivative_leak[DERIVATIVE_SIZE]; /* leaving them in this step */
#endif
#endif
  REAL integrator;
  REAL integrator_lost;
  REAL lag;
  REAL track_output;
  REAL output;    /* the last one */
  REAL unlimited; /* the last one before the limits */
  int is_tracking;
  int saturated; /* 1: the last output was cut at a limit */
  int bad_input; /* 1: the last input was refused and the output held */
} NAME_state;

