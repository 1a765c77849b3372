/* SPDX-License-Identifier: BSD-3-Clause */
/* The functions of FMI 2.0 around a model.  Before it stand, from the generated file and from the file of the model:
 *   MODEL_GUID, MODEL_REALS, MODEL_BOOLEANS (0 where there are none), MODEL_STATES (0 without model exchange),
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
 * All that changes is in the model, so that instances know nothing of each other and a state is a copy of the bytes.
 */
#include <string.h>

typedef enum { is_instantiated, is_initialising, is_running, is_terminated } phase_of_instance;

typedef struct {
  phase_of_instance phase;
  double time;
  model inner;
} state_of_instance;

typedef struct {
  fmi2Type type;
  const fmi2CallbackFunctions *callbacks;
  char *name;
  state_of_instance state;
} instance;

static fmi2Status refuse(const instance *c, const char *why)
{
  if (c->callbacks->logger)
    c->callbacks->logger(c->callbacks->componentEnvironment, c->name, fmi2Error, "logStatusError", "%s", why);
  return fmi2Error;
}

static void to_defaults(instance *c)
{
  int i;
  memset(&c->state, 0, sizeof c->state);
  for (i = 0; i < MODEL_REALS; ++i) c->state.inner.real[i] = model_default[i];
  c->state.phase = is_instantiated;
}

FMI2_EXPORT const char *FMI2_NAME(fmi2GetTypesPlatform)(void)
{
  return "default";
}

FMI2_EXPORT const char *FMI2_NAME(fmi2GetVersion)(void)
{
  return "2.0";
}

FMI2_EXPORT fmi2Component FMI2_NAME(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid,
                                                     fmi2String resources, const fmi2CallbackFunctions *callbacks,
                                                     fmi2Boolean visible, fmi2Boolean logging)
{
  instance *c;
  const size_t length = name ? strlen(name) + 1 : 0;
  (void)resources;
  (void)visible;
  (void)logging;
  if (!callbacks || !callbacks->allocateMemory || !callbacks->freeMemory || !name) return 0;
  if (!guid || strcmp(guid, MODEL_GUID) != 0 || (type == fmi2ModelExchange && MODEL_STATES == 0)) {
    if (callbacks->logger) {
      callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError", "%s",
                        type == fmi2ModelExchange && MODEL_STATES == 0
                            ? "this model is for co-simulation only"
                            : "the guid is not that of modelDescription.xml");
    }
    return 0;
  }
  c = (instance *)callbacks->allocateMemory(1, sizeof *c);
  if (!c) return 0;
  c->name = (char *)callbacks->allocateMemory(1, length);
  if (!c->name) {
    callbacks->freeMemory(c);
    return 0;
  }
  memcpy(c->name, name, length);
  c->type = type;
  c->callbacks = callbacks;
  to_defaults(c);
  return c;
}

FMI2_EXPORT void FMI2_NAME(fmi2FreeInstance)(fmi2Component component)
{
  instance *c = (instance *)component;
  void (*release)(void *);
  if (!c) return;
  release = c->callbacks->freeMemory;
  release(c->name);
  release(c);
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t count,
                                                      const fmi2String categories[])
{
  (void)c;
  (void)on;
  (void)count;
  (void)categories;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SetupExperiment)(fmi2Component component, fmi2Boolean has_tolerance,
                                                      fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop,
                                                      fmi2Real stop)
{
  instance *c = (instance *)component;
  (void)has_tolerance;
  (void)tolerance;
  (void)has_stop;
  (void)stop;
  if (c->state.phase != is_instantiated) return refuse(c, "fmi2SetupExperiment is for a new or reset instance");
  c->state.time = start;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2EnterInitializationMode)(fmi2Component component)
{
  instance *c = (instance *)component;
  if (c->state.phase != is_instantiated) return refuse(c, "the instance is initialised already");
  c->state.phase = is_initialising;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2ExitInitializationMode)(fmi2Component component)
{
  instance *c = (instance *)component;
  const char *why;
  if (c->state.phase != is_initialising) return refuse(c, "the instance is not in initialisation mode");
  why = model_start(&c->state.inner, c->state.time);
  if (why) return refuse(c, why);
  model_results(&c->state.inner);
  c->state.phase = is_running;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2Terminate)(fmi2Component component)
{
  instance *c = (instance *)component;
  if (c->state.phase != is_running) return refuse(c, "the instance does not run");
  c->state.phase = is_terminated;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2Reset)(fmi2Component component)
{
  to_defaults((instance *)component);
  return fmi2OK;
}

