//! How many pulses a channel gives in a second, whatever other channels make it wait for.

use firmware::safety::{Fault, Requested, State};
use firmware::{Limits, Stimulus};
use stimulator_tests::bench::{Bench, stimulus};
use stimulator_tests::device::LIMITS as BOARD;

/// The most pulses of a channel in any second.
fn most_in_a_second(bench: &Bench, channel: usize) -> usize {
    let of = bench.put_out.iter().filter(|pulse| pulse.channel == channel);
    let times: Vec<u32> = of.map(|pulse| pulse.at_us).collect();
    let within = |begin: usize| {
        times[begin..].iter().take_while(|at| *at - times[begin] < 1_000_000).count()
    };
    (0..times.len()).map(within).max().unwrap_or(0)
}

/// Ticks of 1 ms, with that limit on the frequency, while a request is made of the number of each
/// tick.
fn run(
    most_tenths_pps: u16,
    ticks: u32,
    request: impl Fn(u32) -> [Option<Stimulus>; 4] + 'static,
) -> Bench {
    let limits = Limits { frequency_tenths_pps: most_tenths_pps, width_us: 1000, ..BOARD };
    let mut bench = Bench::with(limits, 1000, Fault::Boot);
    bench.inject(|_, r, _| *r = Requested::NOTHING);
    bench.tick();
    bench.arm(Fault::Boot);
    bench.inject(move |_, r, tick| {
        *r = Requested { stimuli: request(tick), ..Requested::NOTHING };
    });
    bench.flows(ticks);
    assert_eq!(bench.controller.state(), State::Armed);
    bench
}

/// A channel as fast as it may be, beside slower ones whose long pulses it waits for.
#[test]
fn no_second_has_more_pulses_than_the_limit_says_and_one() {
    let base = Stimulus { width_us: 50, gap_us: 40, ..stimulus(4_000) };
    let fast = move |frequency_tenths_pps| Some(Stimulus { frequency_tenths_pps, ..base });
    let long = move |frequency_tenths_pps, width_us, recovery| {
        Some(Stimulus { frequency_tenths_pps, width_us, recovery, ..base })
    };
    for most in [15, 99, 333, 995, 1000, 1001, 1006, 1009, 2999, 4988, 4999, 5000] {
        for (tenths_pps, width_us, recovery) in
            [(10, 1000, 8), (17, 1000, 8), (93, 700, 4), (303, 300, 2)]
        {
            let tenths_pps = tenths_pps.min(most);
            let other = long(tenths_pps, width_us, recovery);
            let bench = run(most, 6_000, move |_| [fast(most), other, long(10, 1000, 8), None]);
            let pulses = most_in_a_second(&bench, 0);
            let bound = usize::from(most / 10) + 1;
            assert!(
                pulses <= bound,
                "{pulses} pulses in a second, {most} tenths, {tenths_pps} {width_us}"
            );
            // And not many fewer, although it waits.
            assert!(
                pulses + 1 + bound / 20 >= bound,
                "{pulses} pulses, {most} tenths, {tenths_pps}"
            );
        }
    }
}

/// The same where its frequency changes as well, from one that is a little lower.
#[test]
fn a_change_of_frequency_makes_up_for_no_waiting() {
    let base = Stimulus { width_us: 50, gap_us: 40, ..stimulus(4_000) };
    let most = 1006;
    let mut greatest = 0;
    for lower in [500, 900, 999, 1000, 1005] {
        for change in 900..930 {
            let bench = run(most, 2_200, move |tick| {
                let frequency_tenths_pps = if tick < change { lower } else { most };
                let one = Stimulus { frequency_tenths_pps, ..base };
                let other =
                    Stimulus { frequency_tenths_pps: 11, width_us: 1000, recovery: 8, ..base };
                [Some(one), Some(other), None, None]
            });
            greatest = greatest.max(most_in_a_second(&bench, 0));
        }
    }
    assert_eq!(greatest, 101);
}
