//! For how long the last tick's permission holds when no other tick comes, at every length of a
//! tick.

use firmware::safety::{Fault, Requested, State};
use firmware::{Limits, Step, Stimulus};
use stimulator_tests::bench::{Bench, LIMITS, stimulus};

/// Shortest, usual and longest time between ticks, µs.
const TICKS_US: [u32; 3] = [500, 1000, 2000];

/// Short and long pulses, of periods that are no multiples of a tick.
fn stimuli() -> [Stimulus; 5] {
    let base = stimulus(5_000);
    [
        Stimulus { width_us: 20, frequency_tenths_pps: 997, ..base },
        Stimulus { width_us: 250, frequency_tenths_pps: 991, ..base },
        Stimulus { width_us: 481, gap_us: 187, frequency_tenths_pps: 983, ..base },
        Stimulus { width_us: 1000, recovery: 7, frequency_tenths_pps: 977, ..base },
        Stimulus { width_us: 1000, recovery: 8, gap_us: 200, frequency_tenths_pps: 970, ..base },
    ]
}

fn armed(tick_us: u32, stimulus: Stimulus) -> Bench {
    let limits = Limits { width_us: 1000, ..LIMITS };
    let mut bench = Bench::with(limits, tick_us, Fault::Boot);
    bench.inject(move |_, r, _| {
        *r = Requested { stimuli: [Some(stimulus), None, None, None], ..Requested::NOTHING };
    });
    bench.tick();
    bench.arm(Fault::Boot);
    bench
}

/// Whatever the pulse timer does when a tick hangs, at the beginning, in the middle or at the end
/// of a pulse.
#[test]
fn current_is_off_two_ticks_after_the_last_tick() {
    for tick_us in TICKS_US {
        let mut latest_us = 0;
        for stimulus in stimuli() {
            for ticks in 40..100 {
                let mut bench = armed(tick_us, stimulus);
                bench.flows(ticks);
                // The tick that runs last, and how long after it a current ends that flows then or
                // later.
                bench.control();
                let last_us = (bench.tick - 1) * tick_us;
                bench.hangs = true;
                let mut off_us = last_us;
                while bench.timer < last_us + 10 * tick_us {
                    if bench.flowing() > 0 {
                        off_us = bench.timer;
                    }
                    bench.run_out();
                }
                latest_us = latest_us.max(off_us - last_us);
            }
        }
        assert!(latest_us <= 2 * tick_us, "{latest_us} us after the last of ticks of {tick_us} us");
        // Two steps before that nothing is cut yet.
        assert!(latest_us > 2 * tick_us - 2 * Step::LONGEST_US, "{latest_us} us of {tick_us}");
    }
}

/// A tick that comes when the next step would outlast the last permission to the µs is not late; a
/// µs after that it is.
#[test]
fn a_permission_holds_to_the_microsecond() {
    for tick_us in TICKS_US {
        let after = |apart_us: u32| {
            let mut bench =
                armed(tick_us, Stimulus { frequency_tenths_pps: 10, ..stimulus(5_000) });
            // Between two pulses, where all steps are as long.
            bench.flows(20);
            // With a step, and so seen by it.
            let last_us = bench.timer;
            bench.control();
            while bench.timer < last_us + apart_us {
                bench.run_out();
            }
            bench.control();
            bench.flows(2);
            bench.controller.state()
        };
        let most_us = 2 * tick_us - Step::LONGEST_US;
        assert_eq!(after(most_us), State::Armed, "{most_us} us after a tick of {tick_us} us");
        assert_eq!(after(most_us + 1), State::Latched(Fault::Deadline), "ticks of {tick_us} us");
    }
}

/// Ticks whose permission comes now sooner and now later, by half a tick: none is missed for that.
#[test]
fn ticks_that_come_unevenly_are_no_fault() {
    for tick_us in TICKS_US {
        for stimulus in stimuli() {
            let mut bench = armed(tick_us, stimulus);
            let mut random = 1_u32;
            for _ in 0..2_000 {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let late_us = match random >> 30 {
                    0 => 0,
                    1 => tick_us / 2,
                    _ => (random >> 8) % (tick_us / 2),
                };
                let due_us = bench.tick * tick_us + late_us;
                while bench.timer < due_us {
                    bench.run_out();
                }
                bench.control();
                assert_eq!(bench.controller.state(), State::Armed, "{stimulus:?} at {tick_us} us");
            }
            assert!(!bench.put_out.is_empty());
        }
    }
}
