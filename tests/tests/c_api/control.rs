//! What `tests/c/control_rows.h` plays, by the Rust library: the knee's prosthesis, FES controller
//! and joint.

use vm_nostd::control::{
    CommandLimits, EnvelopeParams, FesController, FesControllerParams, GainParams, Joint, KNEE,
    LimbParams, Measured, Modulation, PiParams, Prosthesis, ProsthesisInput, ProsthesisParams,
    Sensors, Target,
};
use vm_nostd::{FatigueParams, Fixed, RecruitmentCurveParams, Scalar, Status, TimeStep};

/// Ticks that are played.
const TICKS: i32 = 400;
/// Bytes of a tick: prosthesis, FES controller, joint.
const BYTES: usize = 4 * (7 + 11 + 6);

fn prosthesis() -> ProsthesisParams<2> {
    let envelope =
        EnvelopeParams { rest: 0.01, maximal: 0.51, cutoff_frequency: 4.0, delay: 0.0, shape: 0.0 };
    ProsthesisParams {
        range: KNEE.range,
        muscles: KNEE.muscles.map(|muscle| muscle.params()),
        paths: KNEE.muscles.map(|muscle| muscle.path()),
        envelopes: [envelope, EnvelopeParams { delay: 0.03, shape: -1.0, ..envelope }],
        torque: CommandLimits { least: -400.0, most: 400.0, rate: 1e5 },
        stiffness: CommandLimits { least: 0.0, most: 2000.0, rate: 1e6 },
    }
}

fn fes() -> FesControllerParams<2> {
    let electrode = RecruitmentCurveParams {
        threshold: 4e-3,
        saturation: 12e-3,
        chronaxie: 200e-6,
        slope: 2.0,
    };
    FesControllerParams {
        range: KNEE.range,
        muscles: KNEE.muscles.map(|muscle| muscle.params()),
        paths: KNEE.muscles.map(|muscle| muscle.path()),
        limb: LimbParams { inertia: 0.3, damping: 0.5, gravity: 15.0, hanging_angle: 1.5 },
        electrodes: [electrode; 2],
        modulation: [Modulation::Width { amplitude: 16e-3 }, Modulation::Amplitude { width: 3e-4 }],
        stimulation_frequency: 33.0,
        cocontraction: 1.0,
        measured: Measured::Angle,
        feedback: PiParams {
            proportional: 30.0,
            integral: 60.0,
            derivative: 2.0,
            derivative_filter: 0.02,
            most: 20.0,
        },
        expected_lag: 0.1,
        lead_filter_time: 0.03,
        fatigue: [
            Some(FatigueParams {
                fatigue_time: 18.0,
                recovery_time: 30.0,
                least_fitness: 0.2,
                frequency_dependence: 0.6,
            }),
            None,
        ],
        least_fitness: 0.3,
        gain: Some(GainParams { time: 5.0, least: 0.3, most: 2.0, excitation: 2.0 }),
        torque: (-80.0, 60.0),
    }
}

/// Words of one arithmetic; `bits` are those of a quantity.
fn words<S: Scalar<Bits = u32>>(bits: impl Fn(S::Quantity) -> u32) -> Vec<u32> {
    let step = TimeStep::MILLISECOND;
    let number = |n: i32| S::from_f64(f64::from(n) / 256.0);
    let amount = |n: i32| S::quantity(f64::from(n) / 256.0);
    let flags = |muscles: [Status; 2]| muscles.map(|flags| u32::from(flags.bits()));
    let prosthesis = Prosthesis::<S, 2, 100>::build(&prosthesis(), step).expect("a prosthesis");
    let fes = FesController::<S, 2>::build(&fes(), step).expect("a controller");
    let muscles = KNEE.muscles.map(|muscle| muscle.on_joint());
    let joint = Joint::<S, 1, 2>::build(&[KNEE.range], &muscles).expect("a joint");
    let mut at_rest = prosthesis.rest(number(200)).expect("an angle");
    let mut started = fes.start(number(200));
    let mut words: Vec<u32> = Vec::new();
    for tick in 0..TICKS {
        let angle = number(100 + tick);
        let emg = [amount(tick * 37 % 129 - 64), amount(tick * 11 % 65 - 32)];
        let command = prosthesis.step(&mut at_rest, ProsthesisInput { emg, angle });
        words.extend([bits(command.torque), bits(command.stiffness)]);
        words.extend(command.activations.map(S::to_bits));
        words.extend(flags(command.muscles));
        words.push(command.status.bits().into());
        let target = Target {
            angle: number(120 + tick),
            velocity: number(tick % 50),
            acceleration: number(tick % 7),
            torque: amount(tick % 300),
        };
        let command = fes.step(&mut started, target, Sensors { angle, torque: S::quantity(0.0) });
        words.extend(command.activations.map(S::to_bits));
        words.extend(command.pulses.map(|pulse| bits(pulse.amplitude)));
        words.extend(command.pulses.map(|pulse| bits(pulse.width)));
        words.extend([bits(command.torque), command.gain.to_bits()]);
        words.extend(flags(command.muscles));
        words.push(command.status.bits().into());
        let posture = joint.posture([angle]);
        let forces = [number(tick % 200), number(tick % 90)];
        let [torque] = joint.torques(&posture, &forces);
        let [stiffness] = joint.stiffnesses(&posture, &forces, &forces);
        words.extend([bits(torque), bits(stiffness)]);
        for muscle in posture.muscles {
            words.extend([muscle.moment_arms[0], muscle.arm_slopes[0]].map(S::to_bits));
        }
    }
    words
}

/// Asserts that a program has written the words of both arithmetics.
pub fn compare(written: &[u8]) {
    let float = words::<f32>(f32::to_bits);
    let fixed = words::<Fixed>(|quantity| quantity.to_bits().cast_unsigned());
    let expected: Vec<u8> = float.into_iter().chain(fixed).flat_map(u32::to_le_bytes).collect();
    assert_eq!(expected.len(), 2 * BYTES * TICKS as usize);
    assert_eq!(written.len(), expected.len());
    let mut ticks = written.chunks(BYTES).zip(expected.chunks(BYTES));
    assert_eq!(
        ticks.position(|(a, b)| a != b),
        None,
        "the first tick of a controller that differs"
    );
    // They are not all alike.
    let torques: std::collections::HashSet<&[u8]> =
        expected.chunks(BYTES).map(|tick| &tick[..4]).collect();
    assert!(torques.len() > TICKS as usize, "{}", torques.len());
}
