/* SPDX-License-Identifier: BSD-3-Clause */
/* A model as an instance that a simulator drives, whatever the version of the Functional Mock-up Interface.  Before it
 * stand, from the generated file and from the file of the model:
 *   MODEL_TOKEN, MODEL_REALS, MODEL_BOOLEANS (0 where there are none), MODEL_STATES (0 without model exchange),
 *   MODEL_EVENTS (number of event indicators);
 *   model_default[MODEL_REALS], start values by value reference;
 *   model_access[MODEL_REALS], of each whether it is an input 'i', a parameter that is fixed 'p' or tunable 't', or a
 *     result 'o';
 *   model, a struct without pointers with the members real and boolean;
 *   const char *model_start(model *, double time)  to the state at rest: 0, or what prevents it;
 *   const char *model_step(model *, double time, double duration)  under constant inputs;
 *   void model_results(model *)  results of the present state and inputs, except for the last 2 MODEL_STATES, which are
 *     the states and their rates;
 *   MODEL_TUNED(model *)  takes tunable parameters that were set; only where there are some;
 *   double *model_state(model *), void model_rates(model *, double *)  where MODEL_STATES > 0;
 *   void model_indicators(model *, double *), int model_event(model *)  where MODEL_EVENTS > 0: what changes its sign at
 *     an event, and what happens then, 1 if the states jump.
 * and from the file of the version:
 *   status, with status_ok and status_error; simulator, what an instance knows of who drives it; TOKEN_NAME;
 *   void tell(const simulator *, const char *why), void *allocate(const simulator *, size_t),
 *   void release(const simulator *, void *); FMU_PREFIX where the functions have one.
 * All that changes is in the model, so that instances know nothing of each other and a state is a copy of the bytes.
 */
#include <string.h>

/* Where several models are linked into one program, every function begins with the name of its model. */
#ifdef FMU_PREFIX
#define FMU_JOINED(prefix, name) prefix##name
#define FMU_PREFIXED(prefix, name) FMU_JOINED(prefix, name)
#define FMU_NAME(name) FMU_PREFIXED(FMU_PREFIX, name)
#else
#define FMU_NAME(name) name
#endif

#if defined(_WIN32)
#define FMU_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMU_EXPORT __attribute__((visibility("default")))
#else
#define FMU_EXPORT
#endif

/* A model without states or events has none to give. */
#if MODEL_STATES == 0
static double *model_state(model *m)
{
  return m->real;
}

static void model_rates(model *m, double *rate)
{
  (void)m;
  (void)rate;
}
#endif
#if MODEL_EVENTS == 0
static void model_indicators(model *m, double *indicator)
{
  (void)m;
  (void)indicator;
}

static int model_event(model *m)
{
  (void)m;
  return 0;
}
#endif

typedef enum { is_instantiated, is_initialising, is_running, is_terminated } phase_of_instance;

typedef struct {
  phase_of_instance phase;
  double time;
  model inner;
} state_of_instance;

typedef struct {
  int exchanges; /* model exchange, else co-simulation */
  simulator driver;
  state_of_instance state;
} instance;

static status refuse(const instance *c, const char *why)
{
  tell(&c->driver, why);
  return status_error;
}

static status advance_here(instance *c, double time, double duration)
{
  const char *why;
  if (c->state.phase != is_running || c->exchanges) return refuse(c, "a step: the instance is not in step mode");
  if (!(duration >= 0)) return refuse(c, "a step: its length is negative");
  if (!(time - time == 0 && duration - duration == 0)) return refuse(c, "a step: it has no end");
  why = model_step(&c->state.inner, time, duration);
  if (why) return refuse(c, why);
  c->state.time = time + duration;
  return status_ok;
}

/* A library may hold the model a second time, compiled with FMU_FOR_AVX512 for processors that have AVX-512.  Steps are
 * then taken by what suits the processor; the bits are the same. */
#if defined(FMU_FOR_AVX512) || defined(FMU_HAS_AVX512)
status fmu_advance_avx512(void *c, double time, double duration);
#endif
#if defined(FMU_FOR_AVX512)
status fmu_advance_avx512(void *c, double time, double duration)
{
  return advance_here((instance *)c, time, duration);
}
#else

static status advance(void *c, double time, double duration)
{
#if defined(FMU_HAS_AVX512)
  if (__builtin_cpu_supports("avx512f")) return fmu_advance_avx512(c, time, duration);
#endif
  return advance_here((instance *)c, time, duration);
}

static void to_defaults(instance *c)
{
  int i;
  memset(&c->state, 0, sizeof c->state);
  for (i = 0; i < MODEL_REALS; ++i) c->state.inner.real[i] = model_default[i];
  c->state.phase = is_instantiated;
}

/* 0 where it is refused. */
static instance *instantiate(const simulator *driver, int exchanges, const char *token)
{
  instance *c;
  if (!token || strcmp(token, MODEL_TOKEN) != 0) {
    tell(driver, "the " TOKEN_NAME " is not that of modelDescription.xml");
    return 0;
  }
  if (exchanges && MODEL_STATES == 0) {
    tell(driver, "this model is for co-simulation only");
    return 0;
  }
  c = (instance *)allocate(driver, sizeof *c);
  if (!c) return 0;
  c->driver = *driver;
  c->exchanges = exchanges;
  to_defaults(c);
  return c;
}

