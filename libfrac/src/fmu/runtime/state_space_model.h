/* SPDX-License-Identifier: BSD-3-Clause */
/* x' = A x + B u, y = C x + D u as a model.  Before it stand MODEL_STATES, ENTRIES of A that are not 0, and the arrays
 * entry_row, entry_column, entry_value, from_input (B), to_output (C) and the number direct (D).
 */
#include <math.h>

enum { at_input, at_output };

#define SIZE (MODEL_STATES + 1)

typedef struct {
  double real[MODEL_REALS];
  int boolean[1];
  double x[MODEL_STATES];
  double duration;                    /* of the step that `step` is for; 0: none yet */
  double step[MODEL_STATES * SIZE];   /* x(t + duration) from x and u, row after row */
} model;

static const char *model_start(model *m, double time)
{
  int i;
  (void)time;
  for (i = 0; i < MODEL_STATES; ++i) m->x[i] = 0;
  m->duration = 0;
  return 0;
}

static double *model_state(model *m)
{
  return m->x;
}

static void model_rates(model *m, double *rate)
{
  int i;
  for (i = 0; i < MODEL_STATES; ++i) rate[i] = from_input[i] * m->real[at_input];
  for (i = 0; i < ENTRIES; ++i) rate[entry_row[i]] += entry_value[i] * m->x[entry_column[i]];
}

static void model_results(model *m)
{
  double y = direct * m->real[at_input];
  int i;
  for (i = 0; i < MODEL_STATES; ++i) y += to_output[i] * m->x[i];
  m->real[at_output] = y;
}

/* product = [A B; 0 0] duration times a SIZE x SIZE matrix, by the entries of A. */
static void times_system(const double *matrix, double *product, double duration)
{
  int i, j;
  for (i = 0; i < SIZE * SIZE; ++i) product[i] = 0;
  for (i = 0; i < ENTRIES; ++i) {
    for (j = 0; j < SIZE; ++j)
      product[entry_row[i] * SIZE + j] += duration * entry_value[i] * matrix[entry_column[i] * SIZE + j];
  }
  for (i = 0; i < MODEL_STATES; ++i) {
    for (j = 0; j < SIZE; ++j) product[i * SIZE + j] += duration * from_input[i] * matrix[MODEL_STATES * SIZE + j];
  }
}

/* The exponential of [A B; 0 0] duration, which is exact for an input that is constant over the step: the series of a
 * part so small that its terms fall by half, whose sum less 1 is then doubled in length as often.  Without the 1 small
 * steps keep all digits. */
static void prepare(model *m, double duration)
{
  double sum[SIZE * SIZE], term[SIZE * SIZE], next[SIZE * SIZE];
  double largest = 0, row = 0, part = duration;
  int doublings = 0, i, j, k;
  for (i = 0; i < MODEL_STATES; ++i) {
    row = fabs(from_input[i]);
    for (j = 0; j < ENTRIES; ++j) {
      if (entry_row[j] == i) row += fabs(entry_value[j]);
    }
    largest = row > largest ? row : largest;
  }
  while (part * largest > 0.5) {
    part /= 2;
    ++doublings;
  }
  for (i = 0; i < SIZE * SIZE; ++i) term[i] = i % (SIZE + 1) == 0 ? 1 : 0;
  for (i = 0; i < SIZE * SIZE; ++i) sum[i] = 0;
  for (k = 1; k <= 18; ++k) {
    times_system(term, next, part / k);
    for (i = 0; i < SIZE * SIZE; ++i) {
      term[i] = next[i];
      sum[i] += next[i];
    }
  }
  for (; doublings > 0; --doublings) {
    /* (1 + sum)^2 - 1 = 2 sum + sum sum */
    for (i = 0; i < SIZE; ++i) {
      for (j = 0; j < SIZE; ++j) {
        double entry = 2 * sum[i * SIZE + j];
        for (k = 0; k < SIZE; ++k) entry += sum[i * SIZE + k] * sum[k * SIZE + j];
        next[i * SIZE + j] = entry;
      }
    }
    for (i = 0; i < SIZE * SIZE; ++i) sum[i] = next[i];
  }
  for (i = 0; i < MODEL_STATES * SIZE; ++i) m->step[i] = sum[i];
  m->duration = duration;
}

static const char *model_step(model *m, double time, double duration)
{
  double change[MODEL_STATES];
  int i, j;
  (void)time;
  if (duration == 0) return 0;
  if (duration != m->duration) prepare(m, duration);
  for (i = 0; i < MODEL_STATES; ++i) {
    change[i] = m->step[i * SIZE + MODEL_STATES] * m->real[at_input];
    for (j = 0; j < MODEL_STATES; ++j) change[i] += m->step[i * SIZE + j] * m->x[j];
  }
  for (i = 0; i < MODEL_STATES; ++i) m->x[i] += change[i];
  return 0;
}
