// SPDX-License-Identifier: BSD-3-Clause
// State of a filter in whole numbers.

typedef struct {
#if HAS_SECTION_TAPS
  int32_t section_past[SECTION_PAST]; /* what the taps took in, the newest first */
#endif
#if HAS_SECTION_SECTIONS
  int64_t section_part[SECTION_SIZE]; /* low-passes of the input, fractions of its range times 2^(60 - head) */
#endif
#if HAS_PAIRS
  int64_t pair_re[PAIRS]; /* the same of complex poles, times 2^(59 - head) */
  int64_t pair_im[PAIRS];
#endif
#if HAS_INTEGRATOR
  int64_t integral; /* kept within 16 output ranges */
#endif
#if HAS_DEAD_TIME
  int32_t waiting[DEAD_SAMPLES]; /* ring of samples */
  int oldest;
#endif
#if HAS_NOTHING
  int nothing;
#endif
} NAME_state;

