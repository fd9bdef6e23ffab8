//! What memory loses of a muscle: any bit, seen at the next check, and never forgotten.

use super::{Demand, PlacedMuscle};
use crate::between::guarded::Guarded;
use crate::between::stimulus::Stimulus;
use crate::link::{Electrode, Mode, RowInputs, RowOutputs, Upload};
use vm_nostd::{RecruitmentCurve, RecruitmentCurveParams, TimeStep};
use vm_nostd_cores::MUSCLE;

const CURVE: RecruitmentCurveParams =
    RecruitmentCurveParams { threshold: 4e-3, saturation: 12e-3, chronaxie: 200e-6, slope: 2.0 };
const ELECTRODE: Electrode =
    Electrode { channel: 2, curve: CURVE, width_us: 200, gap_us: 40, recovery: 3 };
const STIMULUS: Stimulus = Stimulus {
    amplitude_ua: 10_000,
    width_us: 200,
    gap_us: 50,
    frequency_tenths_pps: 400,
    recovery: 3,
};
const INPUTS: RowInputs =
    RowInputs { activation: 0.5, path_length: 0.16, stimulation_frequency: 40.0 };

impl PlacedMuscle {
    /// Flips a bit of its checksum, as memory may.
    pub(crate) fn flip_checksum_bit(&mut self) {
        self.checksums[0] ^= 1;
    }
}

fn placed() -> PlacedMuscle {
    let upload = Upload { mode: Mode::Fes, muscle: MUSCLE, electrode: Some(ELECTRODE) };
    PlacedMuscle::build(&upload, TimeStep::MILLISECOND).expect("a muscle")
}

#[test]
fn every_field_of_an_electrode_is_in_its_checksum() {
    assert!(placed().check());
    let changes: [fn(&mut Electrode); 5] = [
        |e| e.channel ^= 1,
        |e| e.width_us ^= 1 << 9,
        |e| e.gap_us ^= 1,
        |e| e.recovery ^= 4,
        |e| e.width_us ^= 1,
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let mut placed = placed();
        change(&mut placed.electrode.as_mut().expect("an electrode").0);
        assert!(!placed.check(), "change {index}");
    }
    let mut placed = placed();
    let other = RecruitmentCurveParams { slope: 2.000_001, ..CURVE };
    placed.electrode.as_mut().expect("an electrode").1 =
        RecruitmentCurve::build(&other).expect("a curve");
    assert!(!placed.check(), "its curve");
    placed.electrode = None;
    assert!(!placed.check(), "an electrode that is gone");
}

/// Memory that is right again was wrong all the same.
#[test]
fn a_muscle_that_has_lost_a_bit_does_not_heal() {
    let mut placed = placed();
    let electrode = placed.electrode;
    placed.electrode.as_mut().expect("an electrode").0.gap_us ^= 1;
    assert!(!placed.check());
    placed.electrode = electrode;
    assert!(!placed.check());
    assert_eq!(placed.step(&INPUTS), RowOutputs::default());
    assert_eq!(placed.demand(&INPUTS), Demand::Nothing);
    assert!(!placed.check());
    // At rest it is the same muscle, and has still lost it.
    placed.rest(0.15).expect("a path");
    assert!(!placed.check());
}

/// A bit of the state, of a coefficient, and one that a tick would hide.
#[test]
fn a_tick_does_not_hide_what_was_lost_before() {
    for word in 0..3 {
        let mut placed = placed();
        let before = placed.words();
        let output = placed.step(&INPUTS);
        assert!(placed.check() && output.force > 0.0 && placed.words() != before);
        placed.checksums[word] ^= 1;
        assert!(!placed.check(), "checksum {word}");
    }
    let other = {
        let mut muscle = MUSCLE;
        muscle.mass *= 1.0001;
        let upload = Upload { mode: Mode::Fes, muscle, electrode: Some(ELECTRODE) };
        PlacedMuscle::build(&upload, TimeStep::MILLISECOND).expect("a muscle")
    };
    let mut placed = placed();
    placed.muscle = other.muscle;
    // Only the state is summed again.
    let _output = placed.step(&INPUTS);
    assert!(!placed.check());
}

