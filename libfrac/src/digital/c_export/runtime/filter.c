// SPDX-License-Identifier: BSD-3-Clause
// DigitalFilter of frac/digital/digital_filter.hpp, operation for operation, so that both give the same bits.
// Follows filter_state.h, section_filter.c for "section" and the arrays of pairs.

/* At rest. */
static inline void NAME_reset(NAME_state *s)
{
#if HAS_ARRAYS
  int i;
#endif
#if HAS_SECTION_TAPS
  for (i = 0; i < SECTION_TAPS; ++i) s->section_past[i] = ZERO;
#endif
#if HAS_SECTION_SECTIONS
  for (i = 0; i < SECTION_SIZE; ++i) s->section_v[i] = s->section_lost[i] = ZERO;
#endif
#if HAS_PAIRS
  for (i = 0; i < PAIRS; ++i) s->pair_re[i] = ZERO;
  for (i = 0; i < PAIRS; ++i) s->pair_im[i] = ZERO;
#endif
#if HAS_DIFFERENCES
  for (i = 0; i < DIFFERENCES; ++i) s->previous[i] = ZERO;
#endif
#if HAS_INTEGRATORS
  for (i = 0; i < INTEGRATORS; ++i) s->integral[i] = ZERO;
  for (i = 0; i < INTEGRATORS; ++i) s->integral_lost[i] = ZERO;
#endif
#if HAS_DEAD_TIME
  for (i = 0; i < DEAD_SAMPLES; ++i) s->waiting[i] = ZERO;
  s->oldest = 0;
#endif
#if HAS_NOTHING
  s->nothing = 0;
#endif
}

/* Call once before the first step. */
static inline void NAME_init(NAME_state *s)
{
  NAME_reset(s);
}

static inline REAL NAME_step(NAME_state *s, REAL sample)
{
  REAL x = sample, y;
#if HAS_SECTION_TAPS
  REAL input;
#endif
#if HAS_LOOPS
  int i;
#endif
#if HAS_DEAD_TIME
  x = s->waiting[s->oldest];
  s->waiting[s->oldest] = sample;
  s->oldest = s->oldest + 1 == DEAD_SAMPLES ? 0 : s->oldest + 1;
#endif
#if HAS_DIFFERENCES
  for (i = 0; i < DIFFERENCES; ++i) {
    const REAL change = (x - s->previous[i]) * INVERSE_TIME;
    s->previous[i] = x;
    x = change;
  }
#endif
#if HAS_SECTION_TAPS
  input = x;
  x = NAME_section_tapped(s, input);
#endif
  y = NAME_section_output(s, x);
#if HAS_SECTION_TAPS
  NAME_section_advance(s, input, x);
#elif HAS_SECTION_SECTIONS
  NAME_section_advance(s, x, x);
#endif
#if HAS_PAIRS
  for (i = 0; i < PAIRS; ++i) {
    const REAL re = s->pair_re[i] + (x - (NAME_pair_rate_re[i] * s->pair_re[i] - NAME_pair_rate_im[i] * s->pair_im[i]));
    const REAL im = s->pair_im[i] - (NAME_pair_rate_re[i] * s->pair_im[i] + NAME_pair_rate_im[i] * s->pair_re[i]);
    y += NAME_pair_weight_re[i] * s->pair_re[i] - NAME_pair_weight_im[i] * s->pair_im[i];
    s->pair_re[i] = re > TINY || re < -TINY ? re : ZERO;
    s->pair_im[i] = im > TINY || im < -TINY ? im : ZERO;
  }
#endif
#if HAS_INTEGRATORS
  for (i = 0; i < INTEGRATORS; ++i) {
    const REAL output = s->integral[i] + PRESENT_SHARE * y;
    const REAL increment = TIME * y + s->integral_lost[i];
    const REAL next = s->integral[i] + increment;
    s->integral_lost[i] = increment - (next - s->integral[i]);
    s->integral[i] = next;
    y = output;
  }
#endif
  return y;
}
