/* FMI 3.0 for co-simulation. */

#include "fmi3Functions.h"
#include "muscle.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    State state;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
    double time;
} Unit;

/* An error, told to the host's log. */
static fmi3Status failed(Unit *unit, const char *message) {
    if (unit && unit->log) unit->log(unit->environment, fmi3Error, "logStatusError", message);
    return fmi3Error;
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]) {
    (void)c, (void)on, (void)n, (void)categories;
    return fmi3OK;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference intermediate[], size_t count,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
    Unit *unit;
    (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)intermediate;
    (void)count, (void)update;
    if (!token || strcmp(token, TOKEN) != 0) {
        if (log) log(environment, fmi3Error, "logStatusError", "the instantiation token is another unit's");
        return 0;
    }
    unit = calloc(1, sizeof *unit);
    if (!unit) return 0;
    unit->state = unit_start();
    unit->environment = environment;
    unit->log = log;
    return unit;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging;
    if (log) log(environment, fmi3Error, "logStatusError", "this unit is for co-simulation");
    return 0;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock) {
    (void)update, (void)lock, (void)unlock;
    return fmi3InstantiateModelExchange(name, token, resources, visible, logging, environment, log);
}

void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean stopDefined, fmi3Float64 stop) {
    Unit *unit = c;
    (void)toleranceDefined, (void)tolerance, (void)stopDefined, (void)stop;
    unit->time = start;
    unit->state.phase = INITIALIZATION;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    char message[MESSAGE];
    return unit_initialize(&((Unit *)c)->state, message) ? failed(c, message) : fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance c) {
    (void)c;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance c) {
    ((Unit *)c)->state = unit_start();
    return fmi3OK;
}

#define EACH(call)                                                                                                     \
    char message[MESSAGE];                                                                                             \
    Unit *unit = c;                                                                                                    \
    if (n != m) return failed(unit, "as many values as references");                                                   \
    for (size_t i = 0; i < n; i++)                                                                                     \
        if (call) return failed(unit, message);                                                                        \
    return fmi3OK

/* Reference 0 is time, which FMI 3.0 wants as a variable. */
static int real(const Unit *unit, size_t reference, double *value, char *message) {
    if (reference) return unit_get_real(&unit->state, reference, value, message);
    *value = unit->time;
    return 0;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 values[], size_t m) {
    EACH(real(unit, r[i], &values[i], message));
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 values[],
                          size_t m) {
    EACH(unit_set_real(&unit->state, r[i], values[i], message));
}
fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Int32 values[], size_t m) {
    EACH(unit_get_integer(&unit->state, r[i], &values[i], message));
}
fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Int32 values[], size_t m) {
    EACH(unit_set_integer(&unit->state, r[i], values[i], message));
}

/* There are no variables of these types. */
#define NONE(type)                                                                                                     \
    fmi3Status fmi3Get##type(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3##type values[], size_t m) {  \
        (void)r, (void)values, (void)m;                                                                                \
        return n ? failed(c, "the unit has no variables of type " #type) : fmi3OK;                                     \
    }                                                                                                                  \
    fmi3Status fmi3Set##type(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3##type values[],        \
                             size_t m) {                                                                               \
        (void)r, (void)values, (void)m;                                                                                \
        return n ? failed(c, "the unit has no variables of type " #type) : fmi3OK;                                     \
    }
NONE(Float32)
NONE(Int8)
NONE(UInt8)
NONE(Int16)
NONE(UInt16)
NONE(UInt32)
NONE(Int64)
NONE(UInt64)
NONE(Boolean)
NONE(String)

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) {
    Unit *unit = c;
    if (!*state) *state = malloc(sizeof(State));
    if (!*state) return failed(unit, "no memory for a state");
    *(State *)*state = unit->state;
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
    Unit *unit = c;
    if (!state) return failed(unit, "no state");
    unit->state = *(State *)state;
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    (void)c;
    if (state) {
        free(*state);
        *state = 0;
    }
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(State);
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    if (size < sizeof(State)) return failed(c, "too little room for a state");
    memcpy(bytes, state, sizeof(State));
    return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    if (!unit_valid(bytes, size)) return failed(c, "the bytes are no state of this unit");
    *state = malloc(sizeof(State));
    if (!*state) return failed(c, "no memory for a state");
    memcpy(*state, bytes, sizeof(State));
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 point, fmi3Float64 size, fmi3Boolean noSetState,
                      fmi3Boolean *events, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    char message[MESSAGE];
    Unit *unit = c;
    (void)noSetState;
    if (events) *events = fmi3False;
    if (terminate) *terminate = fmi3False;
    if (early) *early = fmi3False;
    if (last) *last = point;
    if (unit_step(&unit->state, size, message)) return failed(unit, message);
    unit->time = point + size;
    if (last) *last = unit->time;
    return fmi3OK;
}

