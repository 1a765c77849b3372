/* SPDX-License-Identifier: BSD-3-Clause */
/* The Functional Mock-up Interface 2.0 for co-simulation and model exchange around a model; see fmu.h for what stands
 * before it.
 */
#include <stddef.h>

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef struct {
  void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
  void *(*allocateMemory)(size_t, size_t);
  void (*freeMemory)(void *);
  void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
  fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
  fmi2Boolean newDiscreteStatesNeeded;
  fmi2Boolean terminateSimulation;
  fmi2Boolean nominalsOfContinuousStatesChanged;
  fmi2Boolean valuesOfContinuousStatesChanged;
  fmi2Boolean nextEventTimeDefined;
  fmi2Real nextEventTime;
} fmi2EventInfo;

#ifdef FMI2_FUNCTION_PREFIX
#define FMU_PREFIX FMI2_FUNCTION_PREFIX
#endif

#define TOKEN_NAME "guid"
#define status_ok fmi2OK
#define status_error fmi2Error
typedef fmi2Status status;
typedef struct {
  const fmi2CallbackFunctions *callbacks;
  const char *name;
} simulator;

static void tell(const simulator *driver, const char *why)
{
  const fmi2CallbackFunctions *to = driver->callbacks;
  if (to->logger) to->logger(to->componentEnvironment, driver->name, fmi2Error, "logStatusError", "%s", why);
}

static void *allocate(const simulator *driver, size_t size)
{
  return driver->callbacks->allocateMemory(1, size);
}

static void release(const simulator *driver, void *memory)
{
  driver->callbacks->freeMemory(memory);
}

#include "fmu.h"

#if !defined(FMU_FOR_AVX512)
FMU_EXPORT const char *FMU_NAME(fmi2GetTypesPlatform)(void)
{
  return "default";
}

FMU_EXPORT const char *FMU_NAME(fmi2GetVersion)(void)
{
  return "2.0";
}

FMU_EXPORT fmi2Component FMU_NAME(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid,
                                                   fmi2String resources, const fmi2CallbackFunctions *callbacks,
                                                   fmi2Boolean visible, fmi2Boolean logging)
{
  simulator driver = {callbacks, name};
  instance *c;
  char *copy;
  (void)resources;
  (void)visible;
  (void)logging;
  if (!callbacks || !callbacks->allocateMemory || !callbacks->freeMemory || !name) return 0;
  c = instantiate(&driver, type == fmi2ModelExchange, guid);
  if (!c) return 0;
  copy = (char *)allocate(&driver, strlen(name) + 1);
  if (!copy) {
    release(&driver, c);
    return 0;
  }
  memcpy(copy, name, strlen(name) + 1);
  c->driver.name = copy;
  return c;
}

FMU_EXPORT void FMU_NAME(fmi2FreeInstance)(fmi2Component component)
{
  instance *c = (instance *)component;
  simulator driver;
  if (!c) return;
  driver = c->driver;
  release(&driver, (void *)driver.name);
  release(&driver, c);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t count,
                                                    const fmi2String categories[])
{
  (void)c;
  (void)on;
  (void)count;
  (void)categories;
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2SetupExperiment)(fmi2Component component, fmi2Boolean has_tolerance,
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

FMU_EXPORT fmi2Status FMU_NAME(fmi2EnterInitializationMode)(fmi2Component c)
{
  return enter_initialisation((instance *)c);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2ExitInitializationMode)(fmi2Component c)
{
  return exit_initialisation((instance *)c);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2Terminate)(fmi2Component c)
{
  return terminate((instance *)c);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2Reset)(fmi2Component c)
{
  to_defaults((instance *)c);
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetReal)(fmi2Component component, const fmi2ValueReference which[], size_t count,
                                            fmi2Real value[])
{
  instance *c = (instance *)component;
  int has_states = MODEL_STATES == 0;
  size_t i;
  if (update_results(c) != fmi2OK) return fmi2Error;
  for (i = 0; i < count; ++i) {
    if (which[i] >= MODEL_REALS) return refuse(c, no_such_variable);
    if (!has_states && which[i] >= MODEL_REALS - 2 * MODEL_STATES) {
      give_states(&c->state.inner);
      has_states = 1;
    }
    value[i] = c->state.inner.real[which[i]];
  }
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2SetReal)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                                            const fmi2Real value[])
{
  return set_reals((instance *)c, which, count, value);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetBoolean)(fmi2Component component, const fmi2ValueReference which[], size_t count,
                                               fmi2Boolean value[])
{
  instance *c = (instance *)component;
#if MODEL_BOOLEANS > 0
  size_t i;
  for (i = 0; i < count; ++i) {
    if (which[i] >= MODEL_BOOLEANS) return refuse(c, no_such_variable);
    value[i] = c->state.inner.boolean[which[i]];
  }
  return fmi2OK;
#else
  (void)which;
  (void)value;
  return refuse_any(c, count, no_such_variable);
#endif
}

