/* SPDX-License-Identifier: BSD-3-Clause */
/* The Functional Mock-up Interface 3.0 for co-simulation and model exchange around a model; see fmu.h for what stands
 * before it.  Value references count the scalars, then the booleans, time, the vector of the states, that of their
 * derivatives and that of the event indicators.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef bool fmi3Clock;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum { fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent } fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category, fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean, fmi3Boolean,
                                               fmi3Boolean, fmi3Boolean, fmi3Boolean *, fmi3Float64 *);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

#ifdef FMI3_FUNCTION_PREFIX
#define FMU_PREFIX FMI3_FUNCTION_PREFIX
#endif

#define TOKEN_NAME "instantiation token"
#define status_ok fmi3OK
#define status_error fmi3Error
typedef fmi3Status status;
typedef struct {
  fmi3InstanceEnvironment environment;
  fmi3LogMessageCallback log;
} simulator;

static void tell(const simulator *driver, const char *why)
{
  if (driver->log) driver->log(driver->environment, fmi3Error, "logStatusError", why);
}

static void *allocate(const simulator *driver, size_t size)
{
  (void)driver;
  return calloc(1, size);
}

static void release(const simulator *driver, void *memory)
{
  (void)driver;
  free(memory);
}

#include "fmu.h"

#if !defined(FMU_FOR_AVX512)
#define MODEL_SCALARS (MODEL_REALS - 2 * MODEL_STATES)
enum {
  of_time = MODEL_SCALARS + MODEL_BOOLEANS,
  of_states,
  of_rates,
  of_indicators
};

FMU_EXPORT const char *FMU_NAME(fmi3GetVersion)(void)
{
  return "3.0";
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3SetDebugLogging)(fmi3Instance c, fmi3Boolean on, size_t count,
                                                    const fmi3String categories[])
{
  (void)c;
  (void)on;
  (void)count;
  (void)categories;
  return fmi3OK;
}

FMU_EXPORT fmi3Instance FMU_NAME(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                               fmi3Boolean visible, fmi3Boolean logging,
                                                               fmi3InstanceEnvironment environment,
                                                               fmi3LogMessageCallback log)
{
  const simulator driver = {environment, log};
  (void)name;
  (void)resources;
  (void)visible;
  (void)logging;
  return instantiate(&driver, 1, token);
}

FMU_EXPORT fmi3Instance FMU_NAME(fmi3InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference intermediate[], size_t intermediates,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
  const simulator driver = {environment, log};
  (void)name;
  (void)resources;
  (void)visible;
  (void)logging;
  (void)early_return;
  (void)intermediate;
  (void)update;
  if (event_mode || intermediates > 0) {
    tell(&driver, "this model has no event mode in co-simulation and gives no intermediate values");
    return 0;
  }
  return instantiate(&driver, 0, token);
}

FMU_EXPORT fmi3Instance FMU_NAME(fmi3InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
  const simulator driver = {environment, log};
  (void)name;
  (void)token;
  (void)resources;
  (void)visible;
  (void)logging;
  (void)update;
  (void)lock;
  (void)unlock;
  tell(&driver, "this model is not for scheduled execution");
  return 0;
}

FMU_EXPORT void FMU_NAME(fmi3FreeInstance)(fmi3Instance c)
{
  free(c);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3EnterInitializationMode)(fmi3Instance component, fmi3Boolean has_tolerance,
                                                            fmi3Float64 tolerance, fmi3Float64 start,
                                                            fmi3Boolean has_stop, fmi3Float64 stop)
{
  instance *c = (instance *)component;
  const fmi3Status entered = enter_initialisation(c);
  (void)has_tolerance;
  (void)tolerance;
  (void)has_stop;
  (void)stop;
  if (entered == fmi3OK) c->state.time = start;
  return entered;
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3ExitInitializationMode)(fmi3Instance c)
{
  return exit_initialisation((instance *)c);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3Terminate)(fmi3Instance c)
{
  return terminate((instance *)c);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3Reset)(fmi3Instance c)
{
  to_defaults((instance *)c);
  return fmi3OK;
}

/* Values of a variable of type Float64, a scalar or a vector: their number, 0 if there is no such variable. */
static size_t values_of(instance *c, fmi3ValueReference which, double *indicators, const double **value)
{
  model *m = &c->state.inner;
  *value = m->real + which;
  if (which < MODEL_SCALARS) return 1;
  *value = &c->state.time;
  if (which == of_time) return 1;
  if (which < of_time) return 0;
  give_states(m);
  *value = m->real + MODEL_SCALARS + (which == of_rates ? MODEL_STATES : 0);
  if (which == of_states || which == of_rates) return MODEL_STATES;
  model_indicators(m, indicators);
  *value = indicators;
  return which == of_indicators ? MODEL_EVENTS : 0;
}

