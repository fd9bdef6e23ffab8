/* The FMU as a stranger might use it: built for FMI 2.0 or 3.0 by VERSION, with the sources of the unit in one program.
   Every call is one that must be refused, or whose answer is known. */

#include "muscle.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "tests/c/fmu.c, FMI %d, line %d: %s; last message: %s\n", VERSION, __LINE__, #condition,   \
                    said);                                                                                             \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

static _Thread_local char said[MESSAGE];

#if VERSION == 2
#include "fmi2Functions.h"
#define FMI(name) fmi2##name
#define STATE(name) fmi2##name##FMUstate
#define DESERIALIZE fmi2DeSerializeFMUstate
#define SIZE fmi2SerializedFMUstateSize
static void hear(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c, fmi2String message, ...) {
    (void)e, (void)n, (void)s, (void)c;
    snprintf(said, sizeof said, "%s", message);
}
static const fmi2CallbackFunctions callbacks = {hear, calloc, free, 0, 0};
static void *begin(void) { return fmi2Instantiate("a", fmi2CoSimulation, TOKEN, 0, &callbacks, 0, 0); }
static int enter(void *c) { return fmi2SetupExperiment(c, 0, 0, 0.0, 0, 0) || fmi2EnterInitializationMode(c); }
static int set(void *c, uint32_t r, double v) { return fmi2SetReal(c, &r, 1, &v); }
static int get(void *c, uint32_t r, double *v) { return fmi2GetReal(c, &r, 1, v); }
static int set_whole(void *c, uint32_t r, int32_t v) { return fmi2SetInteger(c, &r, 1, &v); }
static int get_whole(void *c, uint32_t r, int32_t *v) { return fmi2GetInteger(c, &r, 1, v); }
static int set_many(void *c, const uint32_t *r, size_t n, const double *v) { return fmi2SetReal(c, r, n, v); }
static int get_many(void *c, const uint32_t *r, size_t n, double *v) { return fmi2GetReal(c, r, n, v); }
static int step(void *c, double at, double size) { return fmi2DoStep(c, at, size, 0); }
#else
#include "fmi3Functions.h"
#define FMI(name) fmi3##name
#define STATE(name) fmi3##name##FMUState
#define DESERIALIZE fmi3DeserializeFMUState
#define SIZE fmi3SerializedFMUStateSize
static void hear(fmi3InstanceEnvironment e, fmi3Status s, fmi3String c, fmi3String message) {
    (void)e, (void)s, (void)c;
    snprintf(said, sizeof said, "%s", message);
}
static void *begin(void) {
    return fmi3InstantiateCoSimulation("a", TOKEN, 0, 0, 0, 0, 0, 0, 0, 0, hear, 0);
}
static int enter(void *c) { return fmi3EnterInitializationMode(c, 0, 0, 0.0, 0, 0); }
static int set(void *c, uint32_t r, double v) { return fmi3SetFloat64(c, &r, 1, &v, 1); }
static int get(void *c, uint32_t r, double *v) { return fmi3GetFloat64(c, &r, 1, v, 1); }
static int set_whole(void *c, uint32_t r, int32_t v) { return fmi3SetInt32(c, &r, 1, &v, 1); }
static int get_whole(void *c, uint32_t r, int32_t *v) { return fmi3GetInt32(c, &r, 1, v, 1); }
static int set_many(void *c, const uint32_t *r, size_t n, const double *v) { return fmi3SetFloat64(c, r, n, v, n); }
static int get_many(void *c, const uint32_t *r, size_t n, double *v) { return fmi3GetFloat64(c, r, n, v, n); }
static int step(void *c, double at, double size) {
    fmi3Boolean events, ends, early;
    double last;
    return fmi3DoStep(c, at, size, 0, &events, &ends, &early, &last);
}
#endif

static uint32_t named(const char *name) {
    for (uint32_t reference = 1; reference <= variable_count(); reference++) {
        if (strcmp(variable(reference)->name, name) == 0) return reference;
    }
    CHECK(0);
    return 0;
}

static int leave(void *c) { return FMI(ExitInitializationMode)(c); }
static int finish(void *c) { return FMI(Terminate)(c); }
static int says(const char *start) { return strncmp(said, start, strlen(start)) == 0; }

/* A muscle in an arithmetic, initialized, at time 0. */
static void *ready(int32_t arithmetic) {
    void *c = begin();
    CHECK(c && !set_whole(c, named("arithmetic"), arithmetic) && !enter(c) && !leave(c));
    return c;
}