#define NO_VARIABLES(function, type)                                                                             \
  FMU_EXPORT fmi2Status FMU_NAME(function)(fmi2Component c, const fmi2ValueReference which[], size_t count, type) \
  {                                                                                                              \
    (void)which;                                                                                                 \
    (void)value;                                                                                                 \
    return refuse_any((instance *)c, count, no_such_variable);                                                   \
  }

NO_VARIABLES(fmi2GetInteger, fmi2Integer value[])
NO_VARIABLES(fmi2GetString, fmi2String value[])
NO_VARIABLES(fmi2SetInteger, const fmi2Integer value[])
NO_VARIABLES(fmi2SetString, const fmi2String value[])

FMU_EXPORT fmi2Status FMU_NAME(fmi2SetBoolean)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                                               const fmi2Boolean value[])
{
  (void)which;
  (void)value;
  return refuse_any((instance *)c, count, "a result cannot be set");
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetFMUstate)(fmi2Component component, fmi2FMUstate *kept)
{
  instance *c = (instance *)component;
  return copy_state(c, kept, &c->state);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate kept)
{
  return set_state((instance *)c, kept);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *kept)
{
  return free_state((instance *)c, kept);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate kept, size_t *size)
{
  (void)c;
  (void)kept;
  *size = sizeof(state_of_instance);
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate kept, fmi2Byte bytes[], size_t size)
{
  return serialise_state((instance *)c, kept, bytes, size);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                                        fmi2FMUstate *kept)
{
  return deserialise_state((instance *)c, bytes, size, kept);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknown[],
                                                             size_t unknowns, const fmi2ValueReference known[],
                                                             size_t knowns, const fmi2Real change[], fmi2Real result[])
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

FMU_EXPORT fmi2Status FMU_NAME(fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real duration,
                                           fmi2Boolean no_earlier_state)
{
  (void)no_earlier_state;
  return advance(c, time, duration);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2CancelStep)(fmi2Component c)
{
  return refuse((instance *)c, "fmi2CancelStep: no step runs in the background");
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference which[],
                                                            size_t count, const fmi2Integer order[],
                                                            const fmi2Real value[])
{
  (void)which;
  (void)order;
  (void)value;
  return refuse_any((instance *)c, count, "fmi2SetRealInputDerivatives: inputs are constant within a step");
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference which[],
                                                             size_t count, const fmi2Integer order[], fmi2Real value[])
{
  (void)which;
  (void)order;
  (void)value;
  return refuse_any((instance *)c, count, "fmi2GetRealOutputDerivatives: not provided");
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Status *value)
{
  (void)c;
  (void)kind;
  *value = fmi2OK;
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetRealStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Real *value)
{
  (void)kind;
  *value = ((instance *)component)->state.time;
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetIntegerStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value)
{
  (void)c;
  (void)kind;
  *value = 0;
  return fmi2Discard;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetBooleanStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Boolean *value)
{
  (void)kind;
  *value = ((instance *)component)->state.phase == is_terminated;
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetStringStatus)(fmi2Component c, fmi2StatusKind kind, fmi2String *value)
{
  (void)c;
  (void)kind;
  *value = "";
  return fmi2Discard;
}

/* Model exchange. */

FMU_EXPORT fmi2Status FMU_NAME(fmi2EnterEventMode)(fmi2Component c)
{
  (void)c;
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *event)
{
  memset(event, 0, sizeof *event);
  event->valuesOfContinuousStatesChanged = model_event(&((instance *)c)->state.inner);
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2EnterContinuousTimeMode)(fmi2Component c)
{
  (void)c;
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2CompletedIntegratorStep)(fmi2Component c, fmi2Boolean no_earlier_state,
                                                            fmi2Boolean *event_mode, fmi2Boolean *ended)
{
  (void)c;
  (void)no_earlier_state;
  *event_mode = 0;
  *ended = 0;
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2SetTime)(fmi2Component c, fmi2Real time)
{
  ((instance *)c)->state.time = time;
  return fmi2OK;
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t count)
{
  return set_states((instance *)c, x, count);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetContinuousStates)(fmi2Component c, fmi2Real x[], size_t count)
{
  return get_states((instance *)c, x, count);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetDerivatives)(fmi2Component c, fmi2Real rate[], size_t count)
{
  return get_rates((instance *)c, rate, count);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetEventIndicators)(fmi2Component c, fmi2Real indicator[], size_t count)
{
  return get_indicators((instance *)c, indicator, count);
}

FMU_EXPORT fmi2Status FMU_NAME(fmi2GetNominalsOfContinuousStates)(fmi2Component c, fmi2Real nominal[], size_t count)
{
  return get_nominals((instance *)c, nominal, count);
}
#endif
