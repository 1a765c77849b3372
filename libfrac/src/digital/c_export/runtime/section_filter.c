// SPDX-License-Identifier: BSD-3-Clause
// Taps and first-order sections of one filter, PREFIX: x = tapped(input), y = output(x), then advance(input, x).
// Follows the arrays NAME_PREFIX_tap, _rate and _weight, and the struct with the members PREFIX_past, _v, _lost and
// _leak.  What output() and advance() both need is multiplied once: without a floating-point unit that takes long.

static inline REAL NAME_PREFIX_tapped(const NAME_state *s, REAL input)
{
#if HAS_PREFIX_TAPS
  REAL even = NAME_PREFIX_tap[0] * input;
  REAL odd = NAME_PREFIX_tap[1] * s->PREFIX_past[0];
  int k;
  for (k = 2; k < PREFIX_TAPS; k += 2) {
    even += NAME_PREFIX_tap[k] * s->PREFIX_past[k - 1];
    odd += NAME_PREFIX_tap[k + 1] * s->PREFIX_past[k];
  }
  return even + odd;
#else
  (void)s;
  return input;
#endif
}

static inline REAL NAME_PREFIX_output(NAME_state *s, REAL x)
{
#if HAS_PREFIX_SECTIONS
  REAL lane[8] = {ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO};
  int i, j;
  for (i = 0; i < PREFIX_SIZE; i += 8) {
    for (j = 0; j < 8; ++j) {
#if PREFIX_GIVES_STATES
      const REAL part = NAME_PREFIX_weight[i + j] * s->PREFIX_v[i + j];
#else
      const REAL leak = NAME_PREFIX_rate[i + j] * s->PREFIX_v[i + j];
      s->PREFIX_leak[i + j] = leak;
      const REAL part = NAME_PREFIX_weight[i + j] * (x - leak);
#endif
      lane[j] = i == 0 ? part : lane[j] + part;
    }
  }
  /* The zero stands for one in every lane: it makes a sum of negative zeros positive. */
  return PREFIX_DIRECT * x +
         (ZERO + (((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]))));
#else
  (void)s;
  return PREFIX_DIRECT * x;
#endif
}
#if HAS_PREFIX_STATE

static inline void NAME_PREFIX_advance(NAME_state *s, REAL input, REAL x)
{
  int i;
#if HAS_PREFIX_TAPS
  for (i = PREFIX_TAPS - 1; i > 0; --i) s->PREFIX_past[i] = s->PREFIX_past[i - 1];
  s->PREFIX_past[0] = input;
#else
  (void)input;
#endif
#if HAS_PREFIX_SECTIONS
  for (i = 0; i < PREFIX_SIZE; ++i) {
    const REAL v = s->PREFIX_v[i];
#if PREFIX_GIVES_STATES
    const REAL leak = NAME_PREFIX_rate[i] * v;
#else
    const REAL leak = s->PREFIX_leak[i];
#endif
    const REAL increment = (x - leak) + s->PREFIX_lost[i];
    const REAL sum = v + increment;
    const REAL remainder = increment - (sum - v);
    const int matters = sum > TINY || sum < -TINY;
    s->PREFIX_v[i] = matters ? sum : ZERO;
    s->PREFIX_lost[i] = matters ? remainder : ZERO;
  }
#else
  (void)x;
#endif
}
#endif