static const char wrong_length[] = "the number of values is not that of the variables";

FMU_EXPORT fmi3Status FMU_NAME(fmi3GetFloat64)(fmi3Instance component, const fmi3ValueReference which[], size_t count,
                                               fmi3Float64 value[], size_t values)
{
  instance *c = (instance *)component;
  double indicators[MODEL_EVENTS + 1];
  size_t i, given = 0;
  if (update_results(c) != fmi3OK) return fmi3Error;
  for (i = 0; i < count; ++i) {
    const double *of;
    const size_t size = values_of(c, which[i], indicators, &of);
    if (size == 0) return refuse(c, no_such_variable);
    if (size > values - given) return refuse(c, wrong_length);
    memcpy(value + given, of, size * sizeof *value);
    given += size;
  }
  return given == values ? fmi3OK : refuse(c, wrong_length);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3SetFloat64)(fmi3Instance component, const fmi3ValueReference which[], size_t count,
                                               const fmi3Float64 value[], size_t values)
{
  instance *c = (instance *)component;
  size_t i;
  for (i = 0; i < count; ++i) {
    if (which[i] >= MODEL_SCALARS) return refuse(c, "a result cannot be set, or no variable has this value reference");
  }
  return values == count ? set_reals(c, which, count, value) : refuse(c, wrong_length);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3GetBoolean)(fmi3Instance component, const fmi3ValueReference which[], size_t count,
                                               fmi3Boolean value[], size_t values)
{
  instance *c = (instance *)component;
#if MODEL_BOOLEANS > 0
  size_t i;
  if (values != count) return refuse(c, wrong_length);
  for (i = 0; i < count; ++i) {
    if (which[i] < MODEL_SCALARS || which[i] >= of_time) return refuse(c, no_such_variable);
    value[i] = c->state.inner.boolean[which[i] - MODEL_SCALARS] != 0;
  }
  return fmi3OK;
#else
  (void)which;
  (void)value;
  (void)values;
  return refuse_any(c, count, no_such_variable);
#endif
}

/* Functions of variables that a model has none of. */
#define REFERENCES fmi3Instance c, const fmi3ValueReference which[], size_t count
#define NONE(function, parameters, ...)                        \
  FMU_EXPORT fmi3Status FMU_NAME(function) parameters          \
  {                                                            \
    (void)which;                                               \
    __VA_ARGS__;                                               \
    return refuse_any((instance *)c, count, no_such_variable); \
  }
#define NONE_TO_GET(type) NONE(fmi3Get##type, (REFERENCES, fmi3##type a[], size_t n), (void)a, (void)n)
#define NONE_TO_SET(type) NONE(fmi3Set##type, (REFERENCES, const fmi3##type a[], size_t n), (void)a, (void)n)

