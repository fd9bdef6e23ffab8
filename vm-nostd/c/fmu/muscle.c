/* The muscle behind the unit: built when initialization ends, stepped tick by tick, saved as plain data. */

#include "muscle.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

State unit_start(void) {
    State state;
    VmMuscleParams *params = &state.values.params;
    memset(&state, 0, sizeof state);
    memcpy(&state.token, "VM_FMU_2", sizeof state.token);
    /* The paper's validation muscle. */
    params->version = VM_VERSION;
    params->fiber_count = 2;
    params->mass_kg = 97.5e-3;
    params->fascicle_length_m = 0.11;
    params->tendon_length_m = 0.02;
    params->max_path_length_m = 0.184;
    params->recruitment_saturation = 0.8;
    vm_params_paper(&params->elements, &params->fibers[0], &params->fibers[1]);
    for (unsigned index = 2; index < VM_FMU_FIBERS; index++) params->fibers[index] = params->fibers[1];
    params->fibers[0].fraction = 0.6;
    params->fibers[1].fraction = 0.4;
    state.values.time_step_s = 1e-3;
    state.values.path_length_m = 0.16;
    state.values.stimulation_frequency_pps = 20.0;
    return state;
}

int unit_enter(State *state, double time, char *message) {
    if (state->phase != INSTANTIATED) {
        snprintf(message, MESSAGE, "initialization begins once, after instantiation or reset");
        return 1;
    }
    state->phase = INITIALIZATION;
    state->time = time;
    return 0;
}

int unit_terminate(State *state, char *message) {
    if (state->phase != STEPPING) {
        snprintf(message, MESSAGE, "the unit is not initialized");
        return 1;
    }
    state->phase = TERMINATED;
    return 0;
}

/* What went wrong, in words. */
static int said(VmResult result, const VmError *error, char *message) {
    if (result == VM_RESULT_OK) return 0;
    if (result != VM_RESULT_PARAMETER) {
        snprintf(message, MESSAGE, "the library returned %d", (int)result);
    } else if (error->fiber >= 0) {
        snprintf(message, MESSAGE, "fibers[%ld].%s = %g: must be between %g and %g", (long)error->fiber, error->field,
                 error->value, error->least, error->most);
    } else {
        snprintf(message, MESSAGE, "%s = %g: must be between %g and %g", error->field, error->value, error->least,
                 error->most);
    }
    return 1;
}

/* In fixed point, NaN becomes 0: integers have none. */
static int32_t whole(double value) {
    return value >= 2147483647.0 ? 2147483647 : value > -2147483647.0 ? (int32_t)lround(value) : value < 0.0 ? -2147483647 : 0;
}

static uint16_t part(double value, double most) {
    return (uint16_t)(value >= most ? most : value > 0.0 ? lround(value) : 0);
}

#define NUMBER(fixed) ((double)(fixed) / 16777216.0)

/* Outputs from the muscle's state after a step. */
#define TAKE(output, force)                                                                                            \
    (values->force_n = (force), values->fascicle_length = (output).fascicle_length,                                    \
     values->fascicle_velocity = (output).fascicle_velocity, values->relative_force = (output).relative_force,         \
     values->status = (output).status)

static void take_fixed(Values *values, const VmOutputFixed *output) {
    values->relative_force = NUMBER(output->relative_force);
    /* Finer than the force in mN. */
    values->force_n = values->relative_force * values->max_isometric_force_n;
    values->fascicle_length = NUMBER(output->fascicle_length);
    values->fascicle_velocity = NUMBER(output->fascicle_velocity);
    values->status = output->status;
}

int unit_initialize(State *state, char *message) {
    Values *values = &state->values;
    const size_t size = sizeof state->muscle;
    const uint32_t mode = values->mode;
    const double step = values->time_step_s, path = values->path_length_m;
    VmDerived derived;
    VmError error;
    VmResult result;
    if (state->phase != INITIALIZATION) {
        snprintf(message, MESSAGE, "initialization ends after it has begun");
        return 1;
    }
    state->phase = FAILED;
    if (values->params.fiber_count > VM_FMU_FIBERS) {
        snprintf(message, MESSAGE, "fiber_count = %lu: must be between 1 and %d",
                 (unsigned long)values->params.fiber_count, VM_FMU_FIBERS);
        return 1;
    }
    if (said(vm_params_derive(&values->params, &derived, &error), &error, message)) return 1;
    values->max_isometric_force_n = derived.max_isometric_force_n;
    if (values->arithmetic == ARITHMETIC_F32) {
        result = vm_f32_build(&state->muscle.f32, size, &values->params, mode, step, &error);
    } else if (values->arithmetic == ARITHMETIC_FIXED) {
        result = vm_fixed_build(&state->muscle.fixed, size, &values->params, mode, step, &error);
    } else if (values->arithmetic == ARITHMETIC_F64) {
        result = vm_f64_build(&state->muscle.f64, size, &values->params, mode, step, &error);
    } else {
        snprintf(message, MESSAGE, "arithmetic = %ld: must be between 0 and 2", (long)values->arithmetic);
        return 1;
    }
    if (said(result, &error, message)) return 1;
    if (values->arithmetic == ARITHMETIC_F32) {
        VmOutputF32 output;
        result = vm_f32_rest(&state->muscle.f32, (float)path);
        if (!result && !vm_f32_observe(&state->muscle.f32, &output)) TAKE(output, output.force_n);
    } else if (values->arithmetic == ARITHMETIC_FIXED) {
        VmOutputFixed output;
        result = vm_fixed_rest(&state->muscle.fixed, whole(path * 1e6));
        if (!result && !vm_fixed_observe(&state->muscle.fixed, &output)) take_fixed(values, &output);
    } else {
        VmOutputF64 output;
        result = vm_f64_rest(&state->muscle.f64, path);
        if (!result && !vm_f64_observe(&state->muscle.f64, &output)) TAKE(output, output.force_n);
    }
    if (result) {
        snprintf(message, MESSAGE, "path_length_m = %g: must be between %g and %g", path, derived.path_domain_m[0],
                 derived.path_domain_m[1]);
        return 1;
    }
    state->path_before_m = path;
    state->phase = STEPPING;
    return 0;
}

