#include "muscle.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MOST_VARIABLES (64 + 32 * VM_FMU_FIBERS)

static Variable table[MOST_VARIABLES];
static size_t count;

static void add(const char *name, const char *unit, const char *description, Causality causality, size_t offset,
                size_t bytes) {
    Variable *place = &table[count++];
    snprintf(place->name, sizeof place->name, "%s", name);
    place->unit = unit;
    place->description = description;
    place->causality = causality;
    place->offset = offset;
    place->bytes = bytes;
}

#define AT(field) offsetof(Values, field)
#define REAL(field, unit, description) add(#field, unit, description, PARAMETER, AT(params.field), 8)
#define WHOLE(field, description) add(#field, 0, description, PARAMETER, AT(params.field), 4)
#define ELEMENT(field, unit, description) add(#field, unit, description, PARAMETER, AT(params.elements.field), 8)

static void add_fiber(unsigned index) {
    const size_t base = AT(params.fibers) + index * sizeof(VmFiber);
    char name[48];
#define FIBER(field, member, unit, description, bytes)                                                                 \
    snprintf(name, sizeof name, "fibers[%u]." field, index);                                                           \
    add(name, unit, description, PARAMETER, base + offsetof(VmFiber, member), bytes)
#define F(field, unit, description) FIBER(#field, field, unit, description, 8)
    F(fraction, "1", "share of the cross-sectional area; all add to 1");
    FIBER("rank", rank, 0, "order of recruitment", 1);
    FIBER("has_sag", has_sag, 0, "1 if the type has sag", 1);
    FIBER("has_yield", has_yield, 0, "1 if the type has yield", 1);
    F(half_force_frequency, "Hz", "f_0.5");
    F(minimum_frequency, "1", "f_min, f_0.5");
    F(maximum_frequency, "1", "f_max, f_0.5");
    F(force_length_width, "1", "omega of FL");
    F(force_length_skewness, "1", "beta of FL");
    F(force_length_roundness, "1", "rho of FL");
    F(maximum_velocity, "1/s", "V_max, L_ce0/s, negative");
    FIBER("shortening_0", shortening, "1", "c_V0 of FV", 8);
    FIBER("shortening_1", shortening[1], "1", "c_V1 of FV", 8);
    FIBER("lengthening_0", lengthening, "1", "a_V0 of FV", 8);
    FIBER("lengthening_1", lengthening[1], "1", "a_V1 of FV", 8);
    FIBER("lengthening_2", lengthening[2], "1", "a_V2 of FV", 8);
    F(lengthening_velocity, "1/s", "b_V of FV, L_ce0/s");
    F(activation_scale, "1", "a_f of Af");
    F(activation_exponent, "1", "n_f0 of Af");
    F(activation_length_dependence, "1", "n_f1 of Af");
    F(rise_s, "s", "T_f1");
    F(rise_per_frequency_s, "s", "T_f2");
    F(fall_s, "s", "T_f3");
    F(fall_per_activation_s, "s", "T_f4");
    F(effective_length_time_s, "s", "T_L; not used by the modes of this unit");
    F(sag_resting_level, "1", "a_S1, if it sags");
    F(sag_firing_level, "1", "a_S2, if it sags");
    F(sag_time_s, "s", "T_S, if it sags");
    F(yield_depth, "1", "c_Y, if it yields");
    F(yield_velocity, "1/s", "V_Y, L_ce0/s, if it yields");
    F(yield_time_s, "s", "T_Y, if it yields");
}

static void fill(void) {
    if (count) return;
    add("activation", "1", "U, or strength of the stimulus (FES); 0..1", INPUT, AT(activation), 8);
    add("path_length_m", "m", "musculotendon path at the end of the step", INPUT, AT(path_length_m), 8);
    add("stimulation_frequency_pps", "Hz", "pulses per second; FES only", INPUT, AT(stimulation_frequency_pps), 8);
    add("force_n", "N", "tendon force", OUTPUT, AT(force_n), 8);
    add("fascicle_length", "1", "L_ce0", OUTPUT, AT(fascicle_length), 8);
    add("fascicle_velocity", "1/s", "L_ce0/s, positive when lengthening", OUTPUT, AT(fascicle_velocity), 8);
    add("relative_force", "1", "tendon force over F0", OUTPUT, AT(relative_force), 8);
    add("max_isometric_force_n", "N", "F0", OUTPUT, AT(max_isometric_force_n), 8);
    add("status", 0, "VM_STATUS_ flags of the step; 0 if nothing was clipped", OUTPUT, AT(status), 4);
    add("mode", 0, "0 natural continuous recruitment, 1 intramuscular FES", PARAMETER, AT(mode), 4);
    add("arithmetic", 0, "0 f32, 1 fixed point, 2 f64", PARAMETER, AT(arithmetic), 4);
    add("time_step_s", "s", "tick of the model; steps are whole multiples of it", PARAMETER, AT(time_step_s), 8);
    WHOLE(accuracy_class, "0 standard, 1 economy, 2 fine");
    WHOLE(fiber_count, "number of fibre types");
    REAL(mass_kg, "kg", "muscle mass");
    REAL(fascicle_length_m, "m", "optimal fascicle length L_ce0");
    REAL(tendon_length_m, "m", "optimal tendon length L_se0");
    REAL(max_path_length_m, "m", "longest path L_mt_max");
    REAL(recruitment_saturation, "1", "U_r");
    ELEMENT(tendon_stiffness, "1", "c_T");
    ELEMENT(tendon_toe, "1", "k_T");
    ELEMENT(tendon_slack_length, "1", "L_r_T, L_se0");
    ELEMENT(parallel_stiffness, "1", "c_1");
    ELEMENT(parallel_toe, "1", "k_1");
    ELEMENT(parallel_slack_length, "1", "L_r1, L_max");
    ELEMENT(parallel_viscosity, "s", "eta, F0 s/L_ce0");
    ELEMENT(compression_strength, "1", "c_2");
    ELEMENT(compression_steepness, "1", "k_2");
    ELEMENT(compression_onset_length, "1", "L_r2, L_ce0");
    ELEMENT(specific_tension, "N/m2", "force per cross-sectional area");
    ELEMENT(density, "kg/m3", "density of muscle");
    for (unsigned index = 0; index < VM_FMU_FIBERS; index++) add_fiber(index);
}

