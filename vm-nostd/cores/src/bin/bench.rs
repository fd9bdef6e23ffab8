//! The bench: drives what is measured through inputs that the host puts in, so that a trace of its
//! execution shows what each tick costs. It measures nothing itself.
//!
//! The inputs are little-endian words. Per run: a mask with a bit for each case, in the order of
//! `main`, that it is for; the number of its rows; then activation, path length and stimulation
//! frequency of each as `f32` bits. The first row is the muscle at rest.
#![no_std]
#![no_main]

use core::hint::black_box;
use literal_port::{Drive, LiteralMuscle, STABLE_STEPS, kernels_of_one_evaluation};
use semihosting::process::ExitCode;
use vm_nostd::control::{
    ELBOW, FesCommand, FesController, FesControllerParams, FesControllerState, GainParams,
    JointError, LimbParams, Measured, Modulation, PiParams, Sensors, Target,
};
use vm_nostd::{
    ActingLength, Class, EffectiveLength, FascicleLength, FatigueParams, Fixed, Input,
    IntramuscularFes, MotorUnits, Muscle, MuscleParams, NaturalContinuous, NaturalDiscrete, Output,
    ParameterError, Recruitment, RecruitmentCurveParams, Scalar, State, TimeStep, UnitSizes,
};
use vm_nostd_cores::MUSCLE;

static INPUTS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/bench_inputs.bin"));

// What is measured: one tick each.

/// A tick of the model, under a name of its own for each mode and arithmetic.
macro_rules! step {
    ($name:ident, $scalar:ty, $mode:ty) => {
        #[inline(never)]
        fn $name(
            muscle: &Muscle<$scalar, $mode, 2>,
            state: &mut State<$scalar, $mode, 2>,
            input: Input<$scalar>,
        ) -> Output<$scalar> {
            muscle.step(state, input)
        }
    };
}
step!(step_continuous_f32, f32, NaturalContinuous);
step!(step_fes_f32, f32, IntramuscularFes);
step!(step_continuous_fixed, Fixed, NaturalContinuous);
step!(step_fes_fixed, Fixed, IntramuscularFes);
step!(step_discrete_2_f32, f32, NaturalDiscrete<FascicleLength, 2>);
step!(step_discrete_60_f32, f32, NaturalDiscrete<FascicleLength, 60>);
// For the paper's figure 7.
step!(step_discrete_6_f32, f32, NaturalDiscrete<FascicleLength, 6>);
step!(step_discrete_12_f32, f32, NaturalDiscrete<FascicleLength, 12>);
step!(step_discrete_30_f32, f32, NaturalDiscrete<FascicleLength, 30>);
step!(step_leff_2_f32, f32, NaturalDiscrete<EffectiveLength, 2>);
step!(step_leff_6_f32, f32, NaturalDiscrete<EffectiveLength, 6>);
step!(step_leff_12_f32, f32, NaturalDiscrete<EffectiveLength, 12>);
step!(step_leff_30_f32, f32, NaturalDiscrete<EffectiveLength, 30>);
step!(step_leff_60_f32, f32, NaturalDiscrete<EffectiveLength, 60>);

/// A tick of the literal port, under a name of its own for each mode and precision.
macro_rules! literal {
    ($name:ident, $real:ty, $input:ident => $drive:expr) => {
        #[inline(never)]
        fn $name(muscle: &mut LiteralMuscle<$real>, $input: Input<f32>) -> $real {
            muscle.tick($drive, $input.path_length.into())
        }
    };
}
literal!(literal_continuous_f32, f32, input => Drive::Natural(input.activation));
literal!(literal_fes_f32, f32, input => {
    Drive::Fes(input.activation, input.stimulation_frequency)
});
literal!(literal_continuous_f64, f64, input => Drive::Natural(input.activation.into()));
literal!(literal_fes_f64, f64, input => {
    Drive::Fes(input.activation.into(), input.stimulation_frequency.into())
});

