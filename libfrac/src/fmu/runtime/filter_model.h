/* SPDX-License-Identifier: BSD-3-Clause */
/* The filter of filter.h as a model. */
enum { at_input, at_output };

typedef struct {
  double real[MODEL_REALS];
  int boolean[1];
  double start;
  double samples;
  filter_state recursion;
} model;

static void recursion_start(model *m)
{
  filter_init(&m->recursion);
  m->real[at_output] = 0;
}

static void recursion_sample(model *m)
{
  m->real[at_output] = (double)filter_step(&m->recursion, (filter_real)m->real[at_input]);
}