static void nobody(void) {
    double value = 0.0;
    size_t size;
    void *state = 0;
    CHECK(enter(0) && leave(0) && finish(0) && FMI(Reset)(0) && step(0, 0.0, 1e-3));
    CHECK(set(0, 1, 1.0) && get(0, 1, &value) && set_whole(0, 10, 0));
    CHECK(STATE(Get)(0, &state) && STATE(Set)(0, 0) && SIZE(0, 0, &size) && STATE(Free)(0, &state));
    FMI(FreeInstance)(0);
}

static void orders(void) {
    void *c = begin();
    double force;
    CHECK(step(c, 0.0, 1e-3) && says("the unit is not initialized"));
    CHECK(leave(c) && says("initialization ends after it has begun"));
    CHECK(finish(c) && says("the unit is not initialized"));
    CHECK(get(c, named("force_n"), &force) && says("force_n is not known before initialization"));
    /* A path on which the muscle is stretched. */
    CHECK(!set(c, named("path_length_m"), 0.19));
    CHECK(!enter(c) && enter(c) && says("initialization begins once"));
    /* Outputs are known in initialization mode. */
    CHECK(!get(c, named("force_n"), &force) && force > 1.0);
    CHECK(step(c, 0.0, 1e-3) && !leave(c) && leave(c));
    CHECK(enter(c) && says("initialization begins once"));
    CHECK(set(c, named("mass_kg"), 0.1) && says("mass_kg cannot be set after initialization"));
    CHECK(set(c, named("force_n"), 0.1) && says("force_n cannot be set because it is an output"));
    CHECK(!step(c, 0.0, 1e-3) && !finish(c) && finish(c));
    CHECK(step(c, 1e-3, 1e-3) && !get(c, named("force_n"), &force));
    /* Reset is as new; a refused parameter wants another one. */
    CHECK(!FMI(Reset)(c) && !set(c, named("mass_kg"), -1.0) && !enter(c) && leave(c));
    CHECK(says("mass_kg = -1: must be between 1e-05 and 30"));
    CHECK(step(c, 0.0, 1e-3) && enter(c) && !FMI(Reset)(c) && !enter(c) && !leave(c) && !step(c, 0.0, 1e-3));
    FMI(FreeInstance)(c);
}

static void values(void) {
    void *c = begin();
    double value;
    int32_t whole;
    const uint32_t references[2] = {named("activation"), 9999};
    CHECK(set(c, 9999, 1.0) && says("no variable has the value reference 9999"));
    CHECK(set(c, named("mode"), 1.0) && says("mode is an integer"));
    CHECK(set_whole(c, named("mass_kg"), 1) && says("mass_kg is a real number"));
    CHECK(set_whole(c, named("mode"), -1) && says("mode = -1: must be between 0"));
    CHECK(set_whole(c, named("fibers[1].rank"), 256) && says("fibers[1].rank = 256: must be between 0 and 255"));
    CHECK(get_whole(c, named("fibers[1].rank"), &whole) == 0 && whole == 3);
    CHECK(get_many(c, references, 2, &value) && set_many(c, 0, 1, &value) && get_many(c, references, 1, 0));
    CHECK(!set_many(c, 0, 0, 0));
    FMI(FreeInstance)(c);
}

static void steps(int32_t arithmetic) {
    void *c = ready(arithmetic);
    const double sizes[] = {0.0, -1e-3, 1.5e-3, 0.5e-3, 1e9, 1e300, NAN, INFINITY};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        CHECK(step(c, 0.0, sizes[i]) && says("communication step size ="));
    }
    CHECK(!step(c, 0.0, 3e-3));
    /* Where the unit is not. */
    CHECK(step(c, 0.0, 1e-3) && says("communication point = 0: the unit is at 0.003"));
    CHECK(step(c, NAN, 1e-3) && step(c, 4e-3, 1e-3) && !step(c, 3e-3, 1e-3));
    FMI(FreeInstance)(c);
}