/// A tick of the FES controller, under a name of its own for each arithmetic.
macro_rules! control {
    ($name:ident, $scalar:ty) => {
        #[inline(never)]
        fn $name(
            controller: &FesController<$scalar, 2>,
            state: &mut FesControllerState<$scalar>,
            target: Target<$scalar>,
            sensors: Sensors<$scalar>,
        ) -> FesCommand<$scalar> {
            controller.step(state, target, sensors)
        }
    };
}
control!(step_controller_f32, f32);
control!(step_controller_fixed, Fixed);

#[inline(never)]
fn kernels_f32(input: Input<f32>) -> f32 {
    kernels_of_one_evaluation(10.0 * input.path_length, input.activation, 1.0)
}

/// Takes words off the front of the inputs.
struct Words(&'static [u8]);

impl Words {
    fn next(&mut self) -> Option<u32> {
        let (word, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(u32::from_le_bytes(*word))
    }

    fn input(&mut self) -> Option<Input<f32>> {
        Some(Input {
            activation: f32::from_bits(self.next()?),
            path_length: f32::from_bits(self.next()?),
            stimulation_frequency: f32::from_bits(self.next()?),
        })
    }
}

/// Drives a case through its runs: `rest` makes what is stepped, for a path length (m).
fn drive<M, O>(
    case: u32,
    rest: impl Fn(f32) -> Result<M, ParameterError>,
    tick: impl Fn(&mut M, Input<f32>) -> O,
) -> Result<(), ParameterError> {
    let mut words = Words(INPUTS);
    while let (Some(mask), Some(rows)) = (words.next(), words.next()) {
        let Some(first) = words.input() else { break };
        let wanted = mask & (1 << case) != 0;
        let mut subject = if wanted { Some(rest(first.path_length)?) } else { None };
        for _ in 1..rows {
            let Some(input) = words.input() else { break };
            if let Some(subject) = &mut subject {
                black_box(tick(black_box(subject), black_box(input)));
            }
        }
    }
    Ok(())
}

fn drive_all() -> Result<(), ParameterError> {
    model(0, step_continuous_f32)?;
    model(1, step_fes_f32)?;
    model(2, step_continuous_fixed)?;
    model(3, step_fes_fixed)?;
    literal(4, literal_continuous_f32)?;
    literal(5, literal_fes_f32)?;
    literal(6, literal_continuous_f64)?;
    literal(7, literal_fes_f64)?;
    drive(8, |_| Ok(()), |(), input| kernels_f32(input))?;
    model_of_units(9, 1, step_discrete_2_f32)?;
    model_of_units(10, 30, step_discrete_60_f32)?;
    model_of_units(11, 3, step_discrete_6_f32)?;
    model_of_units(12, 6, step_discrete_12_f32)?;
    model_of_units(13, 15, step_discrete_30_f32)?;
    model_of_units(14, 1, step_leff_2_f32)?;
    model_of_units(15, 3, step_leff_6_f32)?;
    model_of_units(16, 6, step_leff_12_f32)?;
    model_of_units(17, 15, step_leff_30_f32)?;
    model_of_units(18, 30, step_leff_60_f32)?;
    controller(19, step_controller_f32).map_err(|refused| refused.error)?;
    controller(20, step_controller_fixed).map_err(|refused| refused.error)
}

/// What steps a muscle.
type Step<S, R> = fn(&Muscle<S, R, 2>, &mut State<S, R, 2>, Input<S>) -> Output<S>;

/// The accuracy class that the bench was built for.
fn class() -> Class {
    match option_env!("VM_BENCH_CLASS") {
        Some("economy") => Class::Economy,
        Some("fine") => Class::Fine,
        _ => Class::Standard,
    }
}

/// Drives the model.
fn model<S: Scalar, R: Recruitment<S, 2, Units = ()>>(
    case: u32,
    step: Step<S, R>,
) -> Result<(), ParameterError> {
    model_with(case, &(), step)
}

/// Drives the model with so many motor units of each type.
fn model_of_units<S: Scalar, A: ActingLength<S>, const UNITS: usize>(
    case: u32,
    count: usize,
    step: Step<S, NaturalDiscrete<A, UNITS>>,
) -> Result<(), ParameterError> {
    let units = MotorUnits::new(&MUSCLE, [UnitSizes::Default(count); 2])?;
    model_with(case, &units, step)
}

fn model_with<S: Scalar, R: Recruitment<S, 2>>(
    case: u32,
    units: &R::Units,
    step: Step<S, R>,
) -> Result<(), ParameterError> {
    let params = MuscleParams { class: class(), ..MUSCLE };
    let muscle = Muscle::<S, R, 2>::build_with_units(&params, units, TimeStep::MILLISECOND)?;
    drive(
        case,
        |path| muscle.rest(S::path_length(path.into())),
        |state, input| {
            let input = Input {
                activation: S::from_f64(input.activation.into()),
                path_length: S::path_length(input.path_length.into()),
                stimulation_frequency: S::quantity(input.stimulation_frequency.into()),
            };
            step(black_box(&muscle), state, black_box(input))
        },
    )
}

/// Drives a literal port.
fn literal<R: literal_port::Real + From<f32>>(
    case: u32,
    tick: fn(&mut LiteralMuscle<R>, Input<f32>) -> R,
) -> Result<(), ParameterError> {
    drive(case, |path| Ok(LiteralMuscle::at_rest(path.into(), STABLE_STEPS)), tick)
}

/// What steps a controller.
type Control<S> =
    fn(&FesController<S, 2>, &mut FesControllerState<S>, Target<S>, Sensors<S>) -> FesCommand<S>;

/// Drives the controller of an elbow with all that it can do: paths, in m, are taken as angles to
/// be reached, pps as angles measured, and activations as motion.
fn controller<S: Scalar>(case: u32, step: Control<S>) -> Result<(), JointError> {
    let electrode =
        RecruitmentCurveParams { threshold: 6e-3, saturation: 18e-3, chronaxie: 2e-4, slope: 2.0 };
    let params = FesControllerParams {
        range: ELBOW.range,
        muscles: ELBOW.muscles.map(|muscle| muscle.params()),
        paths: ELBOW.muscles.map(|muscle| muscle.path()),
        limb: LimbParams { inertia: 0.07, damping: 0.3, gravity: 2.5, hanging_angle: 0.0 },
        electrodes: [electrode; 2],
        modulation: [Modulation::Width { amplitude: 0.03 }, Modulation::Amplitude { width: 3e-4 }],
        stimulation_frequency: 40.0,
        cocontraction: 0.3,
        measured: Measured::Angle,
        feedback: PiParams {
            proportional: 6.0,
            integral: 4.0,
            derivative: 0.6,
            derivative_filter: 0.02,
            most: 10.0,
        },
        expected_lag: 0.1,
        lead_filter_time: 0.025,
        fatigue: [Some(FatigueParams::QUADRICEPS); 2],
        least_fitness: 0.3,
        gain: Some(GainParams { time: 5.0, least: 0.3, most: 2.0, excitation: 0.3 }),
        torque: (-20.0, 20.0),
    };
    let controller = FesController::<S, 2>::build(&params, TimeStep::MILLISECOND)?;
    let of = |value: f32| S::from_f64(value.into());
    let driven = drive(
        case,
        |path| Ok(controller.start(of(10.0 * path))),
        |state, input| {
            let motion = 5.0 * input.activation - 3.0;
            let target = Target {
                angle: of(10.0 * input.path_length),
                velocity: of(motion),
                acceleration: of(10.0 * motion),
                torque: S::quantity(0.0),
            };
            let angle = of(input.stimulation_frequency / 25.0);
            let sensors = Sensors { angle, torque: S::quantity(0.0) };
            step(black_box(&controller), state, black_box(target), black_box(sensors))
        },
    );
    driven.map_err(|error| JointError { muscle: None, error })
}

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    let done = drive_all().is_ok();
    let code = if done { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    code.exit_process()
}

#[panic_handler]
fn on_panic(_: &core::panic::PanicInfo<'_>) -> ! {
    ExitCode::FAILURE.exit_process()
}