NONE_TO_GET(Float32)
NONE_TO_SET(Float32)
NONE_TO_GET(Int8)
NONE_TO_SET(Int8)
NONE_TO_GET(UInt8)
NONE_TO_SET(UInt8)
NONE_TO_GET(Int16)
NONE_TO_SET(Int16)
NONE_TO_GET(UInt16)
NONE_TO_SET(UInt16)
NONE_TO_GET(Int32)
NONE_TO_SET(Int32)
NONE_TO_GET(UInt32)
NONE_TO_SET(UInt32)
NONE_TO_GET(Int64)
NONE_TO_SET(Int64)
NONE_TO_GET(UInt64)
NONE_TO_SET(UInt64)
NONE_TO_GET(String)
NONE_TO_SET(String)
NONE_TO_SET(Boolean)
NONE(fmi3GetBinary, (REFERENCES, size_t size[], fmi3Binary a[], size_t n), (void)size, (void)a, (void)n)
NONE(fmi3SetBinary, (REFERENCES, const size_t size[], const fmi3Binary a[], size_t n), (void)size, (void)a, (void)n)
NONE(fmi3GetClock, (REFERENCES, fmi3Clock a[]), (void)a)
NONE(fmi3SetClock, (REFERENCES, const fmi3Clock a[]), (void)a)
NONE(fmi3GetIntervalDecimal, (REFERENCES, fmi3Float64 a[], fmi3IntervalQualifier b[]), (void)a, (void)b)
NONE(fmi3GetIntervalFraction, (REFERENCES, fmi3UInt64 a[], fmi3UInt64 b[], fmi3IntervalQualifier q[]), (void)a, (void)b,
     (void)q)
NONE(fmi3SetIntervalDecimal, (REFERENCES, const fmi3Float64 a[]), (void)a)
NONE(fmi3SetIntervalFraction, (REFERENCES, const fmi3UInt64 a[], const fmi3UInt64 b[]), (void)a, (void)b)
NONE(fmi3GetShiftDecimal, (REFERENCES, fmi3Float64 a[]), (void)a)
NONE(fmi3GetShiftFraction, (REFERENCES, fmi3UInt64 a[], fmi3UInt64 b[]), (void)a, (void)b)
NONE(fmi3SetShiftDecimal, (REFERENCES, const fmi3Float64 a[]), (void)a)
NONE(fmi3SetShiftFraction, (REFERENCES, const fmi3UInt64 a[], const fmi3UInt64 b[]), (void)a, (void)b)
NONE(fmi3GetOutputDerivatives, (REFERENCES, const fmi3Int32 order[], fmi3Float64 a[], size_t n), (void)order, (void)a,
     (void)n)

FMU_EXPORT fmi3Status FMU_NAME(fmi3GetFMUState)(fmi3Instance component, fmi3FMUState *kept)
{
  instance *c = (instance *)component;
  return copy_state(c, kept, &c->state);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3SetFMUState)(fmi3Instance c, fmi3FMUState kept)
{
  return set_state((instance *)c, kept);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3FreeFMUState)(fmi3Instance c, fmi3FMUState *kept)
{
  return free_state((instance *)c, kept);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3SerializedFMUStateSize)(fmi3Instance c, fmi3FMUState kept, size_t *size)
{
  (void)c;
  (void)kept;
  *size = sizeof(state_of_instance);
  return fmi3OK;
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3SerializeFMUState)(fmi3Instance c, fmi3FMUState kept, fmi3Byte bytes[], size_t size)
{
  return serialise_state((instance *)c, kept, bytes, size);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3DeserializeFMUState)(fmi3Instance c, const fmi3Byte bytes[], size_t size,
                                                        fmi3FMUState *kept)
{
  return deserialise_state((instance *)c, bytes, size, kept);
}

