// SPDX-License-Identifier: BSD-3-Clause
// A filter in whole numbers, for processors without a floating-point unit.  Follows q31_filter_state.h, q31_section.c
// for "section" and the arrays of pairs.  Samples are fractions of the input range times 2^31, outputs of the output
// range.

/* At rest. */
static inline void NAME_reset(NAME_state *s)
{
#if HAS_ARRAYS
  int i;
#endif
#if HAS_SECTION_TAPS
  for (i = 0; i < SECTION_PAST; ++i) s->section_past[i] = 0;
#endif
#if HAS_SECTION_SECTIONS
  for (i = 0; i < SECTION_SIZE; ++i) s->section_part[i] = 0;
#endif
#if HAS_PAIRS
  for (i = 0; i < PAIRS; ++i) s->pair_re[i] = s->pair_im[i] = 0;
#endif
#if HAS_INTEGRATOR
  s->integral = 0;
#endif
#if HAS_DEAD_TIME
  for (i = 0; i < DEAD_SAMPLES; ++i) s->waiting[i] = 0;
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

static inline int32_t NAME_step(NAME_state *s, int32_t sample)
{
#if HAS_DEAD_TIME
  const int32_t input = s->waiting[s->oldest];
#else
  const int32_t input = sample;
#endif
#if HAS_SECTION_TAPS
  const int32_t x = NAME_section_tapped(s, input);
#else
  const int32_t x = input >> 1;
#endif
  int64_t sum = SECTION_OUTPUT;
#if HAS_PAIRS
  int i;
#endif
#if HAS_INTEGRATOR
  const int64_t largest = (int64_t)1 << INTEGRAL_LIMIT_BITS; /* 16 output ranges */
  int64_t increment, next;
#endif
#if HAS_NOTHING
  (void)s;
#endif
#if HAS_DEAD_TIME
  s->waiting[s->oldest] = sample;
  s->oldest = s->oldest + 1 == DEAD_SAMPLES ? 0 : s->oldest + 1;
#endif
#if HAS_SECTION_TAPS_ALONE
  NAME_section_advance(s, input);
#elif HAS_SECTION_TAPS
  NAME_section_advance(s, input, x);
#elif HAS_SECTION_SECTIONS
  NAME_section_advance(s, x);
#endif
#if HAS_PAIRS
  for (i = 0; i < PAIRS; ++i) {
    const int64_t re = (s->pair_re[i] + ((int64_t)1 << 28)) >> 29;
    const int64_t im = (s->pair_im[i] + ((int64_t)1 << 28)) >> 29;
    const int64_t gap = (x >> NAME_pair_head[i]) - re;
    sum += ((NAME_pair_gain_re[i] * re) >> SECTION_GUARD) - ((NAME_pair_gain_im[i] * im) >> SECTION_GUARD);
    s->pair_re[i] += (NAME_pair_rate_re[i] * gap + NAME_pair_rate_im[i] * im) >> NAME_pair_slower[i];
    s->pair_im[i] += (NAME_pair_rate_im[i] * gap - NAME_pair_rate_re[i] * im) >> NAME_pair_slower[i];
  }
#endif
#if HAS_INTEGRATOR
  increment = sum >> INTEGRAL_SHIFT;
#if IS_TRAPEZOIDAL
  sum = s->integral + (increment >> 1);
#else
  sum = s->integral;
#endif
  next = s->integral + increment;
  s->integral = next > largest ? largest : next < -largest ? -largest : next;
#endif
  sum = (sum + ((int64_t)1 << (OUTPUT_BITS - 1))) >> OUTPUT_BITS;
  return sum > INT32_MAX ? INT32_MAX : sum < INT32_MIN ? INT32_MIN : (int32_t)sum;
}