size_t variable_count(void) {
    fill();
    return count;
}

const Variable *variable(size_t reference) {
    fill();
    return reference >= 1 && reference <= count ? &table[reference - 1] : 0;
}

State unit_start(void) {
    State state;
    VmMuscleParams *params = &state.values.params;
    memset(&state, 0, sizeof state);
    memcpy(&state.token, "VM_FMU_1", sizeof state.token);
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

/* The variable, or a message. */
static const Variable *typed(size_t reference, int real, char *message) {
    const Variable *found = variable(reference);
    if (!found) {
        snprintf(message, MESSAGE, "no variable has the value reference %lu", (unsigned long)reference);
    } else if ((found->bytes == 8) != real) {
        snprintf(message, MESSAGE, "%s is %s", found->name, real ? "an integer" : "a real number");
        found = 0;
    }
    return found;
}

/* Parameters are set before the muscle is built, and outputs never. */
static int settable(const State *state, const Variable *found, char *message) {
    if (found->causality == INPUT || (found->causality == PARAMETER && state->phase < STEPPING)) return 1;
    snprintf(message, MESSAGE, "%s cannot be set %s", found->name,
             found->causality == OUTPUT ? "because it is an output" : "after initialization");
    return 0;
}

int unit_set_real(State *state, size_t reference, double value, char *message) {
    const Variable *found = typed(reference, 1, message);
    if (!found || !settable(state, found, message)) return 1;
    memcpy((char *)&state->values + found->offset, &value, sizeof value);
    return 0;
}

int unit_get_real(const State *state, size_t reference, double *value, char *message) {
    const Variable *found = typed(reference, 1, message);
    if (!found) return 1;
    memcpy(value, (const char *)&state->values + found->offset, sizeof *value);
    return 0;
}

int unit_set_integer(State *state, size_t reference, int32_t value, char *message) {
    const Variable *found = typed(reference, 0, message);
    if (!found || !settable(state, found, message)) return 1;
    if (found->bytes == 1) {
        const uint8_t byte = (uint8_t)value;
        if (value != byte) {
            snprintf(message, MESSAGE, "%s = %ld: must be between 0 and 255", found->name, (long)value);
            return 1;
        }
        memcpy((char *)&state->values + found->offset, &byte, 1);
    } else {
        memcpy((char *)&state->values + found->offset, &value, 4);
    }
    return 0;
}

int unit_get_integer(const State *state, size_t reference, int32_t *value, char *message) {
    const Variable *found = typed(reference, 0, message);
    uint8_t byte;
    if (!found) return 1;
    if (found->bytes == 1) {
        memcpy(&byte, (const char *)&state->values + found->offset, 1);
        *value = byte;
    } else {
        memcpy(value, (const char *)&state->values + found->offset, 4);
    }
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

static int32_t whole(double value) {
    return value >= 2147483647.0 ? 2147483647 : value <= -2147483647.0 ? -2147483647 : (int32_t)lround(value);
}

/* In fixed point, NaN becomes 0: integers have none. */
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

/* One tick on a path. */
static VmResult tick(State *state, double path) {
    Values *values = &state->values;
    const double activation = values->activation, frequency = values->stimulation_frequency_pps;
    VmResult result;
    if (values->arithmetic == ARITHMETIC_F32) {
        const VmInputF32 input = {(float)activation, (float)path, (float)frequency};
        VmOutputF32 output;
        result = vm_f32_step(&state->muscle.f32, &input, &output);
        if (!result) TAKE(output, output.force_n);
    } else if (values->arithmetic == ARITHMETIC_FIXED) {
        const VmInputFixed input = {whole(path * 1e6), part(activation * 1e3, 65535.0), part(frequency * 10.0, 65535.0)};
        VmOutputFixed output;
        result = vm_fixed_step(&state->muscle.fixed, &input, &output);
        if (!result) take_fixed(values, &output);
    } else {
        const VmInputF64 input = {activation, path, frequency};
        VmOutputF64 output;
        result = vm_f64_step(&state->muscle.f64, &input, &output);
        if (!result) TAKE(output, output.force_n);
    }
    return result;
}

int unit_step(State *state, double duration_s, char *message) {
    const Values *values = &state->values;
    const double step = values->time_step_s, ticks = round(duration_s / step);
    const double before = state->path_before_m, after = values->path_length_m;
    uint32_t flags = 0;
    if (state->phase != STEPPING) {
        snprintf(message, MESSAGE, "the unit is not initialized");
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
    state->path_before_m = after;
    return 0;
}

int unit_valid(const void *bytes, size_t size) {
    return size == sizeof(State) && memcmp(bytes, "VM_FMU_1", 8) == 0;
}
