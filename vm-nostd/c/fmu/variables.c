/* The variables of the unit: names, units, and where their values are. Constant, so that instances in several threads
   share it. */

#include "muscle.h"

#include <stdio.h>
#include <string.h>

#define AT(field) offsetof(Values, field)
#define REAL(field, unit, description) {#field, unit, description, PARAMETER, AT(params.field), 8},
#define WHOLE(field, description) {#field, 0, description, PARAMETER, AT(params.field), 4},
#define ELEMENT(field, unit, description) {#field, unit, description, PARAMETER, AT(params.elements.field), 8},
#define FIBER(i, name, member, unit, description, bytes)                                                               \
    {"fibers[" #i "]." #name, unit, description, PARAMETER,                                                            \
     AT(params.fibers) + i * sizeof(VmFiber) + offsetof(VmFiber, member), bytes},
#define FIBERS(i)                                                                                                      \
    FIBER(i, fraction, fraction, "1", "share of the cross-sectional area; all add to 1", 8)                            \
    FIBER(i, rank, rank, 0, "order of recruitment", 1)                                                                 \
    FIBER(i, has_sag, has_sag, 0, "1 if the type has sag", 1)                                                          \
    FIBER(i, has_yield, has_yield, 0, "1 if the type has yield", 1)                                                    \
    FIBER(i, half_force_frequency, half_force_frequency, "Hz", "f_0.5", 8)                                             \
    FIBER(i, minimum_frequency, minimum_frequency, "1", "f_min, f_0.5", 8)                                             \
    FIBER(i, maximum_frequency, maximum_frequency, "1", "f_max, f_0.5", 8)                                             \
    FIBER(i, force_length_width, force_length_width, "1", "omega of FL", 8)                                            \
    FIBER(i, force_length_skewness, force_length_skewness, "1", "beta of FL", 8)                                       \
    FIBER(i, force_length_roundness, force_length_roundness, "1", "rho of FL", 8)                                      \
    FIBER(i, maximum_velocity, maximum_velocity, "1/s", "V_max, L_ce0/s, negative", 8)                                 \
    FIBER(i, shortening_0, shortening, "1", "c_V0 of FV", 8)                                                           \
    FIBER(i, shortening_1, shortening[1], "1", "c_V1 of FV", 8)                                                        \
    FIBER(i, lengthening_0, lengthening, "1", "a_V0 of FV", 8)                                                         \
    FIBER(i, lengthening_1, lengthening[1], "1", "a_V1 of FV", 8)                                                      \
    FIBER(i, lengthening_2, lengthening[2], "1", "a_V2 of FV", 8)                                                      \
    FIBER(i, lengthening_velocity, lengthening_velocity, "1/s", "b_V of FV, L_ce0/s", 8)                               \
    FIBER(i, activation_scale, activation_scale, "1", "a_f of Af", 8)                                                  \
    FIBER(i, activation_exponent, activation_exponent, "1", "n_f0 of Af", 8)                                           \
    FIBER(i, activation_length_dependence, activation_length_dependence, "1", "n_f1 of Af", 8)                         \
    FIBER(i, rise_s, rise_s, "s", "T_f1", 8)                                                                           \
    FIBER(i, rise_per_frequency_s, rise_per_frequency_s, "s", "T_f2", 8)                                               \
    FIBER(i, fall_s, fall_s, "s", "T_f3", 8)                                                                           \
    FIBER(i, fall_per_activation_s, fall_per_activation_s, "s", "T_f4", 8)                                             \
    FIBER(i, effective_length_time_s, effective_length_time_s, "s", "T_L; not used by the modes of this unit", 8)      \
    FIBER(i, sag_resting_level, sag_resting_level, "1", "a_S1, if it sags", 8)                                         \
    FIBER(i, sag_firing_level, sag_firing_level, "1", "a_S2, if it sags", 8)                                           \
    FIBER(i, sag_time_s, sag_time_s, "s", "T_S, if it sags", 8)                                                        \
    FIBER(i, yield_depth, yield_depth, "1", "c_Y, if it yields", 8)                                                    \
    FIBER(i, yield_velocity, yield_velocity, "1/s", "V_Y, L_ce0/s, if it yields", 8)                                   \
    FIBER(i, yield_time_s, yield_time_s, "s", "T_Y, if it yields", 8)                                                 