#if MODEL_STATES > 0
static void give_states(model *m)
{
  memcpy(m->real + MODEL_REALS - 2 * MODEL_STATES, model_state(m), MODEL_STATES * sizeof(double));
  model_rates(m, m->real + MODEL_REALS - MODEL_STATES);
}
#endif

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetReal)(fmi2Component component, const fmi2ValueReference which[], size_t count,
                                              fmi2Real value[])
{
  instance *c = (instance *)component;
  size_t i;
#if MODEL_STATES > 0
  int has_states = 0;
#endif
  if (c->state.phase == is_initialising && model_start(&c->state.inner, c->state.time) != 0)
    return refuse(c, "the parameters do not go together");
  model_results(&c->state.inner);
  for (i = 0; i < count; ++i) {
    if (which[i] >= MODEL_REALS) return refuse(c, "fmi2GetReal: no such value reference");
#if MODEL_STATES > 0
    /* Nobody asks for them in most steps, and they cost more than the rest. */
    if (which[i] >= MODEL_REALS - 2 * MODEL_STATES && !has_states) {
      give_states(&c->state.inner);
      has_states = 1;
    }
#endif
    value[i] = c->state.inner.real[which[i]];
  }
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SetReal)(fmi2Component component, const fmi2ValueReference which[], size_t count,
                                              const fmi2Real value[])
{
  instance *c = (instance *)component;
#if defined(MODEL_TUNED)
  int tuned = 0;
#endif
  size_t i;
  for (i = 0; i < count; ++i) {
    char access;
    if (which[i] >= MODEL_REALS) return refuse(c, "fmi2SetReal: no such value reference");
    access = model_access[which[i]];
    if (access == 'o') return refuse(c, "fmi2SetReal: a result cannot be set");
    if (access == 'p' && c->state.phase != is_instantiated && c->state.phase != is_initialising)
      return refuse(c, "fmi2SetReal: this parameter is fixed once the simulation runs");
    if (!(value[i] - value[i] == 0)) return refuse(c, "fmi2SetReal: a value is not finite");
#if defined(MODEL_TUNED)
    tuned |= access == 't';
#endif
  }
  for (i = 0; i < count; ++i) c->state.inner.real[which[i]] = value[i];
#if defined(MODEL_TUNED)
  if (tuned) MODEL_TUNED(&c->state.inner);
#endif
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetBoolean)(fmi2Component component, const fmi2ValueReference which[],
                                                 size_t count, fmi2Boolean value[])
{
  instance *c = (instance *)component;
#if MODEL_BOOLEANS > 0
  size_t i;
  for (i = 0; i < count; ++i) {
    if (which[i] >= MODEL_BOOLEANS) return refuse(c, "fmi2GetBoolean: no such value reference");
    value[i] = c->state.inner.boolean[which[i]];
  }
  return fmi2OK;
#else
  (void)which;
  (void)value;
  return count == 0 ? fmi2OK : refuse(c, "fmi2GetBoolean: no such value reference");
#endif
}