/* What modelDescription.xml says a model cannot do. */
#define NOT_PROVIDED(function, parameters, ...)              \
  FMU_EXPORT fmi3Status FMU_NAME(function) parameters        \
  {                                                          \
    __VA_ARGS__;                                             \
    return refuse((instance *)c, #function ": not provided"); \
  }
#define DERIVATIVE_PARAMETERS                                                                                         \
  (fmi3Instance c, const fmi3ValueReference of[], size_t n_of, const fmi3ValueReference by[], size_t n_by,            \
   const fmi3Float64 seed[], size_t n_seed, fmi3Float64 result[], size_t n_result)
#define DERIVATIVE_UNUSED \
  (void)of, (void)n_of, (void)by, (void)n_by, (void)seed, (void)n_seed, (void)result, (void)n_result

NOT_PROVIDED(fmi3GetDirectionalDerivative, DERIVATIVE_PARAMETERS, DERIVATIVE_UNUSED)
NOT_PROVIDED(fmi3GetAdjointDerivative, DERIVATIVE_PARAMETERS, DERIVATIVE_UNUSED)
NOT_PROVIDED(fmi3GetNumberOfVariableDependencies, (fmi3Instance c, fmi3ValueReference of, size_t *n), (void)of, (void)n)
NOT_PROVIDED(fmi3GetVariableDependencies,
             (fmi3Instance c, fmi3ValueReference of, size_t of_element[], fmi3ValueReference by[], size_t by_element[],
              fmi3DependencyKind kind[], size_t n),
             (void)of, (void)of_element, (void)by, (void)by_element, (void)kind, (void)n)
NOT_PROVIDED(fmi3EnterConfigurationMode, (fmi3Instance c), (void)0)
NOT_PROVIDED(fmi3ExitConfigurationMode, (fmi3Instance c), (void)0)
NOT_PROVIDED(fmi3EnterStepMode, (fmi3Instance c), (void)0)
NOT_PROVIDED(fmi3EvaluateDiscreteStates, (fmi3Instance c), (void)0)
NOT_PROVIDED(fmi3ActivateModelPartition, (fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time), (void)clock,
             (void)time)

/* Co-simulation. */

FMU_EXPORT fmi3Status FMU_NAME(fmi3DoStep)(fmi3Instance component, fmi3Float64 time, fmi3Float64 duration,
                                           fmi3Boolean no_earlier_state, fmi3Boolean *needs_event,
                                           fmi3Boolean *is_ended, fmi3Boolean *returns_early, fmi3Float64 *reached)
{
  instance *c = (instance *)component;
  const fmi3Status stepped = advance(c, time, duration);
  (void)no_earlier_state;
  *needs_event = *is_ended = *returns_early = false;
  *reached = c->state.time;
  return stepped;
}

/* Model exchange. */

FMU_EXPORT fmi3Status FMU_NAME(fmi3EnterEventMode)(fmi3Instance component)
{
  instance *c = (instance *)component;
  return c->exchanges ? fmi3OK : refuse(c, "this model has no event mode in co-simulation");
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3UpdateDiscreteStates)(fmi3Instance c, fmi3Boolean *needs_more,
                                                         fmi3Boolean *is_ended, fmi3Boolean *nominals_changed,
                                                         fmi3Boolean *states_changed, fmi3Boolean *has_next,
                                                         fmi3Float64 *next)
{
  *needs_more = *is_ended = *nominals_changed = *has_next = false;
  *next = 0;
  *states_changed = model_event(&((instance *)c)->state.inner) != 0;
  return fmi3OK;
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3EnterContinuousTimeMode)(fmi3Instance c)
{
  (void)c;
  return fmi3OK;
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3CompletedIntegratorStep)(fmi3Instance c, fmi3Boolean no_earlier_state,
                                                            fmi3Boolean *event_mode, fmi3Boolean *is_ended)
{
  (void)c;
  (void)no_earlier_state;
  *event_mode = *is_ended = false;
  return fmi3OK;
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3SetTime)(fmi3Instance c, fmi3Float64 time)
{
  ((instance *)c)->state.time = time;
  return fmi3OK;
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3SetContinuousStates)(fmi3Instance c, const fmi3Float64 x[], size_t count)
{
  return set_states((instance *)c, x, count);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3GetContinuousStates)(fmi3Instance c, fmi3Float64 x[], size_t count)
{
  return get_states((instance *)c, x, count);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3GetContinuousStateDerivatives)(fmi3Instance c, fmi3Float64 rate[], size_t count)
{
  return get_rates((instance *)c, rate, count);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3GetEventIndicators)(fmi3Instance c, fmi3Float64 indicator[], size_t count)
{
  return get_indicators((instance *)c, indicator, count);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3GetNominalsOfContinuousStates)(fmi3Instance c, fmi3Float64 nominal[], size_t count)
{
  return get_nominals((instance *)c, nominal, count);
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3GetNumberOfContinuousStates)(fmi3Instance c, size_t *count)
{
  (void)c;
  *count = MODEL_STATES;
  return fmi3OK;
}

FMU_EXPORT fmi3Status FMU_NAME(fmi3GetNumberOfEventIndicators)(fmi3Instance c, size_t *count)
{
  (void)c;
  *count = MODEL_EVENTS;
  return fmi3OK;
}
#endif