static const Variable table[] = {
    {"activation", "1", "U, or strength of the stimulus (FES); 0..1", INPUT, AT(activation), 8},
    {"path_length_m", "m", "musculotendon path at the end of the step", INPUT, AT(path_length_m), 8},
    {"stimulation_frequency_pps", "Hz", "pulses per second; FES only", INPUT, AT(stimulation_frequency_pps), 8},
    {"force_n", "N", "tendon force", OUTPUT, AT(force_n), 8},
    {"fascicle_length", "1", "L_ce0", OUTPUT, AT(fascicle_length), 8},
    {"fascicle_velocity", "1/s", "L_ce0/s, positive when lengthening", OUTPUT, AT(fascicle_velocity), 8},
    {"relative_force", "1", "tendon force over F0", OUTPUT, AT(relative_force), 8},
    {"max_isometric_force_n", "N", "F0", OUTPUT, AT(max_isometric_force_n), 8},
    {"status", 0, "VM_STATUS_ flags of the step; 0 if nothing was clipped", OUTPUT, AT(status), 4},
    {"mode", 0, "0 natural continuous recruitment, 1 intramuscular FES", PARAMETER, AT(mode), 4},
    {"arithmetic", 0, "0 f32, 1 fixed point, 2 f64", PARAMETER, AT(arithmetic), 4},
    {"time_step_s", "s", "tick of the model; steps are whole multiples of it", PARAMETER, AT(time_step_s), 8},
    WHOLE(accuracy_class, "0 standard, 1 economy, 2 fine")
    WHOLE(fiber_count, "number of fibre types")
    REAL(mass_kg, "kg", "muscle mass")
    REAL(fascicle_length_m, "m", "optimal fascicle length L_ce0")
    REAL(tendon_length_m, "m", "optimal tendon length L_se0")
    REAL(max_path_length_m, "m", "longest path L_mt_max")
    REAL(recruitment_saturation, "1", "U_r")
    ELEMENT(tendon_stiffness, "1", "c_T")
    ELEMENT(tendon_toe, "1", "k_T")
    ELEMENT(tendon_slack_length, "1", "L_r_T, L_se0")
    ELEMENT(parallel_stiffness, "1", "c_1")
    ELEMENT(parallel_toe, "1", "k_1")
    ELEMENT(parallel_slack_length, "1", "L_r1, L_max")
    ELEMENT(parallel_viscosity, "s", "eta, F0 s/L_ce0")
    ELEMENT(compression_strength, "1", "c_2")
    ELEMENT(compression_steepness, "1", "k_2")
    ELEMENT(compression_onset_length, "1", "L_r2, L_ce0")
    ELEMENT(specific_tension, "N/m2", "force per cross-sectional area")
    ELEMENT(density, "kg/m3", "density of muscle")
    FIBERS(0)
#if VM_FMU_FIBERS > 1
    FIBERS(1)
#endif
#if VM_FMU_FIBERS > 2
    FIBERS(2)
#endif
#if VM_FMU_FIBERS > 3
    FIBERS(3)
#endif
#if VM_FMU_FIBERS > 4
    FIBERS(4)
#endif
#if VM_FMU_FIBERS > 5
    FIBERS(5)
#endif
};

size_t variable_count(void) { return sizeof table / sizeof table[0]; }

const Variable *variable(size_t reference) {
    return reference >= 1 && reference <= variable_count() ? &table[reference - 1] : 0;
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
    const int before = state->phase == INSTANTIATED || state->phase == INITIALIZATION;
    if (found->causality == INPUT || (found->causality == PARAMETER && before)) return 1;
    snprintf(message, MESSAGE, "%s cannot be set %s", found->name,
             found->causality == OUTPUT ? "because it is an output" : "after initialization");
    return 0;
}

/* Where a value is read: during initialization, outputs are those of the muscle that would be built now. */
static const Values *readable(const State *state, const Variable *found, State *trial, char *message) {
    if (found->causality != OUTPUT || state->phase == STEPPING || state->phase == TERMINATED) return &state->values;
    if (state->phase == INITIALIZATION) {
        *trial = *state;
        return unit_initialize(trial, message) ? 0 : &trial->values;
    }
    snprintf(message, MESSAGE, "%s is not known before initialization", found->name);
    return 0;
}

static int given(const void *references, const void *values, size_t n, char *message) {
    if (n == 0 || (references && values)) return 1;
    snprintf(message, MESSAGE, "references or values are a null pointer");
    return 0;
}

int unit_set_reals(State *state, const uint32_t *references, size_t n, const double *values, char *message) {
    if (!given(references, values, n, message)) return 1;
    for (size_t i = 0; i < n; i++) {
        const Variable *found = typed(references[i], 1, message);
        if (!found || !settable(state, found, message)) return 1;
        memcpy((char *)&state->values + found->offset, &values[i], sizeof values[i]);
    }
    return 0;
}

int unit_get_reals(const State *state, const uint32_t *references, size_t n, double *values, char *message) {
    State trial;
    if (!given(references, values, n, message)) return 1;
    for (size_t i = 0; i < n; i++) {
        const Variable *found = typed(references[i], 1, message);
        const Values *from = found ? readable(state, found, &trial, message) : 0;
        if (!from) return 1;
        memcpy(&values[i], (const char *)from + found->offset, sizeof values[i]);
    }
    return 0;
}

int unit_set_integers(State *state, const uint32_t *references, size_t n, const int32_t *values, char *message) {
    if (!given(references, values, n, message)) return 1;
    for (size_t i = 0; i < n; i++) {
        const Variable *found = typed(references[i], 0, message);
        const int32_t most = found && found->bytes == 1 ? 255 : INT32_MAX;
        const uint8_t byte = (uint8_t)values[i];
        if (!found || !settable(state, found, message)) return 1;
        if (values[i] < 0 || values[i] > most) {
            snprintf(message, MESSAGE, "%s = %ld: must be between 0 and %ld", found->name, (long)values[i], (long)most);
            return 1;
        }
        memcpy((char *)&state->values + found->offset, found->bytes == 1 ? (const void *)&byte : &values[i],
               found->bytes);
    }
    return 0;
}

int unit_get_integers(const State *state, const uint32_t *references, size_t n, int32_t *values, char *message) {
    State trial;
    if (!given(references, values, n, message)) return 1;
    for (size_t i = 0; i < n; i++) {
        const Variable *found = typed(references[i], 0, message);
        const Values *from = found ? readable(state, found, &trial, message) : 0;
        uint8_t byte;
        if (!from) return 1;
        if (found->bytes == 1) {
            memcpy(&byte, (const char *)from + found->offset, 1);
            values[i] = byte;
        } else {
            memcpy(&values[i], (const char *)from + found->offset, 4);
        }
    }
    return 0;
}
