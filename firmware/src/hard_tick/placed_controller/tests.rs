//! What memory loses of a controller, and what its commands become at the electrodes.

use super::{Driven, PlacedController};
use crate::between::motion::Target;
use crate::between::stimulus::Stimulus;
use crate::hard_tick::placed_muscle::Demand;
use crate::link::{ControlUpload, Electrode, Mode, Modulation, Upload};
use vm_nostd::control::{ControlStatus, ELBOW, FesCommand, GainParams, LimbParams, PiParams};
use vm_nostd::{RecruitmentCurveParams, TimeStep};

const CURVE: RecruitmentCurveParams =
    RecruitmentCurveParams { threshold: 4e-3, saturation: 12e-3, chronaxie: 200e-6, slope: 2.0 };

/// An elbow whose flexor is modulated by width on channel 0, and the extensor by amplitude on
/// channel 1.
pub(crate) fn elbow() -> PlacedController {
    let muscles = [0, 1].map(|index| Upload {
        mode: Mode::Fes,
        muscle: ELBOW.muscles[index].params(),
        electrode: Some(Electrode {
            channel: index as u8,
            curve: CURVE,
            width_us: 200,
            gap_us: 40,
            recovery: 1,
        }),
    });
    let control = ControlUpload {
        range: ELBOW.range,
        paths: ELBOW.muscles.map(|muscle| muscle.path()),
        limb: LimbParams { inertia: 0.074, damping: 0.2, gravity: 2.83, hanging_angle: 0.0 },
        modulation: [
            Modulation::Width { amplitude_ua: 30_000 },
            Modulation::Amplitude { most_ua: 15_000 },
        ],
        stimulation_frequency: 40.0,
        cocontraction: 0.2,
        feedback: PiParams {
            proportional: 20.0,
            integral: 10.0,
            derivative: 0.0,
            derivative_filter: 0.02,
            most: 25.0,
        },
        expected_lag: 0.1,
        lead_filter_time: 0.025,
        fatigue: [None; 2],
        least_fitness: 0.3,
        gain: Some(GainParams { time: 5.0, least: 0.3, most: 2.0, excitation: 0.3 }),
        torque: (-30.0, 30.0),
        sensor_period_us: 2_000,
    };
    let placed =
        PlacedController::build(muscles.each_ref().map(Some), &control, TimeStep::MILLISECOND);
    placed.expect("a controller")
}

impl PlacedController {
    /// Flips a bit of a checksum: of the coefficients, of the state, or of the rest.
    pub(crate) fn flip_checksum_bit(&mut self, part: usize) {
        self.checksums[part] ^= 1;
    }

    /// Makes no gain valid.
    pub(crate) fn refuse_gains(&mut self) {
        self.frame.gains = (3.0, 4.0);
        self.checksums = self.sums();
    }
}

fn target(angle: f32) -> Target {
    Target { angle, ..Target::default() }
}

#[test]
fn what_memory_loses_of_a_controller_is_seen_and_does_not_heal() {
    let changes: [fn(&mut PlacedController); 10] = [
        |p| p.frame.driven[0].channel ^= 1,
        |p| p.frame.driven[1].width_us ^= 1,
        |p| p.frame.driven[0].gap_us ^= 1,
        |p| p.frame.driven[1].recovery ^= 1,
        |p| p.frame.driven[0].modulation = Modulation::Amplitude { most_ua: 30_000 },
        |p| p.frame.driven[1].modulation = Modulation::Amplitude { most_ua: 15_001 },
        |p| p.frame.frequency_tenths_pps ^= 1,
        |p| p.frame.range_urad.1 ^= 1,
        |p| p.frame.period_us ^= 1,
        |p| p.frame.gains.0 = 0.300_001,
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let mut placed = elbow();
        assert!(placed.check());
        let frame = placed.frame;
        change(&mut placed);
        assert!(!placed.check(), "change {index}");
        placed.frame = frame;
        assert!(!placed.check(), "change {index}");
    }
    for part in 0..3 {
        let mut placed = elbow();
        placed.flip_checksum_bit(part);
        assert!(!placed.check(), "part {part}");
        // A new state would have a valid checksum.
        placed.start(1.0);
        assert!(placed.step(&target(1.5), 1.0).is_none() && !placed.check());
    }
    // The state of another tick, with the checksum of this one.
    let mut placed = elbow();
    let before = placed.state;
    placed.step(&target(1.5), 1.0).expect("a step");
    assert!(placed.check());
    placed.state = before;
    assert!(!placed.check());
}