/* No variable of a model is of these kinds, or can be set. */
FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetInteger)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                                                 fmi2Integer value[])
{
  (void)which;
  (void)value;
  return count == 0 ? fmi2OK : refuse((instance *)c, "fmi2GetInteger: no such value reference");
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetString)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                                                fmi2String value[])
{
  (void)which;
  (void)value;
  return count == 0 ? fmi2OK : refuse((instance *)c, "fmi2GetString: no such value reference");
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SetInteger)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                                                 const fmi2Integer value[])
{
  (void)which;
  (void)value;
  return count == 0 ? fmi2OK : refuse((instance *)c, "fmi2SetInteger: no such value reference");
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SetBoolean)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                                                 const fmi2Boolean value[])
{
  (void)which;
  (void)value;
  return count == 0 ? fmi2OK : refuse((instance *)c, "fmi2SetBoolean: a result cannot be set");
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SetString)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                                                const fmi2String value[])
{
  (void)which;
  (void)value;
  return count == 0 ? fmi2OK : refuse((instance *)c, "fmi2SetString: no such value reference");
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetFMUstate)(fmi2Component component, fmi2FMUstate *kept)
{
  instance *c = (instance *)component;
  if (!*kept) *kept = c->callbacks->allocateMemory(1, sizeof c->state);
  if (!*kept) return refuse(c, "fmi2GetFMUstate: no memory");
  memcpy(*kept, &c->state, sizeof c->state);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SetFMUstate)(fmi2Component component, fmi2FMUstate kept)
{
  instance *c = (instance *)component;
  if (!kept) return refuse(c, "fmi2SetFMUstate: no state");
  memcpy(&c->state, kept, sizeof c->state);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2FreeFMUstate)(fmi2Component component, fmi2FMUstate *kept)
{
  instance *c = (instance *)component;
  if (*kept) c->callbacks->freeMemory(*kept);
  *kept = 0;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SerializedFMUstateSize)(fmi2Component component, fmi2FMUstate kept, size_t *size)
{
  (void)component;
  (void)kept;
  *size = sizeof(state_of_instance);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SerializeFMUstate)(fmi2Component component, fmi2FMUstate kept, fmi2Byte bytes[],
                                                        size_t size)
{
  if (size < sizeof(state_of_instance)) return refuse((instance *)component, "fmi2SerializeFMUstate: too few bytes");
  memcpy(bytes, kept, sizeof(state_of_instance));
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2DeSerializeFMUstate)(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                                          fmi2FMUstate *kept)
{
  instance *c = (instance *)component;
  if (size != sizeof(state_of_instance)) return refuse(c, "fmi2DeSerializeFMUstate: not a state of this model");
  if (!*kept) *kept = c->callbacks->allocateMemory(1, size);
  if (!*kept) return refuse(c, "fmi2DeSerializeFMUstate: no memory");
  memcpy(*kept, bytes, size);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknown[],
                                                               size_t unknowns, const fmi2ValueReference known[],
                                                               size_t knowns, const fmi2Real change[],
                                                               fmi2Real result[])
{
  (void)unknown;
  (void)unknowns;
  (void)known;
  (void)knowns;
  (void)change;
  (void)result;
  return refuse((instance *)c, "fmi2GetDirectionalDerivative: not provided");
}

/* Co-simulation. */

/* A library may hold the model a second time, compiled with FMU_FOR_AVX512 for processors that have AVX-512.  Steps are
 * then taken by what suits the processor; the bits are the same. */
