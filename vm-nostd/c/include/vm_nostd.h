/**
 * @file
 * Virtual Muscle 4.0 for firmware: a model of human muscle, by fibre type, stepped once per tick.
 *
 * Nothing here allocates, blocks or keeps a pointer. Every function checks its pointers, and says what it
 * refuses; none of them can fail in a way that is not in its VmResult. A muscle is plain data of a known size: a
 * static or a local variable, which may be copied. It is used by one thread or interrupt at a time.
 *
 * @code
 * static VmMuscleF32 muscle;
 * VmMuscleParams params = {...};
 * VmError error;
 * vm_params_paper(&params.elements, &params.fibers[0], &params.fibers[1]);
 * if (vm_f32_build(&muscle, sizeof muscle, &params, VM_MODE_FES, 1e-3, &error) != VM_RESULT_OK) {
 *     // error.field, error.value, error.least, error.most
 * }
 * vm_f32_rest(&muscle, 0.16f);
 * // Every millisecond:
 * VmInputF32 input = { .activation = 0.5f, .path_length_m = 0.16f, .stimulation_frequency_pps = 25.0f };
 * VmOutputF32 output;
 * vm_f32_step(&muscle, &input, &output);
 * @endcode
 *
 * Written by cbindgen from vm-nostd/c/src; see there for the model itself.
 */

#pragma once

#include <stddef.h>
#include <stdint.h>
/** A muscle computed in float. Opaque: only vm_f32_ functions look inside. */
typedef struct VmMuscleF32 VmMuscleF32;
/** A muscle computed in fixed point. Opaque: only vm_fixed_ functions look inside. */
typedef struct VmMuscleFixed VmMuscleFixed;


/**
 * Bytes of a VmMuscleF32.
 */
#define VM_MUSCLE_F32_SIZE 568

/**
 * Words of its saved state.
 */
#define VM_F32_STATE_WORDS 15

/**
 * Bytes of a VmMuscleFixed.
 */
#define VM_MUSCLE_FIXED_SIZE 680

/**
 * Words of its saved state.
 */
#define VM_FIXED_STATE_WORDS 24

/**
 * Bytes of VmError's field, its final 0 included.
 */
#define VM_FIELD_SIZE 96

/**
 * Fibre types of each muscle.
 */
#define VM_FIBERS 2

/**
 * Activation was outside 0..1 and was clipped.
 */
#define VM_STATUS_ACTIVATION_CLIPPED 1

/**
 * Activation was not a number (taken as 0) or infinite (clipped).
 */
#define VM_STATUS_ACTIVATION_NOT_FINITE 2

/**
 * Stimulation frequency was outside 0..500 pps and was clipped.
 */
#define VM_STATUS_FREQUENCY_CLIPPED 4

/**
 * Stimulation frequency was not a number (taken as 0) or infinite (clipped).
 */
#define VM_STATUS_FREQUENCY_NOT_FINITE 8

/**
 * Path length was outside the muscle's range and was clipped.
 */
#define VM_STATUS_PATH_LENGTH_CLIPPED 16

/**
 * Path length was not a number (the one before was kept) or infinite (clipped).
 */
#define VM_STATUS_PATH_LENGTH_NOT_FINITE 32

/**
 * Fascicles were where the filaments' equations do not hold; these were taken at the edge of their range.
 */
#define VM_STATUS_FASCICLE_OUTSIDE_DOMAIN 64

/**
 * The fascicles were stopped at the least or greatest length the state can have.
 */
#define VM_STATUS_FASCICLE_LENGTH_LIMITED 128

/**
 * The fascicles were held at the greatest speed the state can have.
 */
#define VM_STATUS_FASCICLE_VELOCITY_LIMITED 256

/**
 * Forces were far out of balance, as when a path jumps: the force is less accurate.
 */
#define VM_STATUS_MECHANICS_UNSETTLED 512

/**
 * The tendon's force was taken at the most that fixed point can tell.
 */
#define VM_STATUS_TENDON_FORCE_LIMITED 1024

/**
 * What a function answers; VM_RESULT_OK is 0, and everything else has changed nothing.
 */
