//! Every bit of what a checksum guards between the levels is in it.

use crate::between::guarded::{Guarded, Sum};
use crate::between::limits::Limits;
use crate::between::plan::{Plan, PlanQueue};
use crate::between::step::Step;
use crate::between::stimulus::{Scale, Stimulus};
use crate::between::waveform::Pulse;
use crate::config::SHORTEST_TICK_US;

const SCALE: Scale = Scale { full_scale_ua: 50_000, full_scale_counts: 4095 };
const STIMULUS: Stimulus = Stimulus {
    amplitude_ua: 10_000,
    width_us: 200,
    gap_us: 50,
    frequency_tenths_pps: 400,
    recovery: 3,
};

/// Whether the checksum of one value is not that of the other.
fn are_told_apart<T: Sum + Copy>(one: T, other: T) -> bool {
    let mut guarded = Guarded::new(one);
    guarded.corrupt(|value| *value = other);
    guarded.get().is_none()
}

#[test]
fn every_bit_of_a_stimulus_and_of_a_scale_is_in_its_checksum() {
    for bit in 0..32 {
        let (word, half, byte) = (1_u32 << bit, 1_u16 << (bit % 16), 1_u8 << (bit % 8));
        let changes: [&dyn Fn(&mut Stimulus); 5] = [
            &|stimulus| stimulus.amplitude_ua ^= word,
            &|stimulus| stimulus.width_us ^= half,
            &|stimulus| stimulus.gap_us ^= half,
            &|stimulus| stimulus.frequency_tenths_pps ^= half,
            &|stimulus| stimulus.recovery ^= byte,
        ];
        for (index, change) in changes.into_iter().enumerate() {
            let mut other = STIMULUS;
            change(&mut other);
            assert!(are_told_apart(STIMULUS, other), "field {index}, bit {bit}");
        }
        let (mut ua, mut counts) = (SCALE, SCALE);
        ua.full_scale_ua ^= word;
        counts.full_scale_counts ^= half;
        assert!(are_told_apart(SCALE, ua) && are_told_apart(SCALE, counts), "scale, bit {bit}");
    }
}

#[test]
fn every_field_of_a_plan_is_in_its_checksum() {
    let limits = Limits::SURFACE;
    let plan = |stimuli: [Option<Stimulus>; 2], limits: &Limits| {
        Plan::new(&stimuli, &SCALE, limits).expect("a legal command")
    };
    let one = plan([Some(STIMULUS), None], &limits);
    let stimuli = [
        Stimulus { amplitude_ua: 20_000, ..STIMULUS },
        Stimulus { width_us: 201, ..STIMULUS },
        Stimulus { gap_us: 51, ..STIMULUS },
        Stimulus { frequency_tenths_pps: 401, ..STIMULUS },
        Stimulus { recovery: 4, ..STIMULUS },
    ];
    for other in stimuli {
        assert!(are_told_apart(one, plan([Some(other), None], &limits)), "{other:?}");
    }
    for stimuli in [[None, Some(STIMULUS)], [Some(STIMULUS); 2], [None; 2]] {
        assert!(are_told_apart(one, plan(stimuli, &limits)), "{stimuli:?}");
    }
    for other in
        [Limits { rise_ua: 3_000, ..limits }, Limits { frequency_tenths_pps: 999, ..limits }]
    {
        assert!(are_told_apart(one, plan([Some(STIMULUS), None], &other)), "{other:?}");
    }
}

/// While the pulse timer puts out the longest step and the longest pulse, it reads no plan: one of
/// each tick waits. There is room for one more, for a timer that is late.
#[test]
fn as_many_plans_fit_as_can_wait() {
    let longest = Stimulus { width_us: 1000, gap_us: 200, recovery: 8, ..STIMULUS };
    let pulse = Pulse::new(&longest, &SCALE).expect("the longest pulse");
    let pulse_us: u32 = pulse.phases.iter().map(|phase| u32::from(phase.duration_us)).sum();
    let unread_us = pulse_us + Step::LONGEST_US;
    let ticks = |first_us: u32| (first_us..=unread_us).step_by(SHORTEST_TICK_US as usize).count();
    let waiting = (0..SHORTEST_TICK_US).map(ticks).max().expect("offsets");
    assert_eq!(PlanQueue::new().capacity(), waiting + 1);
}