/* A path that is not a number for one step leaves the muscle where it was, in every arithmetic. */
static void nothing(int32_t arithmetic) {
    void *c = ready(arithmetic), *other = ready(arithmetic);
    const double none[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300};
    const uint32_t path = named("path_length_m");
    double now = 0.0, force, calm;
    int32_t status;
    for (int i = 0; i < 50; i++, now += 1e-3) CHECK(!step(c, now, 1e-3) && !step(other, now, 1e-3));
    CHECK(!set(c, path, NAN) && !step(c, now, 2e-3) && !step(other, now, 2e-3));
    now += 2e-3;
    CHECK(!get_whole(c, named("status"), &status) && (status & VM_STATUS_PATH_LENGTH_NOT_FINITE));
    CHECK(!set(c, path, 0.16) && !step(c, now, 4e-3) && !step(other, now, 4e-3));
    now += 4e-3;
    CHECK(!get_whole(c, named("status"), &status) && status == 0);
    CHECK(!get(c, named("force_n"), &force) && !get(other, named("force_n"), &calm) && force == calm);
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        CHECK(!set(c, named("activation"), none[i]) && !set(c, named("stimulation_frequency_pps"), none[i]));
        CHECK(!set(c, path, none[i]) && !step(c, now, 2e-3));
        now += 2e-3;
        CHECK(!get(c, named("force_n"), &force) && isfinite(force) && force >= 0.0);
        CHECK(!get_whole(c, named("status"), &status) && status != 0);
    }
    FMI(FreeInstance)(c);
    FMI(FreeInstance)(other);
    /* And as parameters. */
    for (uint32_t reference = 1; reference <= variable_count(); reference++) {
        const Variable *v = variable(reference);
        if (v->causality != PARAMETER || v->bytes != 8) continue;
        /* Sag of the slow type and yield of the fast one are not read. */
        if (strncmp(v->name, "fibers[0].sag", 13) == 0 || strncmp(v->name, "fibers[1].yield", 15) == 0) continue;
        c = begin();
        CHECK(!set_whole(c, named("arithmetic"), arithmetic) && !set(c, reference, NAN) && !enter(c));
        said[0] = 0;
        CHECK(leave(c) && strstr(said, "nan"));
        FMI(FreeInstance)(c);
    }
}

static void states(void) {
    void *c = ready(0), *other = ready(2), *state = 0, *back = 0, *empty = 0;
    size_t size = 0;
    double first, second;
    CHECK(!set(c, named("activation"), 0.5) && !step(c, 0.0, 10e-3));
    CHECK(STATE(Get)(c, 0) && STATE(Set)(c, 0) && says("no state of this unit"));
    CHECK(!STATE(Get)(c, &state) && SIZE(c, state, 0) && !SIZE(c, state, &size));
    unsigned char *bytes = malloc(size);
    CHECK(STATE(Serialize)(c, state, (void *)bytes, size - 1) && STATE(Serialize)(c, state, 0, size));
    CHECK(STATE(Serialize)(c, 0, (void *)bytes, size) && !STATE(Serialize)(c, state, (void *)bytes, size));
    CHECK(!step(c, 10e-3, 5e-3) && !get(c, named("force_n"), &first));
    /* Time comes back with the state, also in an instance of other parameters. */
    CHECK(!STATE(Set)(c, state) && !step(c, 10e-3, 5e-3) && !get(c, named("force_n"), &second) && first == second);
    CHECK(!STATE(Set)(other, state) && !step(other, 10e-3, 5e-3) && !get(other, named("force_n"), &second));
    CHECK(first == second);
    CHECK(DESERIALIZE(c, (void *)bytes, size - 1, &back) && DESERIALIZE(c, 0, size, &back));
    CHECK(DESERIALIZE(c, (void *)bytes, size, 0));
    /* No flipped bit is taken. */
    for (size_t i = 0; i < size; i += 1) {
        bytes[i] ^= 4;
        CHECK(DESERIALIZE(c, (void *)bytes, size, &empty) && says("the bytes are no state of this unit"));
        bytes[i] ^= 4;
    }
    CHECK(!DESERIALIZE(c, (void *)bytes, size, &back) && !STATE(Set)(c, back) && !step(c, 10e-3, 5e-3));
    CHECK(!get(c, named("force_n"), &second) && first == second);
    CHECK(!STATE(Free)(c, &state) && !state && !STATE(Free)(c, &state) && !STATE(Free)(c, 0) && !STATE(Free)(c, &back));
    free(bytes);
    FMI(FreeInstance)(c);
    FMI(FreeInstance)(other);
}

/* An instance of a thread of its own. */
static void *alone(void *result) {
    void *c = ready(0);
    CHECK(!set(c, named("activation"), 0.7));
    for (int i = 0; i < 300; i++) CHECK(!step(c, i * 1e-3, 1e-3));
    CHECK(!get(c, named("force_n"), result));
    FMI(FreeInstance)(c);
    return 0;
}

static void threads(void) {
    pthread_t thread[8];
    double force[8];
    for (int i = 0; i < 8; i++) CHECK(!pthread_create(&thread[i], 0, alone, &force[i]));
    for (int i = 0; i < 8; i++) CHECK(!pthread_join(thread[i], 0));
    for (int i = 1; i < 8; i++) CHECK(force[i] == force[0] && force[0] > 10.0);
}

int main(void) {
    /* First: nothing may have been prepared by a single thread. */
    threads();
    nobody();
    orders();
    values();
    for (int32_t arithmetic = 0; arithmetic < 3; arithmetic++) {
        steps(arithmetic);
        nothing(arithmetic);
    }
    states();
    return 0;
}
