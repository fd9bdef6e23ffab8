//! The functions of a muscle: a template for every arithmetic ([`template`](crate::template)).

macro_rules! functions {
    (
        $S:ident, $prefix:literal, $Path:ident, $Number:ident, $Amount:ident, $Newtons:ident,
        $Word:ident, $MUSCLE_BASE:literal, $MUSCLE_PER_TYPE:literal, $UNITS_BASE:literal,
        $UNITS_PER_TYPE:literal, $STEADY_BASE:literal, $STEADY_PER_TYPE:literal,
        $FATIGUE_SIZE:literal, $CURVE_SIZE:literal, $JOINT_BASE:literal,
        $JOINT_PER_MUSCLE:literal, $JOINT_PER_MUSCLE_OF_TWO:literal, $PROSTHESIS_OWN:literal,
        $FES_OWN:literal, $STATE_WORDS:literal, $PROSTHESIS_WORDS:literal, $FES_WORDS:literal,
    ) => {
        // <functions>
        /// Bytes of memory of a muscle without fibre types, and of each type.
        pub const VM_MUSCLE_A_BASE: usize = $MUSCLE_BASE;
        /// Each type.
        pub const VM_MUSCLE_A_PER_TYPE: usize = $MUSCLE_PER_TYPE;
        /// Bytes of memory of a muscle in a discrete mode without fibre types, and of each type.
        pub const VM_UNITS_A_BASE: usize = $UNITS_BASE;
        /// Each type.
        pub const VM_UNITS_A_PER_TYPE: usize = $UNITS_PER_TYPE;
        /// Bytes of a VmMuscleA: two types.
        pub const VM_MUSCLE_A_SIZE: usize = VM_MUSCLE_A_BASE + 2 * VM_MUSCLE_A_PER_TYPE;
        /// Words of the saved state of a muscle of two types in VM_MODE_CONTINUOUS or VM_MODE_FES.
        pub const VM_A_STATE_WORDS: usize = $STATE_WORDS;

        /// Memory in C.
        #[repr(C, align(8))]
        pub struct VmMuscleA([u64; VM_MUSCLE_A_SIZE / 8]);

        /// What a built muscle says of itself.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmInfoA {
            /// Maximal isometric force F0, in the unit of force.
            pub max_isometric_force: $Newtons,
            /// Shortest path, in the unit of path.
            pub shortest_path: $Path,
            /// Longest path.
            pub longest_path: $Path,
            /// Number of fibre types.
            pub fiber_count: u32,
            /// VmMode.
            pub mode: u32,
            /// Accuracy class.
            pub accuracy_class: u32,
            /// Words of a saved state.
            pub state_words: u32,
        }

        /// Curves of a fibre type.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmFiberCurvesA {
            /// FL, 0..1.
            pub force_length: $Number,
            /// FV, at least 0; 1 at a velocity of 0.
            pub force_velocity: $Number,
            /// Af, 0..1.
            pub activation_frequency: $Number,
        }

        /// Curves of the elements, F0.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmElementCurvesA {
            /// F_pe1 without viscosity.
            pub parallel: $Number,
            /// F_pe2 at full activation, at most 0.
            pub compression: $Number,
            /// F_se, at least 0.
            pub tendon: $Number,
        }

        /// Bytes of memory that a muscle of `fiber_count` types in a mode needs.
        /// VM_RESULT_PARAMETER if this library has none of that kind.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "size"))]
        pub extern "C" fn vm_a_size(fiber_count: u32, mode: u32, size: *mut usize) -> VmResult {
            plain(muscle::needed::<$S>(fiber_count, mode, size))
        }

        /// Builds a muscle for a time step (s; 1e-4 to 2e-3) in VM_MODE_CONTINUOUS or VM_MODE_FES.
        /// `size` is that of the memory. `error`, which may be null, has details of
        /// VM_RESULT_PARAMETER and VM_RESULT_SIZE. Rest or restore comes next. A muscle that was
        /// there is replaced.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "build"))]
        pub extern "C" fn vm_a_build(
            muscle: *mut VmMuscleA,
            size: usize,
            params: *const VmMuscleParams,
            mode: u32,
            time_step_s: f64,
            error: *mut VmError,
        ) -> VmResult {
            let order = Order { size, params, units: core::ptr::null(), mode, time_step_s, error };
            told(muscle::build::<$S, _>(muscle, &order), error)
        }

        /// The same in any mode; `units` are those of the discrete modes.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "build_units"))]
        pub extern "C" fn vm_a_build_units(
            muscle: *mut VmMuscleA,
            size: usize,
            params: *const VmMuscleParams,
            units: *const VmUnits,
            mode: u32,
            time_step_s: f64,
            error: *mut VmError,
        ) -> VmResult {
            let order = Order { size, params, units, mode, time_step_s, error };
            told(muscle::build::<$S, _>(muscle, &order), error)
        }

        /// Takes a muscle from the words of `vm emit`, with the bits of a built one; firmware that
        /// builds none is smaller. Number of types, mode, class and time step must be those of
        /// the words. VM_RESULT_WORDS if they are others, or if the words are damaged or of another
        /// version; `error`, which may be null, has details of that, VM_RESULT_PARAMETER and
        /// VM_RESULT_SIZE. Rest or restore comes next.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "from_words"))]
        pub extern "C" fn vm_a_from_words(
            muscle: *mut VmMuscleA,
            size: usize,
            words: *const u32,
            count: usize,
            fiber_count: u32,
            mode: u32,
            accuracy_class: u32,
            time_step_s: f64,
            error: *mut VmError,
        ) -> VmResult {
            let (types, class) = (fiber_count, accuracy_class);
            let emitted = Emitted { size, words, count, types, mode, class, time_step_s, error };
            told(muscle::from_words::<$S, _>(muscle, &emitted), error)
        }

        /// Puts a muscle at rest on a path. VM_RESULT_PARAMETER if the path is out of range; the
        /// muscle is unchanged.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "rest"))]
        pub extern "C" fn vm_a_rest(muscle: *mut VmMuscleA, path_length: $Path) -> VmResult {
            plain(muscle::rest::<$S, _>(muscle, path_length))
        }

        /// Steps a muscle by one tick. Inputs out of range are clipped and flagged in
        /// `output->status`. VM_RESULT_NOT_RESTED before the first rest or restore.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "step"))]
        pub extern "C" fn vm_a_step(
            muscle: *mut VmMuscleA,
            input: *const VmInputA,
            output: *mut VmOutputA,
        ) -> VmResult {
            plain(muscle::step::<$S, _, _, _>(muscle, input, output))
        }

        /// The state as an output, without a step; no flags.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "observe"))]
        pub extern "C" fn vm_a_observe(
            muscle: *const VmMuscleA,
            output: *mut VmOutputA,
        ) -> VmResult {
            plain(muscle::observe::<$S, _, _>(muscle, output))
        }

        /// F0, path range and kind of a muscle.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "info"))]
        pub extern "C" fn vm_a_info(muscle: *const VmMuscleA, info: *mut VmInfoA) -> VmResult {
            let outcome = || {
                let place = Place::new(info)?;
                let facts = muscle::facts::<$S, _>(muscle)?;
                place.put(VmInfoA {
                    max_isometric_force: facts.force,
                    shortest_path: facts.paths.0,
                    longest_path: facts.paths.1,
                    fiber_count: facts.types,
                    mode: facts.mode,
                    accuracy_class: facts.class,
                    state_words: facts.words,
                });
                Ok(())
            };
            plain(outcome())
        }

        /// Saves a muscle's state, with a fingerprint of muscle, mode and time step. VM_RESULT_SIZE
        /// if there is no room for its words: see state_words of info.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "save"))]
        pub extern "C" fn vm_a_save(
            muscle: *const VmMuscleA,
            words: *mut $Word,
            count: usize,
        ) -> VmResult {
            plain(muscle::save::<$S, _>(muscle, words, count))
        }

        /// Restores a saved state. VM_RESULT_OTHER_MUSCLE if it is of another muscle, mode or time
        /// step, VM_RESULT_STATE if it is out of range; the muscle is then unchanged.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "restore"))]
        pub extern "C" fn vm_a_restore(
            muscle: *mut VmMuscleA,
            words: *const $Word,
            count: usize,
        ) -> VmResult {
            plain(muscle::restore::<$S, _>(muscle, words, count))
        }

        /// Checksums of a muscle's coefficients, which never change, and of its state, which
        /// changes with every tick. Firmware compares them to detect a flipped bit.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "checksums"))]
        pub extern "C" fn vm_a_checksums(
            muscle: *const VmMuscleA,
            coefficients: *mut u32,
            state: *mut u32,
        ) -> VmResult {
            plain(muscle::checksums::<$S, _>(muscle, coefficients, state))
        }

        /// Curves of a fibre type (index from 0) as a tick computes them, at a fascicle length
        /// (L_ce0), a velocity (L_ce0/s) and a frequency (f_0.5). VM_RESULT_PARAMETER if there is
        /// no such type.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fiber_curves"))]
        pub extern "C" fn vm_a_fiber_curves(
            muscle: *const VmMuscleA,
            fiber: u32,
            fascicle_length: $Number,
            fascicle_velocity: $Number,
            frequency: $Number,
            curves: *mut VmFiberCurvesA,
        ) -> VmResult {
            let outcome = || {
                let place = Place::new(curves)?;
                let at = [fascicle_length, fascicle_velocity, frequency].map(<$S>::number_from);
                let [length, velocity, activation] = muscle::fiber_curves(muscle, fiber, at)?;
                place.put(VmFiberCurvesA {
                    force_length: length.number(),
                    force_velocity: velocity.number(),
                    activation_frequency: activation.number(),
                });
                Ok(())
            };
            plain(outcome())
        }

        /// Curves of the elements at a fascicle length (L_ce0) on a path, of which the tendon has
        /// the rest.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "element_curves"))]
        pub extern "C" fn vm_a_element_curves(
            muscle: *const VmMuscleA,
            fascicle_length: $Number,
            path_length: $Path,
            curves: *mut VmElementCurvesA,
        ) -> VmResult {
            let outcome = || {
                let place = Place::new(curves)?;
                let length = <$S>::number_from(fascicle_length);
                let path = <$S as Arithmetic>::path_from(path_length);
                let [parallel, compression, tendon] =
                    muscle::element_curves::<$S, _>(muscle, length, path)?;
                place.put(VmElementCurvesA {
                    parallel: parallel.number(),
                    compression: compression.number(),
                    tendon: tendon.number(),
                });
                Ok(())
            };
            plain(outcome())
        }
        // </functions>

        const _: () = {
            use model::{IntramuscularFes, NaturalContinuous, State};
            use $crate::kinds::Held;
            use $crate::slot::{bytes, fits};
            macro_rules! each {
                ($N:literal) => {
                    let muscle = VM_MUSCLE_A_BASE + $N * VM_MUSCLE_A_PER_TYPE;
                    fits(bytes::<Held<$S, NaturalContinuous, $N>>(), muscle, 1);
                    fits(bytes::<Held<$S, IntramuscularFes, $N>>(), muscle, 1);
                    #[cfg(feature = "units")]
                    assert!(
                        bytes::<Held<$S, $crate::kinds::Effective, $N>>()
                            <= VM_UNITS_A_BASE + $N * VM_UNITS_A_PER_TYPE
                    );
                };
            }
            $crate::kinds::each_number_of_types!(each);
            // Used with the feature `units` only.
            let _units = VM_UNITS_A_BASE + 2 * VM_UNITS_A_PER_TYPE;
            assert!(State::<$S, NaturalContinuous, 2>::SAVED_WORDS == VM_A_STATE_WORDS);
            assert!(State::<$S, IntramuscularFes, 2>::SAVED_WORDS == VM_A_STATE_WORDS);
        };
    };
}
pub(crate) use functions;