typedef enum {
  /**
   * It was done.
   */
  VM_RESULT_OK = 0,
  /**
   * A pointer is null.
   */
  VM_RESULT_NULL_POINTER = 1,
  /**
   * The muscle has another size than in this library: header and library are of different versions.
   */
  VM_RESULT_SIZE = 2,
  /**
   * The muscle was not built, or something has written over it.
   */
  VM_RESULT_NOT_BUILT = 3,
  /**
   * A parameter is out of its range; which one is in VmError.
   */
  VM_RESULT_PARAMETER = 4,
  /**
   * These words are no state of this muscle.
   */
  VM_RESULT_STATE = 5,
  /**
   * These words were saved by another muscle, or for another mode or time step.
   */
  VM_RESULT_OTHER_MUSCLE = 6,
} VmResult;

/**
 * How a muscle is recruited.
 */
typedef enum {
  /**
   * Naturally, continuous.
   */
  VM_MODE_CONTINUOUS = 0,
  /**
   * By intramuscular FES.
   */
  VM_MODE_FES = 1,
} VmMode;

/**
 * What fibre types share.
 */
typedef struct {
  /**
   * c_T.
   */
  double tendon_stiffness;
  /**
   * k_T.
   */
  double tendon_toe;
  /**
   * L_r_T, L_se0.
   */
  double tendon_slack_length;
  /**
   * c_1.
   */
  double parallel_stiffness;
  /**
   * k_1.
   */
  double parallel_toe;
  /**
   * L_r1, L_max.
   */
  double parallel_slack_length;
  /**
   * eta, F0 s/L_ce0.
   */
  double parallel_viscosity;
  /**
   * c_2.
   */
  double compression_strength;
  /**
   * k_2.
   */
  double compression_steepness;
  /**
   * L_r2, L_ce0.
   */
  double compression_onset_length;
  /**
   * Force per cross-sectional area, N/m^2.
   */
  double specific_tension;
  /**
   * Density of muscle, kg/m^3.
   */
  double density;
} VmElements;

/**
 * A fibre type and its share of a muscle.
 */
typedef struct {
  /**
   * Share of the cross-sectional area; 0.001 to 1.
   */
  double fraction;
  /**
   * Order of recruitment: super-slow 1, slow 2, fast 3; 1 to 255.
   */
  uint8_t rank;
  /**
   * Whether it sags: 0 or 1.
   */
  uint8_t has_sag;
  /**
   * Whether it yields: 0 or 1.
   */
  uint8_t has_yield;
  /**
   * f_0.5, pps.
   */
  double half_force_frequency;
  /**
   * f_min, f_0.5.
   */
  double minimum_frequency;
  /**
   * f_max, f_0.5.
   */
  double maximum_frequency;
  /**
   * omega of FL.
   */
  double force_length_width;
  /**
   * beta of FL.
   */
  double force_length_skewness;
  /**
   * rho of FL.
   */
  double force_length_roundness;
  /**
   * V_max, L_ce0/s, negative.
   */
  double maximum_velocity;
  /**
   * c_V0, c_V1 of FV.
   */
  double shortening[2];
  /**
   * a_V0, a_V1, a_V2 of FV.
   */
  double lengthening[3];
  /**
   * b_V of FV.
   */
  double lengthening_velocity;
  /**
   * a_f of Af.
   */
  double activation_scale;
  /**
   * n_f0 of Af.
   */
  double activation_exponent;
  /**
   * n_f1 of Af.
   */
  double activation_length_dependence;
  /**
   * T_f1, s.
   */
  double rise_s;
  /**
   * T_f2, s.
   */
  double rise_per_frequency_s;
  /**
   * T_f3, s.
   */
  double fall_s;
  /**
   * T_f4, s.
   */
  double fall_per_activation_s;
  /**
   * a_S1, if it sags.
   */
  double sag_resting_level;
  /**
   * a_S2, if it sags.
   */
  double sag_firing_level;
  /**
   * T_S, s, if it sags.
   */
  double sag_time_s;
  /**
   * c_Y, if it yields.
   */
  double yield_depth;
  /**
   * V_Y, L_ce0/s, if it yields.
   */
  double yield_velocity;
  /**
   * T_Y, s, if it yields.
   */
  double yield_time_s;
} VmFiber;

/**
 * A muscle of two fibre types.
 */