/* One tick on a path. In fixed point a path that is not a number is, as in floating point, the last one, and flagged. */
static VmResult tick(State *state, double path) {
    Values *values = &state->values;
    const int lost = isnan(path);
    const double activation = values->activation, frequency = values->stimulation_frequency_pps;
    VmResult result;
    if (values->arithmetic == ARITHMETIC_F32) {
        const VmInputF32 input = {(float)activation, (float)path, (float)frequency};
        VmOutputF32 output;
        result = vm_f32_step(&state->muscle.f32, &input, &output);
        if (!result) TAKE(output, output.force_n);
    } else if (values->arithmetic == ARITHMETIC_FIXED) {
        const double kept = lost ? state->path_before_m : path;
        const VmInputFixed input = {whole(kept * 1e6), part(activation * 1e3, 65535.0), part(frequency * 10.0, 65535.0)};
        VmOutputFixed output;
        result = vm_fixed_step(&state->muscle.fixed, &input, &output);
        if (!result) take_fixed(values, &output);
        if (lost) values->status |= VM_STATUS_PATH_LENGTH_NOT_FINITE;
    } else {
        const VmInputF64 input = {activation, path, frequency};
        VmOutputF64 output;
        result = vm_f64_step(&state->muscle.f64, &input, &output);
        if (!result) TAKE(output, output.force_n);
    }
    return result;
}

int unit_step(State *state, double point, double duration_s, char *message) {
    const Values *values = &state->values;
    const double step = values->time_step_s, ticks = round(duration_s / step);
    const double before = state->path_before_m, after = values->path_length_m;
    uint32_t flags = 0;
    if (state->phase != STEPPING) {
        snprintf(message, MESSAGE, "the unit is not initialized");
        return 1;
    }
    if (!(fabs(point - state->time) < 0.5 * step)) {
        snprintf(message, MESSAGE, "communication point = %.9g: the unit is at %.9g", point, state->time);
        return 1;
    }
    if (!(ticks >= 1.0 && ticks <= 1e6 && fabs(duration_s - ticks * step) <= 1e-6 * step)) {
        snprintf(message, MESSAGE, "communication step size = %g: must be a whole multiple of time_step_s = %g",
                 duration_s, step);
        return 1;
    }
    for (double done = 1.0; done <= ticks; done += 1.0) {
        /* The path moves evenly through the ticks of a step. */
        const VmResult result = tick(state, done == ticks ? after : before + (after - before) * done / ticks);
        if (result) {
            snprintf(message, MESSAGE, "the library returned %d", (int)result);
            return 1;
        }
        flags |= values->status;
    }
    state->values.status = flags;
    /* A path that was lost, or beyond all ranges, is no place from which the next one moves. */
    if (isfinite(after)) state->path_before_m = after;
    state->time = point + duration_s;
    return 0;
}

/* FNV-1a of a state. */
static uint64_t checksum(const State *state) {
    uint64_t sum = 0xcbf29ce484222325u;
    for (size_t i = 0; i < sizeof *state; i++) sum = (sum ^ ((const unsigned char *)state)[i]) * 0x100000001b3u;
    return sum;
}

int unit_serialize(const State *state, void *bytes, size_t size, char *message) {
    if (!state || !bytes || size < UNIT_BYTES) {
        snprintf(message, MESSAGE, "a state needs room for %lu bytes", (unsigned long)UNIT_BYTES);
        return 1;
    }
    const uint64_t sum = checksum(state);
    memcpy(bytes, state, sizeof *state);
    memcpy((char *)bytes + sizeof *state, &sum, sizeof sum);
    return 0;
}

int unit_deserialize(State *state, const void *bytes, size_t size, char *message) {
    uint64_t sum;
    if (state && bytes && size == UNIT_BYTES) {
        memcpy(state, bytes, sizeof *state);
        memcpy(&sum, (const char *)bytes + sizeof *state, sizeof sum);
        if (memcmp(&state->token, "VM_FMU_2", 8) == 0 && sum == checksum(state)) return 0;
    }
    snprintf(message, MESSAGE, "the bytes are no state of this unit");
    return 1;
}
