//! Six muscles and a skeleton, coupled at every tick: energy is conserved, every arithmetic moves
//! the arm as the reference does, and effective length destabilises it as in the paper.

use host_sim::arm::{self, Activations, Arm, Drive, Moment, Outcome};
use host_sim::engine::Arithmetic;
use host_sim::figures::{ARM_ACTIVATIONS, ARM_START};
use host_sim::reference::Mode;

const TIME_STEP: f64 = 1e-3;
/// Duration, s: long enough for force errors to act, and for swings to still grow.
const DURATION: f64 = 5.0;

fn drive(mode: Mode, arithmetic: Arithmetic) -> Drive {
    Drive {
        mode,
        arithmetic,
        activations: ARM_ACTIVATIONS,
        stimulation_frequency: 20.0,
        start: ARM_START.map(f64::to_radians),
        time_step: TIME_STEP,
        duration: DURATION,
    }
}

fn run(drive: &Drive) -> (Vec<Moment>, Outcome) {
    let arm = Arm::built_in();
    let moments = arm::run(&arm, drive).expect("a run");
    let outcome = Outcome::of(&arm, &moments, drive.time_step);
    assert!(outcome.status.is_empty(), "{:?} {:?}", drive.mode, outcome.status);
    (moments, outcome)
}

/// The largest difference of an angle, degrees.
fn difference(one: &[Moment], other: &[Moment]) -> f64 {
    let differences = one.iter().zip(other).flat_map(|(one, other)| {
        [0, 1].map(|joint| (one.angles[joint] - other.angles[joint]).abs().to_degrees())
    });
    differences.fold(0.0, f64::max)
}

const MODES: [Mode; 4] =
    [Mode::Continuous, Mode::Fes, Mode::Discrete, Mode::DiscreteEffectiveLength];
const ARITHMETICS: [Arithmetic; 3] = [Arithmetic::Reference, Arithmetic::F32, Arithmetic::Fixed];

/// Kinetic energy equals the work of the muscles (no friction, no gravity).
#[test]
fn energy_is_balanced() {
    for mode in MODES {
        for arithmetic in ARITHMETICS {
            let (moments, outcome) = run(&drive(mode, arithmetic));
            let turnover = moments.last().expect("a moment").turnover;
            assert!(turnover > 10.0, "{turnover} J are worth balancing");
            let error = outcome.energy_error;
            let most = match mode {
                Mode::Continuous => 3.8e-8,
                Mode::Fes => 9e-8,
                Mode::Discrete | Mode::DiscreteEffectiveLength => 4.8e-8,
            };
            assert!(error < most, "{mode:?} {arithmetic:?}: {error:e} of the turnover");
        }
    }
}

/// The energy error is that of the coupling: it falls to a quarter with half the tick.
#[test]
fn the_coupling_is_of_second_order() {
    let coarse = drive(Mode::Continuous, Arithmetic::F64);
    let fine = Drive { time_step: TIME_STEP / 2.0, ..coarse };
    let ratio = run(&coarse).1.energy_error / run(&fine).1.energy_error;
    assert!((3.5..4.5).contains(&ratio), "{ratio}");
}

/// Over 5 s, so that errors of force affect the angles.
#[test]
fn all_arithmetics_move_the_arm_as_the_reference() {
    for mode in MODES {
        let (reference, _) = run(&drive(mode, Arithmetic::Reference));
        // Degrees. FES starts at full force; with effective length the arm is unstable, and
        // differences grow.
        let [of_f32, of_fixed] = match mode {
            Mode::Continuous | Mode::Discrete => [6e-4, 3.8e-3],
            Mode::Fes => [0.017, 0.017],
            Mode::DiscreteEffectiveLength => [0.047, 0.1],
        };
        for (arithmetic, most) in [(Arithmetic::F32, of_f32), (Arithmetic::Fixed, of_fixed)] {
            let (moments, _) = run(&drive(mode, arithmetic));
            let degrees = difference(&moments, &reference);
            assert!(degrees < most, "{mode:?} {arithmetic:?}: {degrees} degrees");
        }
    }
}

/// Figure 3: unstable with effective length, stable without, in every arithmetic.
#[test]
fn effective_length_makes_the_arm_unstable() {
    for arithmetic in ARITHMETICS {
        for mode in MODES {
            let (_, outcome) = run(&drive(mode, arithmetic));
            let unstable = mode == Mode::DiscreteEffectiveLength;
            let swings = outcome.swings.expect("long enough");
            assert_eq!(swings.settle(), !unstable, "{mode:?} {arithmetic:?}: {outcome:?}");
            // Only the elbow oscillates, and long after it had settled without effective length.
            assert_eq!(swings.late[1] > 5.0, unstable, "{mode:?} {arithmetic:?}");
            assert_eq!(swings.growth()[1] > 0.5, unstable, "{mode:?} {arithmetic:?}");
            assert!(!outcome.out_of_range);
        }
    }
}

/// Judgement of settling, oscillation and divergence.
#[test]
fn an_unstimulated_arm_comes_to_rest() {
    for activation in [0.0, 0.05] {
        let activations = Activations { shoulder: activation, elbow: activation, biarticular: 0.0 };
        let slow =
            Drive { activations, duration: 20.0, ..drive(Mode::Continuous, Arithmetic::F32) };
        let (_, outcome) = run(&slow);
        assert!(outcome.swings.is_some_and(|swings| swings.settle()), "{outcome:?}");
        let short = Drive { duration: 2.9, ..slow };
        assert!(run(&short).1.swings.is_none());
    }
    // Far beyond the range of an elbow.
    let activations = Activations { shoulder: 1.0, elbow: 0.0, biarticular: 1.0 };
    let over = Drive { activations, ..drive(Mode::Continuous, Arithmetic::F64) };
    let arm = Arm::built_in();
    let moments = arm::run(&arm, &over).expect("a run");
    assert!(Outcome::of(&arm, &moments, over.time_step).out_of_range);
}

#[test]
fn invalid_values_are_named() {
    let refuse = |change: &dyn Fn(&mut Drive)| {
        let mut drive = drive(Mode::Continuous, Arithmetic::F32);
        change(&mut drive);
        arm::run(&Arm::built_in(), &drive).expect_err("refused").to_string()
    };
    assert_eq!(
        refuse(&|drive| drive.activations.elbow = 1.4),
        "elbow activation = 1.4: must be 0 to 1"
    );
    let message = refuse(&|drive| drive.start[1] = 3.0);
    assert!(message.starts_with("elbow angle = 171.88"), "{message}");
    assert!(message.ends_with("must be 0 to 155 degrees"), "{message}");
    assert_eq!(refuse(&|drive| drive.time_step = 1e-5), "tick = 0.01: must be 0.1 to 2 ms");
    // A posture in which a muscle's tendon is slack at any fascicle length.
    let message = refuse(&|drive| drive.start = [135.0_f64, 155.0].map(f64::to_radians));
    let named = "start = 135.000, 155.000 degrees: elbow flexor: path_length = ";
    assert!(message.starts_with(named), "{message}");
    assert!(refuse(&|drive| drive.duration = 1e9).starts_with("duration = 1000000000: must be"));
}