#[test]
fn a_row_asks_for_what_recruits_its_activation_at_its_frequency() {
    let demand = |activation, stimulation_frequency| {
        placed().demand(&RowInputs { activation, stimulation_frequency, ..INPUTS })
    };
    let Demand::Pulses(2, stimulus) = demand(0.5, 40.06) else { panic!("no pulses") };
    // 8 mA for ever, 16 mA for a chronaxie.
    assert!(stimulus.amplitude_ua.abs_diff(16_000) <= 1, "{stimulus:?}");
    assert_eq!((stimulus.width_us, stimulus.gap_us, stimulus.recovery), (200, 40, 3));
    assert_eq!(stimulus.frequency_tenths_pps, 400);
    // None of 0, of less than a pulse a second, and of less than nothing.
    for (activation, frequency) in [(0.0, 40.0), (-0.5, 40.0), (0.5, 0.99), (0.5, 0.0), (0.5, -4.0)]
    {
        assert_eq!(demand(activation, frequency), Demand::Nothing, "{activation} {frequency}");
    }
    assert!(matches!(demand(1e-6, 40.0), Demand::Pulses(..)));
    assert!(matches!(demand(0.5, 1.0), Demand::Pulses(..)));
    for (activation, frequency) in
        [(f32::NAN, 40.0), (f32::INFINITY, 40.0), (0.5, f32::NAN), (0.5, f32::INFINITY)]
    {
        assert_eq!(demand(activation, frequency), Demand::NotFinite, "{activation} {frequency}");
    }
}

/// Two demands that differ have other checksums.
#[test]
fn every_kind_of_demand_is_told_from_the_others() {
    let Demand::Pulses(channel, stimulus) = placed().demand(&INPUTS) else { panic!("no pulses") };
    let zeros =
        Stimulus { amplitude_ua: 0, width_us: 0, gap_us: 0, frequency_tenths_pps: 0, recovery: 0 };
    let demands = [
        Demand::Nothing,
        Demand::Pulses(0, zeros),
        Demand::NotFinite,
        Demand::Pulses(channel, stimulus),
        Demand::Pulses(channel + 1, stimulus),
        Demand::Pulses(0, stimulus),
    ];
    let sum = |demand: &Demand| {
        let mut checksum = vm_nostd::Checksum::EMPTY;
        crate::between::guarded::Sum::sum(demand, &mut checksum);
        checksum.value()
    };
    for (index, one) in demands.iter().enumerate() {
        for other in &demands[..index] {
            assert_ne!(sum(one), sum(other), "{one:?} and {other:?}");
        }
    }
}

/// Where one demand ends and the next one begins is in the sum, too.
#[test]
fn a_demand_is_not_taken_for_another_one_and_a_part_of_the_next() {
    let words = |high: u16, low: u16| u32::from(high) << 16 | u32::from(low);
    for (channel, next, amplitude_ua) in
        (0..64).map(|index| (index / 16, index / 4 % 4, (index % 4) as u32))
    {
        let one = Stimulus { amplitude_ua, ..STIMULUS };
        // Its words, moved by one.
        let moved = Stimulus {
            amplitude_ua: words(one.width_us, one.gap_us),
            width_us: one.frequency_tenths_pps,
            gap_us: one.recovery.into(),
            frequency_tenths_pps: 0,
            recovery: 0,
        };
        let mut demands = Guarded::new([Demand::Pulses(channel, one), Demand::Nothing]);
        demands.corrupt(|demands| *demands = [Demand::Nothing, Demand::Pulses(next, moved)]);
        assert!(demands.get().is_none(), "{channel} {next} {amplitude_ua}");
    }
}
