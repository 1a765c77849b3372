// SPDX-License-Identifier: BSD-3-Clause
// The functions of section_filter.c that go through the sections, in vectors of eight: the same operations on each
// section and the same sums, so the same bits.  For compilers that are told of registers that hold eight numbers; in
// smaller ones such vectors are slower than the loops.

#if defined(__AVX512F__)
typedef REAL NAME_PREFIX_eight __attribute__((vector_size(8 * sizeof(REAL)), aligned(sizeof(REAL)), may_alias));
typedef VECTOR_INTEGER NAME_PREFIX_mask __attribute__((vector_size(8 * sizeof(REAL))));

static inline REAL NAME_PREFIX_vector_output(NAME_state *s, REAL x)
{
  NAME_PREFIX_eight lane = {ZERO};
  int i;
  for (i = 0; i < PREFIX_SIZE; i += 8) {
    const NAME_PREFIX_eight v = *(const NAME_PREFIX_eight *)&s->PREFIX_v[i];
    const NAME_PREFIX_eight weight = *(const NAME_PREFIX_eight *)&NAME_PREFIX_weight[i];
#if PREFIX_GIVES_STATES
    const NAME_PREFIX_eight part = weight * v;
#else
    const NAME_PREFIX_eight leak = *(const NAME_PREFIX_eight *)&NAME_PREFIX_rate[i] * v;
    const NAME_PREFIX_eight part = weight * (x - leak);
    *(NAME_PREFIX_eight *)&s->PREFIX_leak[i] = leak;
#endif
    if (i == 0) {
      lane = part;
    } else {
      lane += part;
    }
  }
  return PREFIX_DIRECT * x +
         (ZERO + (((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]))));
}

static inline void NAME_PREFIX_vector_advance(NAME_state *s, REAL input, REAL x)
{
  int i;
#if HAS_PREFIX_TAPS
  for (i = PREFIX_TAPS - 1; i > 0; --i) s->PREFIX_past[i] = s->PREFIX_past[i - 1];
  s->PREFIX_past[0] = input;
#else
  (void)input;
#endif
  for (i = 0; i < PREFIX_SIZE; i += 8) {
    const NAME_PREFIX_eight v = *(const NAME_PREFIX_eight *)&s->PREFIX_v[i];
    const NAME_PREFIX_eight lost = *(const NAME_PREFIX_eight *)&s->PREFIX_lost[i];
#if PREFIX_GIVES_STATES
    const NAME_PREFIX_eight leak = *(const NAME_PREFIX_eight *)&NAME_PREFIX_rate[i] * v;
#else
    const NAME_PREFIX_eight leak = *(const NAME_PREFIX_eight *)&s->PREFIX_leak[i];
#endif
    const NAME_PREFIX_eight increment = (x - leak) + lost;
    const NAME_PREFIX_eight sum = v + increment;
    const NAME_PREFIX_eight remainder = increment - (sum - v);
    const NAME_PREFIX_mask matters = (sum > TINY) | (sum < -TINY);
    *(NAME_PREFIX_eight *)&s->PREFIX_v[i] = (NAME_PREFIX_eight)((NAME_PREFIX_mask)sum & matters);
    *(NAME_PREFIX_eight *)&s->PREFIX_lost[i] = (NAME_PREFIX_eight)((NAME_PREFIX_mask)remainder & matters);
  }
}

#define NAME_PREFIX_output NAME_PREFIX_vector_output
#define NAME_PREFIX_advance NAME_PREFIX_vector_advance
#endif

