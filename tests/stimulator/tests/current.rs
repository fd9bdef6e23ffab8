//! Current that should not be there: what strangers found by driving the stimulator through its
//! public types.

use firmware::safety::{Fault, NotArmed, Observed, Requested, State};
use firmware::{Controller, LimitError, Limits, Permission, PlanQueue, Stimulus};
use model_tests::muscles::config;
use proptest::prelude::*;
use stimulator_tests::bench::{Bench, PutOut, stimulus};
use stimulator_tests::device::LIMITS as BOARD;
use stimulator_tests::electrodes::SCALE;

/// Steps of 50 mA by 4095 counts that 2 mA are.
const RISE: u16 = 163;

fn armed(limits: Limits, tick_us: u32) -> Bench {
    let mut bench = Bench::with(limits, tick_us, Fault::Boot);
    bench.inject(|_, r, _| *r = Requested::NOTHING);
    bench.tick();
    bench.arm(Fault::Boot);
    bench
}

/// One channel asks for a stimulus.
fn one(stimulus: Stimulus) -> Requested {
    Requested { stimuli: [Some(stimulus), None, None, None], ..Requested::NOTHING }
}

#[test]
fn an_amplitude_beyond_the_current_source_is_refused_in_the_first_tick() {
    let mut bench = armed(BOARD, 1000);
    bench.inject(|_, r, _| *r = one(stimulus(60_000)));
    assert!(!bench.flows(1));
    assert_eq!(bench.controller.state(), State::Latched(Fault::Amplitude));

    // And limits beyond it when the controller is built.
    let queue: &'static mut PlanQueue = Box::leak(Box::default());
    let permission: &'static Permission = Box::leak(Box::default());
    let (give, _) = queue.split();
    let error = Controller::new(Limits::SURFACE, 1000, Fault::Boot, SCALE, give, permission).err();
    let expected = LimitError { field: "amplitude_ua", value: 100_000, least: 1, most: 50_000 };
    assert_eq!(error, Some(expected));
}

/// Counts rise by no more than the limit from one pulse of a channel to the next; the last is how
/// many rose.
fn rises(put_out: &[PutOut]) -> usize {
    let (mut last, mut rose) = ([0; 4], 0);
    for pulse in put_out {
        let before = std::mem::replace(&mut last[pulse.channel], pulse.counts);
        assert!(pulse.counts <= before + RISE, "{} after {before} counts", pulse.counts);
        rose += usize::from(pulse.counts > before);
    }
    rose
}

#[test]
fn a_change_of_frequency_is_no_way_round_the_rise() {
    // One change from 1 to 50 pps, at any time of the period.
    for change in [10, 500, 990, 999] {
        let mut bench = armed(BOARD, 1000);
        bench.inject(move |_, r, tick| {
            let frequency_tenths_pps = if tick < change { 10 } else { 500 };
            *r = one(Stimulus { frequency_tenths_pps, ..stimulus(20_000) });
        });
        bench.flows(2000);
        assert!(rises(&bench.put_out) >= 10);
    }
    // A frequency of 1/(time left), which the schedule follows to its next pulse.
    let mut bench = armed(BOARD, 1000);
    bench.inject(|_, r, tick| {
        let left_ms = 1000 - (tick % 1000).min(990);
        let frequency_tenths_pps = (10_000 / left_ms) as u16;
        *r = one(Stimulus { frequency_tenths_pps, ..stimulus(20_000) });
    });
    bench.flows(20_000);
    assert!(rises(&bench.put_out) >= 10);
}

/// Requests that change at any time, to anything that is legal.
fn changes() -> impl Strategy<Value = Vec<(u32, Option<Stimulus>)>> {
    let legal =
        (0..=50_000_u32, 20..=500_u16, 40..=200_u16, 10..=1000_u16, 1..=8_u8).prop_map(|values| {
            let (amplitude_ua, width_us, gap_us, frequency_tenths_pps, recovery) = values;
            Stimulus { amplitude_ua, width_us, gap_us, frequency_tenths_pps, recovery }
        });
    let legal = legal.prop_filter("within the limits", |stimulus| {
        let charge = stimulus.amplitude_ua * u32::from(stimulus.width_us) / 1000;
        let on = 1e-7 * f64::from(stimulus.width_us) * f64::from(stimulus.frequency_tenths_pps);
        let rms = f64::from(stimulus.amplitude_ua) * (2.0 * on).sqrt();
        charge < 25_000 && rms < 20_000.0 && stimulus.duration_us() * 10 < 9 * stimulus.period_us()
    });
    prop::collection::vec((1..400_u32, prop::option::weighted(0.9, legal)), 1..12)
}

