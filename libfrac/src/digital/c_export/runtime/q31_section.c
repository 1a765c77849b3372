// SPDX-License-Identifier: BSD-3-Clause
// First-order sections of one filter in whole numbers, PREFIX.  Follows the arrays NAME_PREFIX_rate, _slower, _head and
// _gain, and the struct with the member PREFIX_part.  Inputs are fractions of their range times 2^30.  Shifts of
// negative numbers keep the sign, as compilers for all processors do.

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

static inline void NAME_PREFIX_advance(NAME_state *s, int32_t x)
{
  int i;
  for (i = 0; i < PREFIX_SIZE; ++i) {
    const int64_t v = NAME_PREFIX_rounded(s, i);
    s->PREFIX_part[i] += ((int64_t)NAME_PREFIX_rate[i] * ((x >> NAME_PREFIX_head[i]) - v)) >> NAME_PREFIX_slower[i];
  }
}

#endif
