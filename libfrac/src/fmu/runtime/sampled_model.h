/* SPDX-License-Identifier: BSD-3-Clause */
/* A recursion in the samples as a model: at every sample time within a step it takes the inputs, and its output stays
 * until the next one.  Before it stand SAMPLE_TIME, the header of the recursion, and
 *   void recursion_start(model *), void recursion_sample(model *).
 */
static const char *model_start(model *m, double time)
{
  m->start = time;
  m->samples = 0;
  recursion_start(m);
  return 0;
}

static const char *model_step(model *m, double time, double duration)
{
  /* Times that the master adds up differ from multiples of the sample time by rounding. */
  const double end = (time - m->start + duration) / SAMPLE_TIME - 1e-6;
  if (!(end - m->samples <= 1e9)) return "the step would take more than 1e9 samples";
  while (m->samples < end) {
    recursion_sample(m);
    m->samples += 1;
  }
  return 0;
}

static void model_results(model *m)
{
  (void)m;
}
