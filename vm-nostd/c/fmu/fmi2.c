/* FMI 2.0 for co-simulation. */

#include "fmi2Functions.h"
#include "muscle.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct {
    State state;
    const fmi2CallbackFunctions *callbacks;
    fmi2Boolean logging;
    double start;
    char name[64];
} Unit;

/* An error, told to the host's log. No message has a percent sign: it is its own format, because hosts in other
   languages do not see further arguments. */
static fmi2Status failed(Unit *unit, const char *message) {
    if (unit->callbacks->logger) {
        unit->callbacks->logger(unit->callbacks->componentEnvironment, unit->name, fmi2Error, "logStatusError", message);
    }
    return fmi2Error;
}

static void *take(Unit *unit, size_t size) { return unit->callbacks->allocateMemory(1, size); }
static void give(Unit *unit, void *memory) { unit->callbacks->freeMemory(memory); }

#define FMI(name) fmi2##name
#define HANDLE fmi2Component
#define BYTE fmi2Byte
#include "fmi.h"

FUNCTIONS_OF_STATES(fmi2GetFMUstate, fmi2SetFMUstate, fmi2FreeFMUstate, fmi2SerializedFMUstateSize, fmi2SerializeFMUstate,
                    fmi2DeSerializeFMUstate)

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean logging, size_t n, const fmi2String categories[]) {
    (void)n, (void)categories;
    if (!c) return fmi2Error;
    ((Unit *)c)->logging = logging;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    Unit *unit;
    (void)resources, (void)visible;
    if (!callbacks || !callbacks->allocateMemory || !callbacks->freeMemory) return 0;
    if (type != fmi2CoSimulation || !guid || strcmp(guid, TOKEN) != 0) {
        if (callbacks->logger) {
            callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError",
                              "this unit is for co-simulation, with the GUID " TOKEN);
        }
        return 0;
    }
    unit = callbacks->allocateMemory(1, sizeof *unit);
    if (!unit) return 0;
    unit->state = unit_start();
    unit->callbacks = callbacks;
    unit->logging = logging;
    unit->start = 0.0;
    snprintf(unit->name, sizeof unit->name, "%s", name ? name : "");
    return unit;
}

void fmi2FreeInstance(fmi2Component c) {
    Unit *unit = c;
    if (unit) unit->callbacks->freeMemory(unit);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stopDefined, fmi2Real stop) {
    (void)toleranceDefined, (void)tolerance, (void)stopDefined, (void)stop;
    if (!c) return fmi2Error;
    ((Unit *)c)->start = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { DO(unit_enter(&unit->state, unit->start, message)); }

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real values[]) {
    DO(unit_get_reals(&unit->state, r, n, values, message));
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real values[]) {
    DO(unit_set_reals(&unit->state, r, n, values, message));
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer values[]) {
    DO(unit_get_integers(&unit->state, r, n, values, message));
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer values[]) {
    DO(unit_set_integers(&unit->state, r, n, values, message));
}

/* There are no variables of these types. */
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Boolean values[]) {
    (void)r, (void)values;
    return none(c, n, "the unit has no Boolean variables");
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Boolean values[]) {
    (void)r, (void)values;
    return none(c, n, "the unit has no Boolean variables");
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String values[]) {
    (void)r, (void)values;
    return none(c, n, "the unit has no String variables");
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String values[]) {
    (void)r, (void)values;
    return none(c, n, "the unit has no String variables");
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference u[], size_t nu,
                                        const fmi2ValueReference k[], size_t nk, const fmi2Real du[], fmi2Real dk[]) {
    (void)u, (void)nu, (void)k, (void)nk, (void)du, (void)dk;
    return none(c, 1, "the unit has no directional derivatives");
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                       const fmi2Integer order[], const fmi2Real values[]) {
    (void)r, (void)order, (void)values;
    return none(c, n, "the unit does not interpolate inputs");
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                        const fmi2Integer order[], fmi2Real values[]) {
    (void)r, (void)order, (void)values;
    return none(c, n, "the unit has no derivatives of outputs");
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real point, fmi2Real size, fmi2Boolean noSetState) {
    (void)noSetState;
    DO(unit_step(&unit->state, point, size, message));
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    return none(c, 1, "steps are not asynchronous");
}

#define STATUS(function, type)                                                                                         \
    fmi2Status function(fmi2Component c, const fmi2StatusKind kind, type *value) {                                     \
        (void)kind, (void)value;                                                                                       \
        return none(c, 1, "steps are not asynchronous");                                                               \
    }
STATUS(fmi2GetStatus, fmi2Status)
STATUS(fmi2GetRealStatus, fmi2Real)
STATUS(fmi2GetIntegerStatus, fmi2Integer)
STATUS(fmi2GetBooleanStatus, fmi2Boolean)
STATUS(fmi2GetStringStatus, fmi2String)
