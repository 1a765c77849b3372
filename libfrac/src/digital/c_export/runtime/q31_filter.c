// SPDX-License-Identifier: BSD-3-Clause
// A filter in whole numbers, for processors without a floating-point unit.  Follows q31_filter_state.h and
// q31_section.c for "section".  Samples are fractions of the input range times 2^31, outputs of the output range.

/* At rest. */
static inline void NAME_reset(NAME_state *s)
{
  int i;
  for (i = 0; i < SECTION_SIZE; ++i) s->section_part[i] = 0;
}

/* Call once before the first step. */
static inline void NAME_init(NAME_state *s)
{
  NAME_reset(s);
}

static inline int32_t NAME_step(NAME_state *s, int32_t sample)
{
  const int32_t x = sample >> 1;
  const int64_t sum = (NAME_section_output(s, x) + ((int64_t)1 << (OUTPUT_BITS - 1))) >> OUTPUT_BITS;
  NAME_section_advance(s, x);
  return sum > INT32_MAX ? INT32_MAX : sum < INT32_MIN ? INT32_MIN : (int32_t)sum;
}