typedef struct {
  /**
   * Mass, kg; 1e-5 to 30.
   */
  double mass_kg;
  /**
   * Optimal fascicle length L_ce0, m; 0.005 to 1.
   */
  double fascicle_length_m;
  /**
   * Optimal tendon length L_se0, m; 0.0005 to 2.
   */
  double tendon_length_m;
  /**
   * Longest musculotendon path L_mt_max, m: it scales the parallel elastic element, and paths may be longer.
   */
  double max_path_length_m;
  /**
   * Activation U_r at which all fibres are recruited in the natural mode; 0.01 to 1.
   */
  double recruitment_saturation;
  /**
   * What the fibre types share.
   */
  VmElements elements;
  /**
   * Fibre types in order of rank; their fractions add to 1.
   */
  VmFiber fibers[VM_FIBERS];
} VmMuscleParams;

/**
 * A parameter that was refused.
 */
typedef struct {
  /**
   * Its name, as in VmMuscleParams, ended by 0; what follows a colon is what was derived from it and refused.
   */
  char field[VM_FIELD_SIZE];
  /**
   * Index of the fibre type that it belongs to; -1 where it is the muscle's own.
   */
  int32_t fiber;
  /**
   * The refused value, in the field's unit.
   */
  double value;
  /**
   * The least that is taken, in the field's unit.
   */
  double least;
  /**
   * The most that is taken, in the field's unit.
   */
  double most;
} VmError;

/**
 * Inputs of a tick.
 */
typedef struct {
  /**
   * Activation U, or strength of the stimulus (FES); 0..1.
   */
  float activation;
  /**
   * Path length at the tick's end, m.
   */
  float path_length_m;
  /**
   * Stimulation frequency, pps; 0..500 (FES only).
   */
  float stimulation_frequency_pps;
} VmInputF32;

/**
 * What a tick yields.
 */
typedef struct {
  /**
   * Tendon force, N; never negative.
   */
  float force_n;
  /**
   * Fascicle length, L_ce0.
   */
  float fascicle_length;
  /**
   * Fascicle velocity, L_ce0/s, positive when lengthening.
   */
  float fascicle_velocity;
  /**
   * Tendon force relative to F0.
   */
  float relative_force;
  /**
   * What had to be saturated: VM_STATUS_ flags; 0 where nothing had to be.
   */
  uint16_t status;
} VmOutputF32;

/**
 * A state that was saved.
 */
typedef struct {
  /**
   * As they come, for storage.
   */
  uint32_t words[VM_F32_STATE_WORDS];
} VmStateF32;

/**
 * Inputs of a tick.
 */
typedef struct {
  /**
   * Path length at the tick's end, um.
   */
  int32_t path_length_um;
  /**
   * Activation U, or strength of the stimulus (FES), thousandths; 0..1000.
   */
  uint16_t activation_per_mille;
  /**
   * Stimulation frequency, tenths of a pps; 0..5000 (FES only).
   */
  uint16_t stimulation_tenths_pps;
} VmInputFixed;

/**
 * What a tick yields.
 */
typedef struct {
  /**
   * Tendon force, mN; never negative.
   */
  int32_t force_mn;
  /**
   * Fascicle length, 2^-24 L_ce0.
   */
  int32_t fascicle_length;
  /**
   * Fascicle velocity, 2^-24 L_ce0/s, positive when lengthening.
   */
  int32_t fascicle_velocity;
  /**
   * Tendon force relative to F0, 2^-24 F0: finer than mN where F0 is below 16,777 N.
   */
  int32_t relative_force;
  /**
   * What had to be saturated: VM_STATUS_ flags; 0 where nothing had to be.
   */
  uint16_t status;
} VmOutputFixed;

/**
 * A state that was saved.
 */
typedef struct {
  /**
   * As they come, for storage.
   */
  uint32_t words[VM_FIXED_STATE_WORDS];
} VmStateFixed;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Builds a muscle for a time step (s; 1e-4 to 2e-3), at rest in the middle of its path. `size` is
 * `sizeof(*muscle)`. VM_RESULT_PARAMETER: which one, and its limits, are in `error`, which may be null.
 */
VmResult vm_f32_build(VmMuscleF32 *muscle,
                      size_t size,
                      const VmMuscleParams *params,
                      uint32_t mode,
                      double time_step_s,
                      VmError *error);

/**
 * Puts a muscle at rest on a path; VM_RESULT_PARAMETER, and no change, where it cannot be.
 */
VmResult vm_f32_rest(VmMuscleF32 *muscle, float path_length_m);

