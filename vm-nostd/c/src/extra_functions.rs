//! The functions of fatigue, recruitment curve and inverse: a template for every arithmetic.

macro_rules! extra_functions {
    (
        $S:ident, $prefix:literal, $Path:ident, $Number:ident, $Amount:ident, $Newtons:ident,
        $Word:ident, $MUSCLE_BASE:literal, $MUSCLE_PER_TYPE:literal, $UNITS_BASE:literal,
        $UNITS_PER_TYPE:literal, $STEADY_BASE:literal, $STEADY_PER_TYPE:literal,
        $FATIGUE_SIZE:literal, $CURVE_SIZE:literal, $JOINT_BASE:literal,
        $JOINT_PER_MUSCLE:literal, $JOINT_PER_MUSCLE_OF_TWO:literal, $PROSTHESIS_OWN:literal,
        $FES_OWN:literal, $STATE_WORDS:literal, $PROSTHESIS_WORDS:literal, $FES_WORDS:literal,
    ) => {
        // <functions>
        /// Bytes of memory of an inverse without fibre types, and of each type.
        pub const VM_STEADY_A_BASE: usize = $STEADY_BASE;
        /// Each type.
        pub const VM_STEADY_A_PER_TYPE: usize = $STEADY_PER_TYPE;
        /// Bytes of a VmSteadyA: two types.
        pub const VM_STEADY_A_SIZE: usize = VM_STEADY_A_BASE + 2 * VM_STEADY_A_PER_TYPE;
        /// Bytes of a VmFatigueA.
        pub const VM_FATIGUE_A_SIZE: usize = $FATIGUE_SIZE;
        /// Bytes of a VmCurveA.
        pub const VM_CURVE_A_SIZE: usize = $CURVE_SIZE;

        /// Memory in C.
        #[repr(C, align(8))]
        pub struct VmSteadyA([u64; VM_STEADY_A_SIZE / 8]);
        /// Memory in C.
        #[repr(C, align(8))]
        pub struct VmFatigueA([u64; VM_FATIGUE_A_SIZE / 8]);
        /// Memory in C.
        #[repr(C, align(8))]
        pub struct VmCurveA([u64; VM_CURVE_A_SIZE / 8]);

        /// Steady state under FES.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmSteadyOutputA {
            /// Tendon force, in the unit of force.
            pub force: $Newtons,
            /// Activation, 0..1.
            pub activation: $Number,
            /// Tendon force relative to F0.
            pub relative_force: $Number,
            /// Fascicle length, L_ce0.
            pub fascicle_length: $Number,
            /// VM_STATUS_ flags; VM_STATUS_FORCE_UNREACHABLE if no activation holds the force.
            pub status: u16,
        }

        /// Builds fatigue for a time step, rested. `size` is that of the memory.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fatigue_build"))]
        pub extern "C" fn vm_a_fatigue_build(
            fatigue: *mut VmFatigueA,
            size: usize,
            params: *const VmFatigueParams,
            time_step_s: f64,
            error: *mut VmError,
        ) -> VmResult {
            told(extras::build_fatigue::<$S, _>(fatigue, size, params, time_step_s, error), error)
        }

        /// Advances fatigue by the activation and stimulation frequency of a tick (100 pps for
        /// natural recruitment). Gives the fitness, 0..1.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fatigue_advance"))]
        pub extern "C" fn vm_a_fatigue_advance(
            fatigue: *mut VmFatigueA,
            input: *const VmInputA,
            fitness: *mut $Number,
        ) -> VmResult {
            plain(extras::advance_fatigue::<$S, _, _>(fatigue, input, fitness))
        }

        /// Multiplies the forces of an output by a fitness, 0..1. VM_RESULT_PARAMETER for any other
        /// number.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fatigued"))]
        pub extern "C" fn vm_a_fatigued(output: *mut VmOutputA, fitness: $Number) -> VmResult {
            let outcome = || {
                let mut output_now = read(output)?;
                let fitness = <$S as Arithmetic>::number_from(fitness);
                let shares = <$S as model::Scalar>::ZERO..=<$S as model::Scalar>::ONE;
                if !shares.contains(&fitness) {
                    return Err(VmResult::Parameter);
                }
                output_now.tire(fitness);
                Place::new(output)?.put(output_now);
                Ok(())
            };
            plain(outcome())
        }

        /// Saves fatigue: 3 words, or 4 in fixed point, with a fingerprint of parameters and time
        /// step.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fatigue_save"))]
        pub extern "C" fn vm_a_fatigue_save(
            fatigue: *const VmFatigueA,
            words: *mut $Word,
            count: usize,
        ) -> VmResult {
            plain(extras::save_fatigue::<$S, _>(fatigue, words, count))
        }

        /// Restores fatigue, with the results of a muscle's restore.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fatigue_restore"))]
        pub extern "C" fn vm_a_fatigue_restore(
            fatigue: *mut VmFatigueA,
            words: *const $Word,
            count: usize,
        ) -> VmResult {
            plain(extras::restore_fatigue::<$S, _>(fatigue, words, count))
        }

        /// Builds a recruitment curve. `size` is that of the memory.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "curve_build"))]
        pub extern "C" fn vm_a_curve_build(
            curve: *mut VmCurveA,
            size: usize,
            params: *const VmCurveParams,
            error: *mut VmError,
        ) -> VmResult {
            told(extras::build_curve::<$S, _>(curve, size, params, error), error)
        }

        /// Activation (0..1) that a pulse of amplitude (mA) and width (us) recruits, and VM_PULSE_
        /// flags.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "curve_activation"))]
        pub extern "C" fn vm_a_curve_activation(
            curve: *const VmCurveA,
            amplitude_ma: $Amount,
            width_us: $Amount,
            activation: *mut $Number,
            status: *mut u16,
        ) -> VmResult {
            plain(extras::on_curve::<$S, _, _>(curve, activation, status, |curve| {
                let (activation, status) = curve.activation(<$S>::pulse(amplitude_ma, width_us));
                (activation.number(), status)
            }))
        }

        /// Amplitude (mA) with which a pulse of a width (us) recruits an activation.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "curve_amplitude_for"))]
        pub extern "C" fn vm_a_curve_amplitude_for(
            curve: *const VmCurveA,
            activation: $Number,
            width_us: $Amount,
            amplitude_ma: *mut $Amount,
            status: *mut u16,
        ) -> VmResult {
            plain(extras::on_curve::<$S, _, _>(curve, amplitude_ma, status, |curve| {
                let width = <$S>::amount_from(width_us);
                let (amplitude, status) = curve.amplitude_for(<$S>::number_from(activation), width);
                (<$S>::amount(amplitude), status)
            }))
        }

        /// Width (us) with which a pulse of an amplitude (mA) recruits an activation.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "curve_width_for"))]
        pub extern "C" fn vm_a_curve_width_for(
            curve: *const VmCurveA,
            activation: $Number,
            amplitude_ma: $Amount,
            width_us: *mut $Amount,
            status: *mut u16,
        ) -> VmResult {
            plain(extras::on_curve::<$S, _, _>(curve, width_us, status, |curve| {
                let amplitude = <$S>::amount_from(amplitude_ma);
                let (width, status) = curve.width_for(<$S>::number_from(activation), amplitude);
                (<$S>::amount(width), status)
            }))
        }

        /// Checksum of a curve's coefficients.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "curve_checksum"))]
        pub extern "C" fn vm_a_curve_checksum(
            curve: *const VmCurveA,
            checksum: *mut u32,
        ) -> VmResult {
            plain(extras::curve_checksum::<$S, _>(curve, checksum))
        }

        /// Builds the steady state of FES, for the inverse. `size` is that of the memory.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "steady_build"))]
        pub extern "C" fn vm_a_steady_build(
            steady: *mut VmSteadyA,
            size: usize,
            params: *const VmMuscleParams,
            error: *mut VmError,
        ) -> VmResult {
            told(extras::build_steady::<$S, _>(steady, size, params, error), error)
        }

        /// Steady force of an input.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "steady_force"))]
        pub extern "C" fn vm_a_steady_force(
            steady: *const VmSteadyA,
            input: *const VmInputA,
            output: *mut VmSteadyOutputA,
        ) -> VmResult {
            let outcome = || {
                let place = Place::new(output)?;
                let question = Question::Force(read(input)?.input());
                place.put(extras::ask_steady::<$S, _>(steady, question)?.into());
                Ok(())
            };
            plain(outcome())
        }

        /// Activation that holds a force at the path and stimulation frequency of an input, whose
        /// activation is not used. The nearest one, flagged, if none does.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "steady_activation_for"))]
        pub extern "C" fn vm_a_steady_activation_for(
            steady: *const VmSteadyA,
            force: $Newtons,
            input: *const VmInputA,
            output: *mut VmSteadyOutputA,
        ) -> VmResult {
            let outcome = || {
                let place = Place::new(output)?;
                let input = InputOf::<$S>::input(read(input)?);
                let force = <$S as Arithmetic>::newtons_from(force);
                let question =
                    Question::Activation(force, input.path_length, input.stimulation_frequency);
                place.put(extras::ask_steady::<$S, _>(steady, question)?.into());
                Ok(())
            };
            plain(outcome())
        }
        // </functions>

        impl From<model::Steady<$S>> for VmSteadyOutputA {
            fn from(steady: model::Steady<$S>) -> Self {
                Self {
                    force: <$S as Arithmetic>::newtons(steady.force),
                    activation: steady.activation.number(),
                    relative_force: steady.relative_force.number(),
                    fascicle_length: steady.fascicle_length.number(),
                    status: steady.status.bits(),
                }
            }
        }

        const _: () = {
            use $crate::slot::{bytes, fits};
            macro_rules! each {
                ($N:literal) => {
                    fits(
                        bytes::<model::SteadyFes<$S, $N>>(),
                        VM_STEADY_A_BASE + $N * VM_STEADY_A_PER_TYPE,
                        1,
                    );
                };
            }
            $crate::kinds::each_number_of_types!(each);
            fits(size_of::<extras::FatigueSlot<$S>>(), size_of::<VmFatigueA>(), 1);
            fits(size_of::<extras::CurveSlot<$S>>(), size_of::<VmCurveA>(), 1);
        };
    };
}
pub(crate) use extra_functions;
