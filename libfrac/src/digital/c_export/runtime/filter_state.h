// SPDX-License-Identifier: BSD-3-Clause
// State of a filter.

typedef struct {
#if HAS_SECTION_TAPS
  REAL section_past[SECTION_TAPS]; /* inputs, the newest first */
#endif
#if HAS_SECTION_SECTIONS
  REAL section_v[SECTION_SIZE];    /* states */
  REAL section_lost[SECTION_SIZE]; /* of them, to rounding */
#if HAS_SECTION_LEAK
  REAL section_leak[SECTION_SIZE]; /* leaving them in this step */
#endif
#endif
#if HAS_PAIRS
  REAL pair_re[PAIRS];
  REAL pair_im[PAIRS];
#endif
#if HAS_DIFFERENCES
  REAL previous[DIFFERENCES];
#endif
#if HAS_INTEGRATORS
  REAL integral[INTEGRATORS];
  REAL integral_lost[INTEGRATORS];
#endif
#if HAS_DEAD_TIME
  REAL waiting[DEAD_SAMPLES];
  int oldest;
#endif
#if HAS_NOTHING
  int nothing;
#endif
} NAME_state;

