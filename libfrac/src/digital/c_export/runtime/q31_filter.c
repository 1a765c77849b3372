// SPDX-License-Identifier: BSD-3-Clause
// A filter in whole numbers, for processors without a floating-point unit.  Follows the arrays NAME_rate, NAME_slower,
// NAME_head and NAME_gain.  Samples are fractions of the input range times 2^31, outputs of the output range.

typedef struct {
  int64_t part[SECTIONS]; /* low-passes of the input, fractions of its range times 2^(60 - head) */
} NAME_state;

/* At rest. */
static inline void NAME_reset(NAME_state *s)
{
  int i;
  for (i = 0; i < SECTIONS; ++i) s->part[i] = 0;
}

/* Call once before the first step. */
static inline void NAME_init(NAME_state *s)
{
  NAME_reset(s);
}

/* Shifts of negative numbers keep the sign, as compilers for all processors do. */
static inline int32_t NAME_step(NAME_state *s, int32_t sample)
{
  const int32_t x = sample >> 1;
  int64_t sum = ((int64_t)DIRECT * x) >> GUARD_BITS;
  int i;
  for (i = 0; i < SECTIONS; ++i) {
    const int64_t v = (s->part[i] + ((int64_t)1 << 29)) >> 30;
    sum += ((int64_t)NAME_gain[i] * v) >> GUARD_BITS;
    s->part[i] += ((int64_t)NAME_rate[i] * ((x >> NAME_head[i]) - v)) >> NAME_slower[i];
  }
  sum = (sum + ((int64_t)1 << (OUTPUT_BITS - 1))) >> OUTPUT_BITS;
  return sum > INT32_MAX ? INT32_MAX : sum < INT32_MIN ? INT32_MIN : (int32_t)sum;
}