/* What a co-simulation unit without events, clocks and derivatives has not. */
#define NEVER(name, ...)                                                                                               \
    fmi3Status name(fmi3Instance c, __VA_ARGS__) { return failed(c, #name " is not for this unit"); }
#define NEVER_ALONE(name)                                                                                              \
    fmi3Status name(fmi3Instance c) { return failed(c, #name " is not for this unit"); }
#pragma GCC diagnostic ignored "-Wunused-parameter"
NEVER(fmi3GetBinary, const fmi3ValueReference r[], size_t n, size_t sizes[], fmi3Binary values[], size_t m)
NEVER(fmi3SetBinary, const fmi3ValueReference r[], size_t n, const size_t sizes[], const fmi3Binary values[], size_t m)
NEVER(fmi3GetClock, const fmi3ValueReference r[], size_t n, fmi3Clock values[])
NEVER(fmi3SetClock, const fmi3ValueReference r[], size_t n, const fmi3Clock values[])
NEVER_ALONE(fmi3EnterEventMode)
NEVER(fmi3GetNumberOfVariableDependencies, fmi3ValueReference valueReference, size_t* nDependencies)
NEVER(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t elementIndicesOfDependent[],
      fmi3ValueReference independents[], size_t elementIndicesOfIndependents[], fmi3DependencyKind dependencyKinds[], size_t nDependencies)
NEVER(fmi3GetDirectionalDerivative, const fmi3ValueReference unknowns[], size_t nUnknowns,
      const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
NEVER(fmi3GetAdjointDerivative, const fmi3ValueReference unknowns[], size_t nUnknowns,
      const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
NEVER_ALONE(fmi3EnterConfigurationMode)
NEVER_ALONE(fmi3ExitConfigurationMode)
NEVER(fmi3GetIntervalDecimal, const fmi3ValueReference valueReferences[], size_t nValueReferences,
      fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
NEVER(fmi3GetIntervalFraction, const fmi3ValueReference valueReferences[], size_t nValueReferences,
      fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
NEVER(fmi3GetShiftDecimal, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3Float64 shifts[])
NEVER(fmi3GetShiftFraction, const fmi3ValueReference valueReferences[], size_t nValueReferences,
      fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NEVER(fmi3SetIntervalDecimal, const fmi3ValueReference valueReferences[], size_t nValueReferences,
      const fmi3Float64 intervals[])
NEVER(fmi3SetIntervalFraction, const fmi3ValueReference valueReferences[], size_t nValueReferences,
      const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NEVER(fmi3SetShiftDecimal, const fmi3ValueReference valueReferences[], size_t nValueReferences,
      const fmi3Float64 shifts[])
NEVER(fmi3SetShiftFraction, const fmi3ValueReference valueReferences[], size_t nValueReferences,
      const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NEVER_ALONE(fmi3EvaluateDiscreteStates)
NEVER(fmi3UpdateDiscreteStates, fmi3Boolean* discreteStatesNeedUpdate, fmi3Boolean* terminateSimulation,
      fmi3Boolean* nominalsOfContinuousStatesChanged, fmi3Boolean* valuesOfContinuousStatesChanged, fmi3Boolean* nextEventTimeDefined, fmi3Float64* nextEventTime)
NEVER_ALONE(fmi3EnterContinuousTimeMode)
NEVER(fmi3CompletedIntegratorStep, fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean* enterEventMode,
      fmi3Boolean* terminateSimulation)
NEVER(fmi3SetTime, fmi3Float64 time)
NEVER(fmi3SetContinuousStates, const fmi3Float64 continuousStates[], size_t nContinuousStates)
NEVER(fmi3GetContinuousStateDerivatives, fmi3Float64 derivatives[], size_t nContinuousStates)
NEVER(fmi3GetEventIndicators, fmi3Float64 eventIndicators[], size_t nEventIndicators)
NEVER(fmi3GetContinuousStates, fmi3Float64 continuousStates[], size_t nContinuousStates)
NEVER(fmi3GetNominalsOfContinuousStates, fmi3Float64 nominals[], size_t nContinuousStates)
NEVER(fmi3GetNumberOfEventIndicators, size_t* nEventIndicators)
NEVER(fmi3GetNumberOfContinuousStates, size_t* nContinuousStates)
NEVER_ALONE(fmi3EnterStepMode)
NEVER(fmi3GetOutputDerivatives, const fmi3ValueReference valueReferences[], size_t nValueReferences,
      const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues)
NEVER(fmi3ActivateModelPartition, fmi3ValueReference clockReference, fmi3Float64 activationTime)