#if defined(FMU_HAS_AVX512)
fmi2Status avx512_fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real duration, fmi2Boolean no_earlier_state);
#endif

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2DoStep)(fmi2Component component, fmi2Real time, fmi2Real duration,
                                             fmi2Boolean no_earlier_state)
{
  instance *c = (instance *)component;
  const char *why;
#if defined(FMU_HAS_AVX512)
  if (__builtin_cpu_supports("avx512f")) return avx512_fmi2DoStep(component, time, duration, no_earlier_state);
#endif
  (void)no_earlier_state;
  if (c->state.phase != is_running || c->type != fmi2CoSimulation) return refuse(c, "fmi2DoStep: not in step mode");
  if (!(duration >= 0)) return refuse(c, "fmi2DoStep: the step is negative");
  if (!(time - time == 0 && duration - duration == 0)) return refuse(c, "fmi2DoStep: the step has no end");
  why = model_step(&c->state.inner, time, duration);
  if (why) return refuse(c, why);
  c->state.time = time + duration;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2CancelStep)(fmi2Component c)
{
  return refuse((instance *)c, "fmi2CancelStep: no step runs in the background");
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference which[],
                                                              size_t count, const fmi2Integer order[],
                                                              const fmi2Real value[])
{
  (void)which;
  (void)order;
  (void)value;
  return count == 0 ? fmi2OK : refuse((instance *)c, "fmi2SetRealInputDerivatives: inputs are constant within a step");
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference which[],
                                                               size_t count, const fmi2Integer order[],
                                                               fmi2Real value[])
{
  (void)which;
  (void)order;
  (void)value;
  return count == 0 ? fmi2OK : refuse((instance *)c, "fmi2GetRealOutputDerivatives: not provided");
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Status *value)
{
  (void)c;
  (void)kind;
  *value = fmi2OK;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetRealStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Real *value)
{
  (void)kind;
  *value = ((instance *)component)->state.time;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetIntegerStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value)
{
  (void)c;
  (void)kind;
  *value = 0;
  return fmi2Discard;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetBooleanStatus)(fmi2Component component, fmi2StatusKind kind,
                                                       fmi2Boolean *value)
{
  (void)kind;
  *value = ((instance *)component)->state.phase == is_terminated;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetStringStatus)(fmi2Component c, fmi2StatusKind kind, fmi2String *value)
{
  (void)c;
  (void)kind;
  *value = "";
  return fmi2Discard;
}

#if MODEL_STATES > 0
/* Model exchange: linear states without events. */

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2EnterEventMode)(fmi2Component c)
{
  (void)c;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2NewDiscreteStates)(fmi2Component component, fmi2EventInfo *event)
{
  instance *c = (instance *)component;
  memset(event, 0, sizeof *event);
#if MODEL_EVENTS > 0
  event->valuesOfContinuousStatesChanged = model_event(&c->state.inner);
#else
  (void)c;
#endif
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2EnterContinuousTimeMode)(fmi2Component c)
{
  (void)c;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2CompletedIntegratorStep)(fmi2Component c, fmi2Boolean no_earlier_state,
                                                              fmi2Boolean *event_mode, fmi2Boolean *terminate)
{
  (void)c;
  (void)no_earlier_state;
  *event_mode = 0;
  *terminate = 0;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SetTime)(fmi2Component component, fmi2Real time)
{
  ((instance *)component)->state.time = time;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2SetContinuousStates)(fmi2Component component, const fmi2Real x[], size_t count)
{
  instance *c = (instance *)component;
  if (count != MODEL_STATES) return refuse(c, "fmi2SetContinuousStates: wrong number of states");
  memcpy(model_state(&c->state.inner), x, count * sizeof *x);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetContinuousStates)(fmi2Component component, fmi2Real x[], size_t count)
{
  instance *c = (instance *)component;
  if (count != MODEL_STATES) return refuse(c, "fmi2GetContinuousStates: wrong number of states");
  memcpy(x, model_state(&c->state.inner), count * sizeof *x);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetDerivatives)(fmi2Component component, fmi2Real rate[], size_t count)
{
  instance *c = (instance *)component;
  if (count != MODEL_STATES) return refuse(c, "fmi2GetDerivatives: wrong number of states");
  model_rates(&c->state.inner, rate);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetEventIndicators)(fmi2Component component, fmi2Real indicator[], size_t count)
{
  instance *c = (instance *)component;
  if (count != MODEL_EVENTS) return refuse(c, "fmi2GetEventIndicators: wrong number of indicators");
#if MODEL_EVENTS > 0
  model_indicators(&c->state.inner, indicator);
#else
  (void)indicator;
#endif
  return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2_NAME(fmi2GetNominalsOfContinuousStates)(fmi2Component component, fmi2Real nominal[],
                                                                    size_t count)
{
  size_t i;
  (void)component;
  for (i = 0; i < count; ++i) nominal[i] = 1;
  return fmi2OK;
}
#endif