/// A step does not make the checksums of coefficients that were lost before.
#[test]
fn a_step_does_not_hide_what_was_lost_before() {
    let mut placed = elbow();
    placed.frame.driven[0].gap_us ^= 1;
    placed.step(&target(1.5), 1.0).expect("a step");
    assert!(!placed.check());
}

#[test]
fn a_controller_is_built_at_rest_in_the_middle_of_its_range() {
    assert_eq!(ELBOW.range.least, 0.0);
    let built = elbow();
    let state_at = |angle| {
        let mut placed = elbow();
        placed.start(angle);
        placed.state.checksum()
    };
    assert_eq!(built.state.checksum(), state_at(ELBOW.range.most as f32 / 2.0));
    assert_ne!(built.state.checksum(), state_at(0.0));
}

#[test]
fn commands_become_pulses_within_the_electrodes_bounds() {
    let mut placed = elbow();
    placed.start(1.0);
    let mut widest = [0; 2];
    for (wanted, muscle) in [(2.4, 0), (0.0, 1)] {
        for _ in 0..3_000 {
            let stepped = placed.step(&target(wanted), 1.0).expect("a step");
            assert!(stepped.gain_is_valid);
            for (index, demand) in stepped.demands.into_iter().enumerate() {
                let Demand::Pulses(channel, stimulus) = demand else { continue };
                let Stimulus { amplitude_ua, width_us, frequency_tenths_pps, .. } = stimulus;
                assert_eq!((channel, frequency_tenths_pps), (index, 400));
                assert!((20..=200).contains(&width_us), "{width_us}");
                match index {
                    0 => assert_eq!(amplitude_ua, 30_000),
                    _ => assert_eq!((width_us, amplitude_ua > 15_000), (200, false)),
                }
                let size = if index == 0 { u32::from(width_us) } else { amplitude_ua };
                widest[index] = widest[index].max(size);
            }
        }
        assert!(widest[muscle] > 0, "{muscle} {widest:?}");
    }
    // Whatever is asked for: not more than the electrode's width, and the uploaded amplitude.
    assert_eq!(widest[1], 15_000);
    let Driven { width_us, .. } = placed.frame.driven[0];
    assert!(widest[0] <= u32::from(width_us));
}

#[test]
fn no_activation_and_no_number_are_no_pulses() {
    let mut placed = elbow();
    let stepped = placed.step(&target(1.0), 1.0).expect("a step");
    assert!(stepped.demands.iter().all(|demand| *demand != Demand::NotFinite));
    let command = FesCommand::<f32> {
        activations: [0.0, f32::NAN],
        pulses: [vm_nostd::Pulse { amplitude: 30.0, width: 100.0 }; 2],
        torque: 0.0,
        gain: 1.0,
        muscles: [vm_nostd::Status::empty(); 2],
        status: ControlStatus::empty(),
    };
    assert_eq!(placed.demand(0, &command), Demand::Nothing);
    assert_eq!(placed.demand(1, &command), Demand::NotFinite);
    // The shortest phase is 20 µs.
    let mut short = command;
    short.activations = [0.1; 2];
    let mut of_width = |width| {
        short.pulses[0].width = width;
        placed.demand(0, &short)
    };
    assert_eq!(of_width(19.9), Demand::Nothing);
    assert!(matches!(of_width(20.0), Demand::Pulses(0, Stimulus { width_us: 20, .. })));
    assert_eq!(of_width(f32::INFINITY), Demand::NotFinite);
}
