/* A muscle as a co-simulation unit, independent of the version of FMI. */

#pragma once

#include "vm_nostd.h"

/* Fibre types of the unit; more than two need a library with the feature `types`. */
#ifndef VM_FMU_FIBERS
#define VM_FMU_FIBERS 2
#endif

#define TOKEN "{b0e0a3a2-8d5c-4c8e-9f37-56495254554c}"

enum { ARITHMETIC_F32, ARITHMETIC_FIXED, ARITHMETIC_F64 };

/* What FMI sets and gets. */
typedef struct {
    VmMuscleParams params;
    double time_step_s;
    uint32_t mode;
    uint32_t arithmetic;
    double activation;
    double path_length_m;
    double stimulation_frequency_pps;
    double force_n;
    double fascicle_length;
    double fascicle_velocity;
    double relative_force;
    double max_isometric_force_n;
    uint32_t status;
} Values;

typedef enum { PARAMETER, INPUT, OUTPUT } Causality;

/* One of the values; its reference is its place in the table, counted from 1. */
typedef struct {
    const char *name;
    const char *unit;
    const char *description;
    Causality causality;
    size_t offset;
    /* 8 is a real number; 4 and 1 are integers. */
    size_t bytes;
} Variable;

typedef enum { INSTANTIATED, INITIALIZATION, STEPPING, TERMINATED, FAILED } Phase;

/* All that a state of the unit is. Plain data: a copy is a saved state. */
typedef struct {
    uint64_t token;
    Values values;
    union {
        VmMuscleF32 f32;
        VmMuscleFixed fixed;
        VmMuscleF64 f64;
        uint64_t room[VM_MUSCLE_F64_BYTES(VM_FMU_FIBERS) / 8];
    } muscle;
    double path_before_m;
    double time;
    Phase phase;
} State;

/* A message of at most this many bytes. */
#define MESSAGE 256

size_t variable_count(void);
const Variable *variable(size_t reference);

State unit_start(void);
/* Each returns 0, or 1 with a message. */
int unit_set_reals(State *state, const uint32_t *references, size_t n, const double *values, char *message);
int unit_get_reals(const State *state, const uint32_t *references, size_t n, double *values, char *message);
int unit_set_integers(State *state, const uint32_t *references, size_t n, const int32_t *values, char *message);
int unit_get_integers(const State *state, const uint32_t *references, size_t n, int32_t *values, char *message);
int unit_enter(State *state, double time, char *message);
int unit_initialize(State *state, char *message);
int unit_step(State *state, double point, double duration_s, char *message);
int unit_terminate(State *state, char *message);

/* Bytes of a serialized state: the state, and its checksum. */
#define UNIT_BYTES (sizeof(State) + sizeof(uint64_t))
int unit_serialize(const State *state, void *bytes, size_t size, char *message);
int unit_deserialize(State *state, const void *bytes, size_t size, char *message);
