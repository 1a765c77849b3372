// SPDX-License-Identifier: BSD-3-Clause
// Taps and first-order sections of one filter in whole numbers, PREFIX: x = tapped(input), y = output(x), then
// advance(input, x).  Follows the arrays NAME_PREFIX_tap, _rate, _slower, _head and _gain, and the struct with the
// members PREFIX_past and PREFIX_part.  x is a fraction of its range times 2^30, the input of taps times
// 2^PREFIX_TAP_BITS.  Shifts of negative numbers keep the sign, as compilers for all processors do.

#if HAS_PREFIX_TAPS
static inline int32_t NAME_PREFIX_tapped(const NAME_state *s, int32_t input)
{
  int64_t sum = (int64_t)NAME_PREFIX_tap[0] * input;
  int k;
  for (k = 1; k < PREFIX_TAPS; ++k) sum += (int64_t)NAME_PREFIX_tap[k] * s->PREFIX_past[k - 1];
  return (int32_t)((sum + ((int64_t)1 << (PREFIX_TAP_BITS - 1))) >> PREFIX_TAP_BITS);
}

#endif
#if HAS_PREFIX_SECTIONS
/* A low-pass, rounded to a fraction times 2^30. */
static inline int64_t NAME_PREFIX_rounded(const NAME_state *s, int i)
{
  return (s->PREFIX_part[i] + ((int64_t)1 << 29)) >> 30;
}

static inline int64_t NAME_PREFIX_output(const NAME_state *s, int32_t x)
{
  int64_t sum = ((int64_t)PREFIX_DIRECT * x) >> PREFIX_GUARD;
  int i;
  for (i = 0; i < PREFIX_SIZE; ++i)
    sum += ((int64_t)NAME_PREFIX_gain[i] * NAME_PREFIX_rounded(s, i)) >> PREFIX_GUARD;
  return sum;
}

#endif
#if HAS_PREFIX_STATE
#if HAS_PREFIX_TAPS_ALONE
static inline void NAME_PREFIX_advance(NAME_state *s, int32_t input)
#elif HAS_PREFIX_TAPS
static inline void NAME_PREFIX_advance(NAME_state *s, int32_t input, int32_t x)
#else
static inline void NAME_PREFIX_advance(NAME_state *s, int32_t x)
#endif
{
  int i;
#if HAS_PREFIX_TAPS
  for (i = PREFIX_TAPS - 2; i > 0; --i) s->PREFIX_past[i] = s->PREFIX_past[i - 1];
  s->PREFIX_past[0] = input;
#endif
#if HAS_PREFIX_SECTIONS
  for (i = 0; i < PREFIX_SIZE; ++i) {
    const int64_t v = NAME_PREFIX_rounded(s, i);
    s->PREFIX_part[i] += ((int64_t)NAME_PREFIX_rate[i] * ((x >> NAME_PREFIX_head[i]) - v)) >> NAME_PREFIX_slower[i];
  }
#endif
}

#endif