/**
 * Steps a muscle by one tick. Inputs out of their ranges are clipped, and said to be in `output->status`.
 */
VmResult vm_f32_step(VmMuscleF32 *muscle,
                     const VmInputF32 *input,
                     VmOutputF32 *output);

/**
 * Saves a muscle's state, and which muscle, mode and time step it is of.
 */
VmResult vm_f32_save(const VmMuscleF32 *muscle, VmStateF32 *saved);

/**
 * Restores a state that was saved; VM_RESULT_OTHER_MUSCLE if by another muscle, mode or time step, VM_RESULT_STATE
 * if this muscle cannot be in it, and then no change.
 */
VmResult vm_f32_restore(VmMuscleF32 *muscle,
                        const VmStateF32 *saved);

/**
 * Checksums of a muscle's coefficients, which never change, and of its state, which changes with every tick:
 * firmware that compares them sees memory that has lost a bit.
 */
VmResult vm_f32_checksums(const VmMuscleF32 *muscle,
                          uint32_t *coefficients,
                          uint32_t *state);

/**
 * Builds a muscle for a time step (s; 1e-4 to 2e-3), at rest in the middle of its path. `size` is
 * `sizeof(*muscle)`. VM_RESULT_PARAMETER: which one, and its limits, are in `error`, which may be null.
 */
VmResult vm_fixed_build(VmMuscleFixed *muscle,
                        size_t size,
                        const VmMuscleParams *params,
                        uint32_t mode,
                        double time_step_s,
                        VmError *error);

/**
 * Puts a muscle at rest on a path; VM_RESULT_PARAMETER, and no change, where it cannot be.
 */
VmResult vm_fixed_rest(VmMuscleFixed *muscle, int32_t path_length_um);

/**
 * Steps a muscle by one tick. Inputs out of their ranges are clipped, and said to be in `output->status`.
 */
VmResult vm_fixed_step(VmMuscleFixed *muscle,
                       const VmInputFixed *input,
                       VmOutputFixed *output);

/**
 * Saves a muscle's state, and which muscle, mode and time step it is of.
 */
VmResult vm_fixed_save(const VmMuscleFixed *muscle, VmStateFixed *saved);

/**
 * Restores a state that was saved; VM_RESULT_OTHER_MUSCLE if by another muscle, mode or time step, VM_RESULT_STATE
 * if this muscle cannot be in it, and then no change.
 */
VmResult vm_fixed_restore(VmMuscleFixed *muscle,
                          const VmStateFixed *saved);

/**
 * Checksums of a muscle's coefficients, which never change, and of its state, which changes with every tick:
 * firmware that compares them sees memory that has lost a bit.
 */
VmResult vm_fixed_checksums(const VmMuscleFixed *muscle,
                            uint32_t *coefficients,
                            uint32_t *state);

/**
 * Elements, a slow and a fast fibre type of the paper's table 1 (Song et al. 2008); fractions are one half each.
 * A null pointer is passed over.
 */
void vm_params_paper(VmElements *elements,
                     VmFiber *slow,
                     VmFiber *fast);

/**
 * Elements, a slow and a fast fibre type of man, as Virtual Muscle 4.0 has them; fractions are one half each.
 * A null pointer is passed over.
 */
void vm_params_human(VmElements *elements,
                     VmFiber *slow,
                     VmFiber *fast);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

struct VmMuscleF32 {
  /** Not to be touched. */
  uint64_t opaque[VM_MUSCLE_F32_SIZE / 8];
};

struct VmMuscleFixed {
  /** Not to be touched. */
  uint64_t opaque[VM_MUSCLE_FIXED_SIZE / 8];
};

#ifdef __cplusplus
static_assert(sizeof(VmMuscleF32) == VM_MUSCLE_F32_SIZE, "VmMuscleF32 has another size than the library's");
static_assert(sizeof(VmMuscleFixed) == VM_MUSCLE_FIXED_SIZE, "VmMuscleFixed has another size than the library's");
#else
_Static_assert(sizeof(VmMuscleF32) == VM_MUSCLE_F32_SIZE, "VmMuscleF32 has another size than the library's");
_Static_assert(sizeof(VmMuscleFixed) == VM_MUSCLE_FIXED_SIZE, "VmMuscleFixed has another size than the library's");
#endif