proptest! {
    #![proptest_config(config(300))]

    #[test]
    fn whatever_is_asked_for_rises_from_pulse_to_pulse(changes in changes()) {
        let mut bench = armed(BOARD, 1000);
        for (ticks, stimulus) in changes {
            bench.inject(move |_, r, _| {
                *r = Requested { stimuli: [stimulus, None, None, None], ..Requested::NOTHING };
            });
            bench.flows(ticks);
        }
        prop_assert_eq!(bench.controller.state(), State::Armed);
        rises(&bench.put_out);
    }

    /// Every legal command fits into the queue of plans, however long a pulse takes and short a
    /// tick is.
    #[test]
    fn plans_that_change_every_tick_are_no_fault(
        tick_us in 500..=2000_u32,
        width_us in 20..=1000_u16,
        recovery in 1..=8_u8,
        gap_us in 40..=200_u16,
    ) {
        let limits = Limits { width_us: 1000, ..Limits::SURFACE }.within_scale(&SCALE);
        let mut bench = armed(limits, tick_us);
        bench.inject(move |_, r, tick| {
            let amplitude_ua = 10_000 + 100 * (tick % 2);
            let frequency_tenths_pps = 100;
            *r = one(Stimulus { amplitude_ua, width_us, gap_us, frequency_tenths_pps, recovery });
        });
        bench.flows(1000);
        prop_assert_eq!(bench.controller.state(), State::Armed);
    }
}

#[test]
fn the_longest_pulse_at_the_shortest_tick_leaves_room_for_plans() {
    let limits = Limits { width_us: 1000, ..Limits::SURFACE }.within_scale(&SCALE);
    let mut bench = armed(limits, 500);
    bench.inject(move |_, r, tick| {
        *r = one(Stimulus {
            amplitude_ua: 10_000 + 100 * (tick % 2),
            width_us: 1000,
            gap_us: 200,
            frequency_tenths_pps: 900,
            recovery: 8,
        });
    });
    bench.flows(4000);
    assert_eq!(bench.controller.state(), State::Armed);
}

/// Stop, acknowledge, arm and drive in turn.
#[test]
fn stopping_and_arming_again_is_no_way_round_frequency_or_session() {
    for cycle in [3, 7, 9, 11, 23, 50] {
        let limits = Limits { session_ms: 3_000, rest_ms: 1_000, ..BOARD };
        let limits = Limits { stuck_ms: 2_000, ..limits };
        let mut bench = armed(limits, 1000);
        bench.inject(|_, r, _| {
            *r = one(Stimulus { frequency_tenths_pps: 1000, ..stimulus(20_000) });
        });
        let mut armed_ticks = 0;
        for tick in 0..20_000 {
            if tick % cycle == cycle - 1 {
                bench.controller.fail(Fault::Stopped);
                bench.pulses.attend();
                let _maybe_another = bench.controller.acknowledge(Fault::Stopped);
                let _session_is_over = bench.controller.arm();
            }
            bench.tick();
            armed_ticks += u32::from(bench.armed);
        }
        let times: Vec<u32> = bench.put_out.iter().map(|pulse| pulse.at_us).collect();
        for (index, begin) in times.iter().enumerate() {
            let within = times[index..].iter().take_while(|at| *at - begin < 1_000_000).count();
            assert!(within <= 101, "{within} pulses of 100 in a second, cycles of {cycle} ms");
        }
        assert!(armed_ticks <= 3_000, "{armed_ticks} ms of a session of 3 s");
        assert!(armed_ticks > 2_000 && times.len() > 200, "{} pulses", times.len());
    }
}

/// A rest begins where the next pulse would have come: off between two pulses of a slow train is
/// none.
#[test]
fn stopping_between_two_pulses_is_no_rest() {
    let limits = Limits { session_ms: 2_900, rest_ms: 300, stuck_ms: 2_900, ..BOARD };
    let mut bench = armed(limits, 1000);
    bench.inject(|_, r, _| *r = one(Stimulus { frequency_tenths_pps: 10, ..stimulus(20_000) }));
    for tick in 0..20_000 {
        // Off for 600 of every 1,000 ms, which begin after the pulse.
        match tick % 1000 {
            200 => bench.controller.fail(Fault::Stopped),
            800 => {
                let _maybe_another = bench.controller.acknowledge(Fault::Stopped);
                let _session_is_over = bench.controller.arm();
            }
            _ => (),
        }
        bench.tick();
    }
    assert!(bench.put_out.len() > 3, "{} pulses", bench.put_out.len());
    // 0.4 s of each counts.
    let last_ms = bench.put_out.last().expect("pulses").at_us / 1000;
    assert!(last_ms < 9_000, "pulses for {last_ms} ms");
}

