// SPDX-License-Identifier: BSD-3-Clause
// State of a filter in whole numbers.

typedef struct {
  int64_t section_part[SECTION_SIZE]; /* low-passes of the input, fractions of its range times 2^(60 - head) */
} NAME_state;

