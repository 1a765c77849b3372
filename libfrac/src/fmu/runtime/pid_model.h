/* SPDX-License-Identifier: BSD-3-Clause */
/* The fractional PID of controller.h as a model.  Gains, weights and limits count from the next sample on. */
enum {
  at_setpoint,
  at_measured,
  at_output,
  at_unlimited,
  at_kp,
  at_ki,
  at_kd,
  at_minimum,
  at_maximum,
  at_setpoint_weight,
  at_derivative_setpoint_weight
};

typedef struct {
  double real[MODEL_REALS];
  int boolean[MODEL_BOOLEANS];
  double start;
  double samples;
  controller_state recursion;
} model;

static void take_parameters(model *m)
{
  controller_state *s = &m->recursion;
  s->kp = (controller_real)m->real[at_kp];
  s->ki = (controller_real)m->real[at_ki];
  s->kd = (controller_real)m->real[at_kd];
  s->minimum = (controller_real)m->real[at_minimum];
  s->maximum = (controller_real)m->real[at_maximum];
  s->setpoint_weight = (controller_real)m->real[at_setpoint_weight];
  s->derivative_setpoint_weight = (controller_real)m->real[at_derivative_setpoint_weight];
}

static void give_results(model *m)
{
  m->real[at_output] = (double)m->recursion.output;
  m->real[at_unlimited] = (double)m->recursion.unlimited;
  m->boolean[0] = m->recursion.saturated;
  m->boolean[1] = m->recursion.bad_input;
}

static void recursion_start(model *m)
{
  take_parameters(m);
  controller_init(&m->recursion);
  give_results(m);
}

#define MODEL_TUNED(m) take_parameters(m)

static void recursion_sample(model *m)
{
  (void)controller_step(&m->recursion, (controller_real)m->real[at_setpoint], (controller_real)m->real[at_measured]);
  give_results(m);
}