#[test]
fn a_session_that_is_over_needs_a_rest() {
    let mut bench = Bench::running();
    bench.flows(4_002);
    assert_eq!(bench.controller.state(), State::Latched(Fault::Session));
    bench.controller.acknowledge(Fault::Session).expect("its name");
    bench.tick();
    let still = Err(NotArmed::StillThere(Fault::Session));
    // 600 ms without stimulation, from when the next pulse would have come after 25 ms.
    for _ in 0..620 {
        assert_eq!(bench.controller.arm(), still);
        bench.tick();
    }
    bench.flows(8);
    assert_eq!(bench.controller.arm(), Ok(()));
    // Half of a rest is none.
    bench.flows(3_000);
    bench.controller.fail(Fault::Stopped);
    bench.flows(500);
    bench.arm(Fault::Stopped);
    bench.flows(2_100);
    assert_eq!(bench.controller.state(), State::Latched(Fault::Session));
}

/// A sensor that is stuck is not made to work by arming again.
#[test]
fn stopping_and_arming_again_is_no_way_round_a_stuck_sensor() {
    let mut bench = Bench::running();
    bench.inject(|o, _, _| o.path_um = Some(160_001));
    let begun = bench.tick;
    while bench.controller.state() == State::Armed && bench.tick < begun + 4_000 {
        bench.tick();
        if bench.tick % 500 == 499 && bench.controller.state() == State::Armed {
            bench.controller.fail(Fault::Stopped);
            bench.tick();
            bench.arm(Fault::Stopped);
        }
    }
    assert_eq!(bench.controller.state(), State::Latched(Fault::SensorStuck));
    let ticks = bench.tick - begun;
    assert!((2_000..2_020).contains(&ticks), "{ticks}");
}

/// A row, or a drive, whose age is its limit is put out; a µs older it is not.
#[test]
fn requests_are_put_out_until_they_are_as_old_as_they_may_be() {
    let until = |fault, age: fn(&mut Requested, u64), most: u64| {
        let mut bench = Bench::running();
        bench.inject(move |_, r, _| age(r, most));
        bench.flows(10);
        assert_eq!(bench.controller.state(), State::Armed);
        bench.inject(move |_, r, _| age(r, most + 1));
        assert!(!bench.flows(1));
        assert_eq!(bench.controller.state(), State::Latched(fault));
    };
    until(Fault::StaleRow, |r, age| r.row_age_us = age, 50_000);
    until(Fault::StaleDrive, |r, age| r.drive_age_us = age, 1_000_000);
}

/// Whenever the tick stops calling: no phase begins that is switched off by the interrupt that
/// begins it. What the converter is told after its first word is a problem that the bench looks
/// for.
#[test]
fn a_permission_that_runs_out_begins_no_phase() {
    for width_us in [20, 40, 100, 250, 480] {
        for after_us in (0..30_000).step_by(110) {
            let mut bench = armed(BOARD, 1000);
            bench.inject(move |_: &mut Observed, r: &mut Requested, _| {
                *r = one(Stimulus { width_us, frequency_tenths_pps: 1000, ..stimulus(20_000) });
            });
            bench.flows(20);
            while bench.timer < 20_000 + after_us {
                if bench.timer >= bench.tick * 1000 {
                    bench.control();
                }
                bench.run_out();
            }
            bench.hangs = true;
            bench.flows(5);
            assert_eq!(bench.flowing(), 0, "width {width_us} at {after_us}");
        }
    }
}

/// Pulses are rounded to eight counts where the recharge phase is eight times weaker.
#[test]
fn the_least_rise_that_limits_allow_still_rises() {
    let limits = Limits { rise_ua: 98, ..BOARD };
    assert_eq!(limits.validate(1000, &SCALE), Ok(()));
    let mut bench = armed(limits, 1000);
    bench.inject(|_, r, _| {
        *r = one(Stimulus { recovery: 8, frequency_tenths_pps: 1000, ..stimulus(1_000) });
    });
    bench.flows(2_000);
    let last = bench.put_out.last().expect("pulses").counts;
    assert_eq!(last, 80, "1 mA, in steps of 8 counts");
}

