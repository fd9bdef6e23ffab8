//! The functions of joints, prostheses and FES controllers: a template for every arithmetic.

macro_rules! control_functions {
    (
        $S:ident, $prefix:literal, $Path:ident, $Number:ident, $Amount:ident, $Newtons:ident,
        $Word:ident, $MUSCLE_BASE:literal, $MUSCLE_PER_TYPE:literal, $UNITS_BASE:literal,
        $UNITS_PER_TYPE:literal, $STEADY_BASE:literal, $STEADY_PER_TYPE:literal,
        $FATIGUE_SIZE:literal, $CURVE_SIZE:literal, $JOINT_BASE:literal,
        $JOINT_PER_MUSCLE:literal, $JOINT_PER_MUSCLE_OF_TWO:literal, $PROSTHESIS_OWN:literal,
        $FES_OWN:literal, $STATE_WORDS:literal, $PROSTHESIS_WORDS:literal, $FES_WORDS:literal,
    ) => {
        // <functions>
        /// Bytes of memory of a joint without muscles, and of each muscle of one angle and of two.
        pub const VM_JOINT_A_BASE: usize = $JOINT_BASE;
        /// Each muscle of a joint of one angle.
        pub const VM_JOINT_A_PER_MUSCLE: usize = $JOINT_PER_MUSCLE;
        /// Each muscle of a joint of two angles.
        pub const VM_JOINT_A_PER_MUSCLE_OF_TWO: usize = $JOINT_PER_MUSCLE_OF_TWO;
        /// Bytes of a VmJointA: one angle and two muscles.
        pub const VM_JOINT_A_SIZE: usize = VM_JOINT_A_BASE + 2 * VM_JOINT_A_PER_MUSCLE;
        /// Bytes of memory of a prosthesis without fibre types, and of each type.
        pub const VM_PROSTHESIS_A_BASE: usize = 2 * VM_MUSCLE_A_BASE + $PROSTHESIS_OWN;
        /// Each type.
        pub const VM_PROSTHESIS_A_PER_TYPE: usize = 2 * VM_MUSCLE_A_PER_TYPE;
        /// Bytes of a VmProsthesisA: two types.
        pub const VM_PROSTHESIS_A_SIZE: usize = VM_PROSTHESIS_A_BASE + 2 * VM_PROSTHESIS_A_PER_TYPE;
        /// Words of the saved state of a prosthesis of two types.
        pub const VM_PROSTHESIS_A_WORDS: usize = $PROSTHESIS_WORDS;
        /// Bytes of memory of an FES controller without fibre types, and of each type.
        pub const VM_FES_A_BASE: usize = 2 * VM_STEADY_A_BASE + $FES_OWN;
        /// Each type.
        pub const VM_FES_A_PER_TYPE: usize = 2 * VM_STEADY_A_PER_TYPE;
        /// Bytes of a VmFesA: two types.
        pub const VM_FES_A_SIZE: usize = VM_FES_A_BASE + 2 * VM_FES_A_PER_TYPE;
        /// Most words of the saved state of an FES controller: both muscles tire.
        pub const VM_FES_A_WORDS: usize = $FES_WORDS;

        /// Memory in C.
        #[repr(C, align(8))]
        pub struct VmJointA([u64; VM_JOINT_A_SIZE / 8]);
        /// Memory in C.
        #[repr(C, align(8))]
        pub struct VmProsthesisA([u64; VM_PROSTHESIS_A_SIZE / 8]);
        /// Memory in C.
        #[repr(C, align(8))]
        pub struct VmFesA([u64; VM_FES_A_SIZE / 8]);

        /// A muscle in a posture.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmPlacedA {
            /// Path length, m; in fixed point um.
            pub path_length: $Path,
            /// Moment arm about each angle, m/rad; positive where the muscle flexes.
            pub moment_arms: [$Number; VM_JOINT_ANGLES],
            /// Its derivative by the same angle, m/rad^2.
            pub arm_slopes: [$Number; VM_JOINT_ANGLES],
        }

        /// The muscles in a posture; of those and of angles that the joint does not have, all is 0.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmPostureA {
            /// Path and moment arms of each muscle.
            pub muscles: [VmPlacedA; VM_JOINT_MUSCLES],
            /// VM_JOINT_ flags.
            pub status: u8,
        }

        /// Inputs of a prosthesis in a tick.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmProsthesisInputA {
            /// EMG of flexor and extensor, mV.
            pub emg_mv: [$Amount; VM_ANTAGONISTS],
            /// Measured angle, rad.
            pub angle_rad: $Number,
        }

        /// What a prosthesis commands in a tick.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmProsthesisCommandA {
            /// Torque, N m; flexion is positive.
            pub torque_nm: $Amount,
            /// Stiffness about the measured angle, N m/rad.
            pub stiffness_nm_per_rad: $Amount,
            /// Activations of flexor and extensor, 0..1.
            pub activations: [$Number; VM_ANTAGONISTS],
            /// VM_STATUS_ flags of the muscles.
            pub muscles: [u16; VM_ANTAGONISTS],
            /// VM_PROSTHESIS_ flags.
            pub status: u16,
        }

        /// What an FES controller is to do in a tick.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmTargetA {
            /// Angle, rad.
            pub angle_rad: $Number,
            /// Its velocity, rad/s.
            pub velocity_rad_per_s: $Number,
            /// Its acceleration, rad/s^2.
            pub acceleration_rad_per_s2: $Number,
            /// Torque in addition to that of the motion, N m; with VM_MEASURED_TORQUE the only one.
            pub torque_nm: $Amount,
        }

        /// What an FES controller measures in a tick.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmSensorsA {
            /// Angle, rad.
            pub angle_rad: $Number,
            /// Torque of the muscles, N m; used with VM_MEASURED_TORQUE only.
            pub torque_nm: $Amount,
        }

        /// What an FES controller commands in a tick; pairs are flexor and extensor.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmFesCommandA {
            /// Stimulation, 0..1.
            pub activations: [$Number; VM_ANTAGONISTS],
            /// Amplitude of the pulse that recruits it, mA.
            pub amplitude_ma: [$Amount; VM_ANTAGONISTS],
            /// Width of that pulse, us.
            pub width_us: [$Amount; VM_ANTAGONISTS],
            /// Torque that was asked of the model's inverse, N m.
            pub torque_nm: $Amount,
            /// Estimated gain of the muscles.
            pub gain: $Number,
            /// VM_STATUS_ flags of the inverse.
            pub muscles: [u16; VM_ANTAGONISTS],
            /// VM_CONTROL_ flags.
            pub status: u16,
        }

        /// Static stiffness of a muscle, F0/L_ce0, for the stiffness of its joint.
        /// VM_RESULT_PARAMETER in a discrete mode, which has none.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "stiffness"))]
        pub extern "C" fn vm_a_stiffness(
            muscle: *const VmMuscleA,
            stiffness: *mut $Number,
        ) -> VmResult {
            plain(muscle::stiffness::<$S, _>(muscle, stiffness))
        }

        /// Bytes of memory that a joint of so many angles and muscles needs. VM_RESULT_PARAMETER if
        /// there is no such joint.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "joint_size"))]
        pub extern "C" fn vm_a_joint_size(
            angle_count: u32,
            muscle_count: u32,
            size: *mut usize,
        ) -> VmResult {
            plain(joint::needed::<$S>(angle_count, muscle_count, size))
        }

        /// Builds a joint. `size` is that of the memory. On VM_RESULT_PARAMETER `error`, which may
        /// be null, has the field, and the muscle's index.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "joint_build"))]
        pub extern "C" fn vm_a_joint_build(
            joint: *mut VmJointA,
            size: usize,
            params: *const VmJointParams,
            error: *mut VmError,
        ) -> VmResult {
            told(joint::build::<$S, _>(joint, size, params, error), error)
        }

        /// Paths and moment arms at angles (rad), which are clipped to their ranges and flagged.
        /// `count` is that of the angles; VM_RESULT_SIZE if the joint has more.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "joint_posture"))]
        pub extern "C" fn vm_a_joint_posture(
            joint: *const VmJointA,
            angles_rad: *const $Number,
            count: usize,
            posture: *mut VmPostureA,
        ) -> VmResult {
            let outcome = || {
                let place = Place::new(posture)?;
                place.put(joint::posture::<$S, _>(joint, angles_rad, count)?.into());
                Ok(())
            };
            plain(outcome())
        }

        /// Torque about each angle, N m, of the muscles' tendon forces relative to F0 in a posture;
        /// flexion is positive. VM_RESULT_SIZE if the joint has more muscles or angles.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "joint_torques"))]
        pub extern "C" fn vm_a_joint_torques(
            joint: *const VmJointA,
            posture: *const VmPostureA,
            relative_forces: *const $Number,
            muscle_count: usize,
            torques_nm: *mut $Amount,
            angle_count: usize,
        ) -> VmResult {
            let outcome = || {
                let posture = read(posture)?.into();
                let forces = Given { numbers: relative_forces, count: muscle_count };
                let torques = Room { places: torques_nm, count: angle_count };
                joint::torques::<$S, _>(joint, &posture, forces, torques)
            };
            plain(outcome())
        }

        /// Stiffness about each angle, N m/rad, of the muscles' forces relative to F0 and their
        /// stiffnesses (vm_a_stiffness); negative if the posture is unstable.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "joint_stiffnesses"))]
        pub extern "C" fn vm_a_joint_stiffnesses(
            joint: *const VmJointA,
            posture: *const VmPostureA,
            relative_forces: *const $Number,
            relative_stiffnesses: *const $Number,
            muscle_count: usize,
            stiffnesses_nm_per_rad: *mut $Amount,
            angle_count: usize,
        ) -> VmResult {
            let outcome = || {
                let posture = read(posture)?.into();
                let [forces, stiffnesses] = [relative_forces, relative_stiffnesses]
                    .map(|numbers| Given { numbers, count: muscle_count });
                let found = Room { places: stiffnesses_nm_per_rad, count: angle_count };
                joint::stiffnesses::<$S, _>(joint, &posture, (forces, stiffnesses), found)
            };
            plain(outcome())
        }

        /// Checksum of a joint's coefficients.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "joint_checksum"))]
        pub extern "C" fn vm_a_joint_checksum(
            joint: *const VmJointA,
            checksum: *mut u32,
        ) -> VmResult {
            plain(joint::checksum::<$S, _>(joint, checksum))
        }

        /// Bytes of memory that a prosthesis whose muscles have `fiber_count` types needs.
        /// VM_RESULT_PARAMETER if this library has none.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "prosthesis_size"))]
        pub extern "C" fn vm_a_prosthesis_size(fiber_count: u32, size: *mut usize) -> VmResult {
            plain(controller::needed::<$S, Prostheses>(fiber_count, size))
        }

        /// Builds a prosthesis for a time step (s; 1e-4 to 2e-3). `size` is that of the memory.
        /// `error`, which may be null, has details of VM_RESULT_PARAMETER and VM_RESULT_SIZE.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "prosthesis_build"))]
        pub extern "C" fn vm_a_prosthesis_build(
            prosthesis: *mut VmProsthesisA,
            size: usize,
            params: *const VmProsthesisParams,
            time_step_s: f64,
            error: *mut VmError,
        ) -> VmResult {
            told(
                controller::build::<$S, Prostheses, _>(
                    prosthesis,
                    size,
                    params,
                    time_step_s,
                    error,
                ),
                error,
            )
        }

        /// Puts a prosthesis at rest at an angle (rad), which is clipped to the joint's range.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "prosthesis_rest"))]
        pub extern "C" fn vm_a_prosthesis_rest(
            prosthesis: *mut VmProsthesisA,
            angle_rad: $Number,
        ) -> VmResult {
            plain(controller::start::<$S, Prostheses, _>(prosthesis, angle_rad))
        }

        /// Steps a prosthesis by one tick: EMGs and angle to torque and stiffness. What is out of
        /// range is clipped and flagged in `command->status`. VM_RESULT_NOT_RESTED before the first
        /// rest or restore.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "prosthesis_step"))]
        pub extern "C" fn vm_a_prosthesis_step(
            prosthesis: *mut VmProsthesisA,
            input: *const VmProsthesisInputA,
            command: *mut VmProsthesisCommandA,
        ) -> VmResult {
            let outcome = || {
                let place = Place::new(command)?;
                let input = read(input)?.into();
                place.put(controller::step::<$S, Prostheses, _>(prosthesis, input)?.into());
                Ok(())
            };
            plain(outcome())
        }

        /// Number of fibre types, and of words of a saved state.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "prosthesis_info"))]
        pub extern "C" fn vm_a_prosthesis_info(
            prosthesis: *const VmProsthesisA,
            info: *mut VmControlInfo,
        ) -> VmResult {
            plain(controller::info::<$S, Prostheses, _>(prosthesis, info))
        }

        /// Saves the state, with a fingerprint. VM_RESULT_SIZE if there is no room for its words.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "prosthesis_save"))]
        pub extern "C" fn vm_a_prosthesis_save(
            prosthesis: *const VmProsthesisA,
            words: *mut $Word,
            count: usize,
        ) -> VmResult {
            plain(controller::save::<$S, Prostheses, _>(prosthesis, words, count))
        }

        /// Restores a saved state, with the results of a muscle's restore.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "prosthesis_restore"))]
        pub extern "C" fn vm_a_prosthesis_restore(
            prosthesis: *mut VmProsthesisA,
            words: *const $Word,
            count: usize,
        ) -> VmResult {
            plain(controller::restore::<$S, Prostheses, _>(prosthesis, words, count))
        }

        /// Checksums of the coefficients and of the state.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "prosthesis_checksums"))]
        pub extern "C" fn vm_a_prosthesis_checksums(
            prosthesis: *const VmProsthesisA,
            coefficients: *mut u32,
            state: *mut u32,
        ) -> VmResult {
            plain(controller::checksums::<$S, Prostheses, _>(prosthesis, coefficients, state))
        }

        /// Bytes of memory that an FES controller whose muscles have `fiber_count` types needs.
        /// VM_RESULT_PARAMETER if this library has none.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fes_size"))]
        pub extern "C" fn vm_a_fes_size(fiber_count: u32, size: *mut usize) -> VmResult {
            plain(controller::needed::<$S, FesControllers>(fiber_count, size))
        }

        /// Builds an FES controller for a time step (s; 1e-4 to 2e-3). `size` is that of the
        /// memory. `error`, which may be null, has details of VM_RESULT_PARAMETER and
        /// VM_RESULT_SIZE.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fes_build"))]
        pub extern "C" fn vm_a_fes_build(
            fes: *mut VmFesA,
            size: usize,
            params: *const VmFesParams,
            time_step_s: f64,
            error: *mut VmError,
        ) -> VmResult {
            told(
                controller::build::<$S, FesControllers, _>(fes, size, params, time_step_s, error),
                error,
            )
        }

        /// Starts an FES controller at an angle (rad), which is clipped to the joint's range, with
        /// rested muscles and a gain of 1.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fes_start"))]
        pub extern "C" fn vm_a_fes_start(fes: *mut VmFesA, angle_rad: $Number) -> VmResult {
            plain(controller::start::<$S, FesControllers, _>(fes, angle_rad))
        }

        /// Steps an FES controller by one tick: target and sensors to pulses. What is out of range
        /// is clipped and flagged in `command->status`. VM_RESULT_NOT_RESTED before the first start
        /// or restore.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fes_step"))]
        pub extern "C" fn vm_a_fes_step(
            fes: *mut VmFesA,
            target: *const VmTargetA,
            sensors: *const VmSensorsA,
            command: *mut VmFesCommandA,
        ) -> VmResult {
            let outcome = || {
                let place = Place::new(command)?;
                let input = (read(target)?.into(), read(sensors)?.into());
                place.put(controller::step::<$S, FesControllers, _>(fes, input)?.into());
                Ok(())
            };
            plain(outcome())
        }

        /// Number of fibre types, and of words of a saved state.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fes_info"))]
        pub extern "C" fn vm_a_fes_info(fes: *const VmFesA, info: *mut VmControlInfo) -> VmResult {
            plain(controller::info::<$S, FesControllers, _>(fes, info))
        }

        /// Saves the state, with a fingerprint. VM_RESULT_SIZE if there is no room for its words.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fes_save"))]
        pub extern "C" fn vm_a_fes_save(
            fes: *const VmFesA,
            words: *mut $Word,
            count: usize,
        ) -> VmResult {
            plain(controller::save::<$S, FesControllers, _>(fes, words, count))
        }

        /// Restores a saved state, with the results of a muscle's restore.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fes_restore"))]
        pub extern "C" fn vm_a_fes_restore(
            fes: *mut VmFesA,
            words: *const $Word,
            count: usize,
        ) -> VmResult {
            plain(controller::restore::<$S, FesControllers, _>(fes, words, count))
        }

        /// Checksums of the coefficients and of the state.
        #[allow(unsafe_code)]
        #[unsafe(export_name = concat!($prefix, "fes_checksums"))]
        pub extern "C" fn vm_a_fes_checksums(
            fes: *const VmFesA,
            coefficients: *mut u32,
            state: *mut u32,
        ) -> VmResult {
            plain(controller::checksums::<$S, FesControllers, _>(fes, coefficients, state))
        }
        // </functions>

        impl From<joint::Largest<$S>> for VmPostureA {
            fn from(posture: joint::Largest<$S>) -> Self {
                Self {
                    muscles: posture.muscles.map(|muscle| VmPlacedA {
                        path_length: <$S as Arithmetic>::path_to(muscle.path_length),
                        moment_arms: muscle.moment_arms.map(Arithmetic::number),
                        arm_slopes: muscle.arm_slopes.map(Arithmetic::number),
                    }),
                    status: posture.status.bits(),
                }
            }
        }

        impl From<VmPostureA> for joint::Largest<$S> {
            fn from(posture: VmPostureA) -> Self {
                Self {
                    muscles: posture.muscles.map(|muscle| Placed {
                        path_length: <$S as Arithmetic>::path_from(muscle.path_length),
                        moment_arms: muscle.moment_arms.map(<$S>::number_from),
                        arm_slopes: muscle.arm_slopes.map(<$S>::number_from),
                    }),
                    status: JointStatus::empty(),
                }
            }
        }

        impl From<VmProsthesisInputA> for ProsthesisInput<$S> {
            fn from(input: VmProsthesisInputA) -> Self {
                Self {
                    emg: input.emg_mv.map(<$S>::amount_from),
                    angle: <$S>::number_from(input.angle_rad),
                }
            }
        }

        impl From<ProsthesisCommand<$S>> for VmProsthesisCommandA {
            fn from(command: ProsthesisCommand<$S>) -> Self {
                Self {
                    torque_nm: <$S as Arithmetic>::amount(command.torque),
                    stiffness_nm_per_rad: <$S as Arithmetic>::amount(command.stiffness),
                    activations: command.activations.map(Arithmetic::number),
                    muscles: command.muscles.map(|flags| flags.bits()),
                    status: command.status.bits(),
                }
            }
        }

        impl From<VmTargetA> for Target<$S> {
            fn from(target: VmTargetA) -> Self {
                Self {
                    angle: <$S>::number_from(target.angle_rad),
                    velocity: <$S>::number_from(target.velocity_rad_per_s),
                    acceleration: <$S>::number_from(target.acceleration_rad_per_s2),
                    torque: <$S>::amount_from(target.torque_nm),
                }
            }
        }

        impl From<VmSensorsA> for Sensors<$S> {
            fn from(sensors: VmSensorsA) -> Self {
                Self {
                    angle: <$S>::number_from(sensors.angle_rad),
                    torque: <$S>::amount_from(sensors.torque_nm),
                }
            }
        }

        impl From<FesCommand<$S>> for VmFesCommandA {
            fn from(command: FesCommand<$S>) -> Self {
                Self {
                    activations: command.activations.map(Arithmetic::number),
                    amplitude_ma: command
                        .pulses
                        .map(|pulse| <$S as Arithmetic>::amount(pulse.amplitude)),
                    width_us: command.pulses.map(|pulse| <$S as Arithmetic>::amount(pulse.width)),
                    torque_nm: <$S as Arithmetic>::amount(command.torque),
                    gain: command.gain.number(),
                    muscles: command.muscles.map(|flags| flags.bits()),
                    status: command.status.bits(),
                }
            }
        }

        const _: () = {
            use model::control::{FesControllerState, Joint, ProsthesisState};
            use $crate::control::controller::Of;
            use $crate::slot::{bytes, fits};
            macro_rules! each {
                ($N:literal) => {
                    fits(
                        bytes::<Of<$S, Prostheses, $N>>(),
                        VM_PROSTHESIS_A_BASE + $N * VM_PROSTHESIS_A_PER_TYPE,
                        3,
                    );
                    let fes = VM_FES_A_BASE + $N * VM_FES_A_PER_TYPE;
                    fits(bytes::<Of<$S, FesControllers, $N>>(), fes, 3);
                };
            }
            $crate::kinds::each_number_of_types!(each);
            macro_rules! joints_of {
                ($M:literal) => {
                    let one = VM_JOINT_A_BASE + $M * VM_JOINT_A_PER_MUSCLE;
                    fits(bytes::<Joint<$S, 1, $M>>(), one, 1);
                    let two = VM_JOINT_A_BASE + $M * VM_JOINT_A_PER_MUSCLE_OF_TWO;
                    fits(bytes::<Joint<$S, 2, $M>>(), two, 1);
                };
            }
            joints_of!(1);
            joints_of!(2);
            joints_of!(3);
            joints_of!(4);
            joints_of!(5);
            joints_of!(6);
            assert!(ProsthesisState::<$S, 2, VM_DELAY_TICKS>::SAVED_WORDS == VM_PROSTHESIS_A_WORDS);
            assert!(
                FesControllerState::<$S>::LEAST_SAVED_WORDS
                    + 2 * model::FatigueState::<$S>::SAVED_WORDS
                    == VM_FES_A_WORDS
            );
        };
    };
}
pub(crate) use control_functions;