static status enter_initialisation(instance *c)
{
  if (c->state.phase != is_instantiated) return refuse(c, "the instance is initialised already");
  c->state.phase = is_initialising;
  return status_ok;
}

static status exit_initialisation(instance *c)
{
  const char *why;
  if (c->state.phase != is_initialising) return refuse(c, "the instance is not in initialisation mode");
  why = model_start(&c->state.inner, c->state.time);
  if (why) return refuse(c, why);
  model_results(&c->state.inner);
  c->state.phase = is_running;
  return status_ok;
}

static status terminate(instance *c)
{
  if (c->state.phase != is_running) return refuse(c, "the instance does not run");
  c->state.phase = is_terminated;
  return status_ok;
}

/* Of the present state, ahead of reading them. */
static status update_results(instance *c)
{
  if (c->state.phase == is_initialising && model_start(&c->state.inner, c->state.time) != 0)
    return refuse(c, "the parameters do not go together");
  model_results(&c->state.inner);
  return status_ok;
}

/* Puts states and rates among the results: nobody asks for them in most steps, and they cost more than the rest. */
static void give_states(model *m)
{
  memcpy(m->real + MODEL_REALS - 2 * MODEL_STATES, model_state(m), MODEL_STATES * sizeof(double));
  model_rates(m, m->real + MODEL_REALS - MODEL_STATES);
}

static const char no_such_variable[] = "no variable of this type has this value reference";

static status set_reals(instance *c, const unsigned int which[], size_t count, const double value[])
{
#if defined(MODEL_TUNED)
  int tuned = 0;
#endif
  size_t i;
  for (i = 0; i < count; ++i) {
    char access;
    if (which[i] >= MODEL_REALS) return refuse(c, no_such_variable);
    access = model_access[which[i]];
    if (access == 'o') return refuse(c, "a result cannot be set");
    if (access == 'p' && c->state.phase != is_instantiated && c->state.phase != is_initialising)
      return refuse(c, "this parameter is fixed once the simulation runs");
    if (!(value[i] - value[i] == 0)) return refuse(c, "a value to set is not finite");
#if defined(MODEL_TUNED)
    tuned |= access == 't';
#endif
  }
  for (i = 0; i < count; ++i) c->state.inner.real[which[i]] = value[i];
#if defined(MODEL_TUNED)
  if (tuned) MODEL_TUNED(&c->state.inner);
#endif
  return status_ok;
}

/* Of variables that a model has none of, or none to set. */
static status refuse_any(const instance *c, size_t count, const char *why)
{
  return count == 0 ? status_ok : refuse(c, why);
}

/* A copy of a state, or of the bytes of one, in memory that is there or allocated. */
static status copy_state(instance *c, void **copy, const void *from)
{
  if (!*copy) *copy = allocate(&c->driver, sizeof c->state);
  if (!*copy) return refuse(c, "no memory for a state");
  memcpy(*copy, from, sizeof c->state);
  return status_ok;
}

static status set_state(instance *c, const void *kept)
{
  if (!kept) return refuse(c, "there is no state to set");
  memcpy(&c->state, kept, sizeof c->state);
  return status_ok;
}

static status free_state(instance *c, void **kept)
{
  if (*kept) release(&c->driver, *kept);
  *kept = 0;
  return status_ok;
}

static status serialise_state(const instance *c, const void *kept, void *bytes, size_t size)
{
  if (size < sizeof c->state) return refuse(c, "too few bytes for a state");
  memcpy(bytes, kept, sizeof c->state);
  return status_ok;
}

static status deserialise_state(instance *c, const void *bytes, size_t size, void **kept)
{
  if (size != sizeof c->state) return refuse(c, "the bytes are no state of this model");
  return copy_state(c, kept, bytes);
}

static const char wrong_count[] = "wrong number of states or event indicators";

static status set_states(instance *c, const double x[], size_t count)
{
  if (count != MODEL_STATES) return refuse(c, wrong_count);
  memcpy(model_state(&c->state.inner), x, count * sizeof *x);
  return status_ok;
}

static status get_states(instance *c, double x[], size_t count)
{
  if (count != MODEL_STATES) return refuse(c, wrong_count);
  memcpy(x, model_state(&c->state.inner), count * sizeof *x);
  return status_ok;
}

static status get_rates(instance *c, double rate[], size_t count)
{
  if (count != MODEL_STATES) return refuse(c, wrong_count);
  model_rates(&c->state.inner, rate);
  return status_ok;
}

static status get_indicators(instance *c, double indicator[], size_t count)
{
  if (count != MODEL_EVENTS) return refuse(c, wrong_count);
  model_indicators(&c->state.inner, indicator);
  return status_ok;
}

static status get_nominals(const instance *c, double nominal[], size_t count)
{
  size_t i;
  if (count != MODEL_STATES) return refuse(c, wrong_count);
  for (i = 0; i < count; ++i) nominal[i] = 1;
  return status_ok;
}
#endif
