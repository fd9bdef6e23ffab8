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
} Unit;

/* An error, told to the host's log. */
static fmi3Status failed(Unit *unit, const char *message) {
    if (unit && unit->log) unit->log(unit->environment, fmi3Error, "logStatusError", message);
    return fmi3Error;
}

static void *take(Unit *unit, size_t size) {
    (void)unit;
    return malloc(size);
}
static void give(Unit *unit, void *memory) {
    (void)unit;
    free(memory);
}

#define FMI(name) fmi3##name
#define HANDLE fmi3Instance
#define BYTE fmi3Byte
#include "fmi.h"

FUNCTIONS_OF_STATES(fmi3GetFMUState, fmi3SetFMUState, fmi3FreeFMUState, fmi3SerializedFMUStateSize, fmi3SerializeFMUState,
                    fmi3DeserializeFMUState)

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]) {
    (void)on, (void)n, (void)categories;
    return c ? fmi3OK : fmi3Error;
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
    (void)toleranceDefined, (void)tolerance, (void)stopDefined, (void)stop;
    DO(unit_enter(&unit->state, start, message));
}

/* As many values as references. */
static int odd(size_t n, size_t m, char *message) {
    if (n == m) return 0;
    snprintf(message, MESSAGE, "%lu values for %lu references", (unsigned long)m, (unsigned long)n);
    return 1;
}

/* Reference 0 is time, which FMI 3.0 wants as a variable. */
static int get_reals(const State *state, const fmi3ValueReference r[], size_t n, double values[], char *message) {
    for (size_t i = 0; i < n; i++) {
        if (r && values && r[i] == 0) {
            values[i] = state->time;
        } else if (unit_get_reals(state, r ? &r[i] : 0, 1, values ? &values[i] : 0, message)) {
            return 1;
        }
    }
    return 0;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 values[], size_t m) {
    DO(odd(n, m, message) || get_reals(&unit->state, r, n, values, message));
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 values[],
                          size_t m) {
    DO(odd(n, m, message) || unit_set_reals(&unit->state, r, n, values, message));
}
fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Int32 values[], size_t m) {
    DO(odd(n, m, message) || unit_get_integers(&unit->state, r, n, values, message));
}
fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Int32 values[], size_t m) {
    DO(odd(n, m, message) || unit_set_integers(&unit->state, r, n, values, message));
}

/* There are no variables of these types. */
#define NONE(type)                                                                                                     \
    fmi3Status fmi3Get##type(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3##type values[], size_t m) {  \
        (void)r, (void)values, (void)m;                                                                                \
        return none(c, n, "the unit has no variables of type " #type);                                                 \
    }                                                                                                                  \
    fmi3Status fmi3Set##type(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3##type values[],        \
                             size_t m) {                                                                               \
        (void)r, (void)values, (void)m;                                                                                \
        return none(c, n, "the unit has no variables of type " #type);                                                 \
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

static int step(Unit *unit, double point, double size, fmi3Float64 *last, char *message) {
    const int refused = unit_step(&unit->state, point, size, message);
    if (last) *last = unit->state.time;
    return refused;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 point, fmi3Float64 size, fmi3Boolean noSetState,
                      fmi3Boolean *events, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    (void)noSetState;
    if (events) *events = fmi3False;
    if (terminate) *terminate = fmi3False;
    if (early) *early = fmi3False;
    DO(step(unit, point, size, last, message));
}

/* What a co-simulation unit without events, clocks and derivatives has not. */
#define NEVER(name, ...)                                                                                               \
    fmi3Status name(fmi3Instance c, __VA_ARGS__) { return none(c, 1, #name " is not for this unit"); }
#define NEVER_ALONE(name)                                                                                              \
    fmi3Status name(fmi3Instance c) { return none(c, 1, #name " is not for this unit"); }
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