/// Ticks that ask for nothing within a pulse train are no rest, and do not make a stuck sensor
/// work.
#[test]
fn asking_for_nothing_between_pulses_is_no_way_round_the_session() {
    let limits = Limits { session_ms: 3_000, rest_ms: 10_000, stuck_ms: 2_000, ..BOARD };
    let trains = |limits, stuck| {
        let mut bench = armed(limits, 1000);
        bench.inject(move |o: &mut Observed, r, tick| {
            o.path_um = Some(160_000 + if stuck { 0 } else { (tick % 2) as i32 });
            let amplitude_ua = if tick % 10 == 0 { 40_000 } else { 0 };
            *r = one(Stimulus { frequency_tenths_pps: 1000, ..stimulus(amplitude_ua) });
        });
        bench.flows(20_000);
        let last = bench.put_out.last().expect("pulses").at_us / 1000;
        (bench.controller.state(), last)
    };
    let (state, last) = trains(limits, false);
    assert_eq!(state, State::Latched(Fault::Session));
    assert!((2_900..3_020).contains(&last), "{last} ms");
    let (state, last) = trains(limits, true);
    assert_eq!(state, State::Latched(Fault::SensorStuck));
    assert!((1_900..2_020).contains(&last), "{last} ms");
}

/// Strong and rare pulses do not take the places of weak and frequent ones.
#[test]
fn requests_that_change_are_no_way_round_the_root_mean_square() {
    let limits = Limits { rms_ua: 3_000, ..BOARD };
    for (strong, period) in [(90, 10), (70, 11), (50, 11), (90, 11), (10, 13)] {
        let mut bench = armed(limits, 1000);
        let mut random = 1_u32;
        bench.inject(move |_, r, tick| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let by_chance = (random >> 16) % 100 < strong;
            let wanted = if tick < 4_000 { by_chance } else { tick % period != 0 };
            *r = one(if wanted {
                Stimulus { frequency_tenths_pps: 140, ..stimulus(40_000) }
            } else {
                Stimulus { frequency_tenths_pps: 1000, ..stimulus(14_000) }
            });
        });
        bench.flows(8_000);
        assert_eq!(bench.controller.state(), State::Armed);
        for begin_us in [1_000_000, 2_000_000, 4_500_000, 6_000_000] {
            let square: f64 = bench
                .put_out
                .iter()
                .filter(|pulse| (begin_us..begin_us + 2_000_000).contains(&pulse.at_us))
                .map(|pulse| (f64::from(pulse.counts) * 50_000.0 / 4095.0).powi(2) * 400e-6)
                .sum();
            let rms = (square / 2.0).sqrt();
            assert!((500.0..3_050.0).contains(&rms), "{rms} uA, {strong} % and every {period}");
        }
    }
}

/// Whoever stops and arms again after every stimulating phase leaves no charge on the electrodes.
#[test]
fn a_pulse_that_was_cut_short_is_discharged_before_another_begins() {
    let limits = Limits { width_us: 1000, ..Limits::SURFACE }.within_scale(&SCALE);
    let mut bench = armed(limits, 1000);
    bench.inject(|_, r, _| {
        *r = one(Stimulus { width_us: 1000, frequency_tenths_pps: 1000, ..stimulus(20_000) });
    });
    let mut cut: Option<u32> = None;
    let mut cuts = 0;
    while bench.tick < 2_000 {
        if bench.timer >= bench.tick * 1000 {
            bench.control();
        }
        let flowed = bench.flowing() > 0;
        bench.run_out();
        let electrodes = bench.electrodes.borrow();
        let connected = !electrodes.cathodic && !electrodes.anodic && electrodes.channels[0];
        drop(electrodes);
        if let Some(at_us) = cut
            && bench.timer < at_us + 19_000
        {
            assert!(connected, "{} us after the cut", bench.timer - at_us);
        }
        if flowed && bench.electrodes.borrow().cathodic {
            cut = Some(bench.timer);
            cuts += 1;
            bench.electrodes.borrow_mut().words = 0;
            bench.controller.fail(Fault::Stopped);
            bench.pulses.attend();
            bench.controller.acknowledge(Fault::Stopped).expect("its name");
            bench.controller.arm().expect("nothing is wrong");
        }
    }
    assert!(cuts > 20, "{cuts} cuts");
}
