//! The stimulator's pulses, as a converter and pins see them: no net charge, one channel at a time,
//! nothing switched under current.

use embedded_hal_mock::eh1::digital::{Mock as PinMock, State, Transaction as PinTransaction};
use embedded_hal_mock::eh1::spi::{Mock as SpiMock, Transaction as SpiTransaction};
use firmware::{
    Bridge, Guarded, LEAST_PHASE_US, Limits, OutputError, OutputStage, Plan, Pulse, Schedule, Step,
    Stimulus, StimulusError,
};
use model_tests::muscles::config;
use proptest::prelude::*;
use stimulator_tests::electrodes::{CHANNELS, SCALE, Shared, Stage, stage};

/// Puts out a step, and lets its time pass.
fn pass(stage: &mut Stage, shared: &Shared, step: &Step) {
    shared.borrow_mut().words = 0;
    stage.apply(step).expect("an output that answers");
    let mut electrodes = shared.borrow_mut();
    let charge = i64::from(electrodes.counts) * i64::from(step.duration_us);
    if charge == 0 {
        return;
    }
    let on: Vec<usize> = (0..CHANNELS).filter(|&index| electrodes.channels[index]).collect();
    match (on.as_slice(), electrodes.cathodic, electrodes.anodic) {
        (&[channel], true, false) => electrodes.charges[channel] -= charge,
        (&[channel], false, true) => electrodes.charges[channel] += charge,
        other => electrodes.problems.push(format!("current with {other:?}")),
    }
}

/// Full amplitude from the first pulse on, and the most pulses that there can be.
const FASTEST: Limits =
    Limits { rise_ua: SCALE.full_scale_ua, frequency_tenths_pps: 5000, ..Limits::SURFACE };

/// A schedule whose channels are commanded one by one.
#[derive(Default)]
struct Commanded {
    schedule: Schedule<CHANNELS>,
    wanted: [Option<Stimulus>; CHANNELS],
}

impl Commanded {
    /// Refused, and then as it was before, if not all channels can do what they are told.
    fn set(&mut self, channel: usize, stimulus: Option<Stimulus>) -> Result<(), StimulusError> {
        let mut wanted = self.wanted;
        wanted[channel] = stimulus;
        let plan = Plan::new(&wanted, &SCALE, &FASTEST)?;
        self.schedule.follow(&Guarded::new(plan));
        self.wanted = wanted;
        Ok(())
    }

    fn advance(&mut self) -> Step {
        self.schedule.advance()
    }

    fn halt(&mut self) {
        self.schedule.halt();
    }
}

/// Every legal command.
fn stimuli() -> impl Strategy<Value = Stimulus> {
    let amplitude = prop_oneof![0..=SCALE.full_scale_ua, Just(SCALE.full_scale_ua), 0..100_u32];
    (amplitude, 20..=1000_u16, 40..=200_u16, 10..=5000_u16, 1..=8_u8)
        .prop_map(|(amplitude_ua, width_us, gap_us, frequency_tenths_pps, recovery)| Stimulus {
            amplitude_ua,
            width_us,
            gap_us,
            frequency_tenths_pps,
            recovery,
        })
        .prop_filter("fits its period", |stimulus| stimulus.validate(&SCALE).is_ok())
}

/// What would be measured of a pulse that were not balanced: what the anodic phase lacks is
/// negative.
#[test]
fn a_net_charge_is_measured_with_its_sign() {
    let stimulus = Stimulus {
        amplitude_ua: 10_000,
        width_us: 200,
        gap_us: 50,
        frequency_tenths_pps: 400,
        recovery: 2,
    };
    let balanced = Pulse::new(&stimulus, &SCALE).expect("a legal command");
    let mut pulse = balanced;
    // The recharge phase lasts for 400 us.
    pulse.phases[4].counts -= 3;
    assert_eq!(pulse.net_charge(), -1_200);
    let mut pulse = balanced;
    pulse.phases[1].duration_us -= 1;
    assert_eq!(pulse.net_charge(), i64::from(balanced.phases[1].counts));
}

proptest! {
    #![proptest_config(config(20_000))]

    #[test]
    fn a_pulse_has_no_net_charge_and_the_amplitude_that_was_commanded(stimulus in stimuli()) {
        let pulse = Pulse::new(&stimulus, &SCALE).expect("a legal command");
        prop_assert_eq!(pulse.net_charge(), 0);
        let ideal = f64::from(stimulus.amplitude_ua) * 4095.0 / 50_000.0;
        let short = ideal - f64::from(pulse.phases[1].counts);
        prop_assert!((0.0..f64::from(stimulus.recovery)).contains(&short), "{short} counts short");
        prop_assert_eq!(pulse.phases[1].duration_us, stimulus.width_us);
        let between: u16 = pulse.phases[2..4].iter().map(|phase| phase.duration_us).sum();
        prop_assert_eq!(between, stimulus.gap_us);
        // As the electrodes see it.
        let (mut stage, shared) = stage();
        for phase in pulse.phases {
            let duration_us = phase.duration_us.into();
            pass(&mut stage, &shared, &Step { output: Some((2, phase)), duration_us });
        }
        stage.neutral().expect("an output that answers");
        let electrodes = shared.borrow();
        prop_assert_eq!(electrodes.charges, [0; CHANNELS]);
        prop_assert!(electrodes.problems.is_empty(), "{:?}", electrodes.problems);
    }
}

/// Commands to channels at times (µs).
type Command = (u32, usize, Option<Stimulus>);

fn commands() -> impl Strategy<Value = Vec<Command>> {
    let stimulus = prop::option::weighted(0.9, stimuli());
    prop::collection::vec((0..1_000_000_u32, 0..CHANNELS, stimulus), 1..12).prop_map(|mut all| {
        all.sort_by_key(|command| command.0);
        all
    })
}

proptest! {
    #![proptest_config(config(400))]

    #[test]
    fn channels_take_turns_and_every_pulse_is_whole(commands in commands()) {
        let (mut stage, shared) = stage();
        let mut schedule = Commanded::default();
        let mut commands = commands.into_iter().peekable();
        let mut now = 0;
        while now < 1_200_000 {
            while let Some((_, channel, stimulus)) = commands.next_if(|next| next.0 <= now) {
                // Too much for one current source is refused; the rest goes on.
                if let Err(error) = schedule.set(channel, stimulus) {
                    prop_assert_eq!(error.field, "load: thousandths of the time");
                }
            }
            let step = schedule.advance();
            prop_assert!((LEAST_PHASE_US..=Step::LONGEST_US).contains(&step.duration_us), "{step:?}");
            pass(&mut stage, &shared, &step);
            now += step.duration_us;
            let electrodes = shared.borrow();
            prop_assert!(electrodes.problems.is_empty(), "{:?}", electrodes.problems);
            if step.output.is_none() {
                prop_assert_eq!(electrodes.charges, [0; CHANNELS], "between pulses, at {} us", now);
                prop_assert!(!electrodes.channels.contains(&true), "a channel left on");
            }
        }
    }

    /// Rhythms are kept: a pulse waits for at most one pulse of every other channel.
    #[test]
    fn pulses_come_when_they_are_due(stimuli in prop::array::uniform4(stimuli())) {
        // A phase with current is told from those without.
        let stimuli = stimuli
            .map(|stimulus| Stimulus { amplitude_ua: stimulus.amplitude_ua.max(1000), ..stimulus });
        let mut schedule = Commanded::default();
        let admitted: Vec<usize> = (0..CHANNELS)
            .filter(|&channel| schedule.set(channel, Some(stimuli[channel])).is_ok())
            .collect();
        let (mut now, mut pulses) = (0_u32, [0_u32; CHANNELS]);
        let (mut before, mut started) = (None, [None; CHANNELS]);
        while now < 1_000_000 {
            let step = schedule.advance();
            // A long phase comes in pieces.
            let begins = std::mem::replace(&mut before, step.output) != step.output;
            if let Some((channel, phase)) = step.output
                && begins
                && phase == Pulse::new(&stimuli[channel], &SCALE).expect("legal").phases[1]
            {
                let period = stimuli[channel].period_us();
                let others = admitted.iter().filter(|&&other| other != channel);
                let pulses_of_others: u32 = others.map(|&other| stimuli[other].duration_us()).sum();
                if let Some(before) = started[channel].replace(now) {
                    let apart = now - before;
                    let most = period + pulses_of_others + LEAST_PHASE_US;
                    prop_assert!((period / 2..=most).contains(&apart), "{apart} us, period {period}");
                }
                // Never more in all than the frequency says; the first begins with settling.
                prop_assert!(pulses[channel] * period + LEAST_PHASE_US <= now);
                pulses[channel] += 1;
            }
            now += step.duration_us;
        }
        prop_assert!(admitted.iter().all(|&channel| pulses[channel] > 0));
    }
}

/// A pulse of 10 mA on channel 1, word by word and pin by pin.
#[test]
fn one_pulse_is_these_words_and_levels() {
    let low = || PinTransaction::set(State::Low);
    let high = || PinTransaction::set(State::High);
    // 10 of 50 mA are 819 counts, 0x333.
    let word = |high: u8, low: u8| {
        [
            SpiTransaction::transaction_start(),
            SpiTransaction::write_vec(vec![high, low]),
            SpiTransaction::transaction_end(),
        ]
    };
    let nothing = || word(0x30, 0);
    // At the start; settling, current, gap, turning, current, settling; and nothing again.
    let words: Vec<_> = [
        nothing(),
        nothing(),
        word(0x33, 0x33),
        nothing(),
        nothing(),
        word(0x33, 0x33),
        nothing(),
        nothing(),
    ]
    .concat();
    let mut converter = SpiMock::new(&words);
    let mut cathodic = PinMock::new(&[low(), high(), low(), low()]);
    let mut anodic = PinMock::new(&[low(), low(), high(), low()]);
    let mut others = [0, 2, 3].map(|_| PinMock::new(&[low(), low(), low(), low()]));
    let mut used = PinMock::new(&[low(), high(), high(), low()]);
    let bridge = Bridge { cathodic: cathodic.clone(), anodic: anodic.clone() };
    let [a, b, c] = others.each_ref().map(Clone::clone);
    let mut stage =
        OutputStage::new(converter.clone(), bridge, [a, used.clone(), b, c]).expect("a stage");
    let stimulus = Stimulus {
        amplitude_ua: 10_000,
        width_us: 200,
        gap_us: 50,
        frequency_tenths_pps: 200,
        recovery: 1,
    };
    let pulse = Pulse::new(&stimulus, &SCALE).expect("a legal command");
    for phase in pulse.phases {
        let duration_us = phase.duration_us.into();
        stage.apply(&Step { output: Some((1, phase)), duration_us }).expect("an output");
    }
    // The first ends the pulse; another one has nothing to say.
    for _ in 0..2 {
        stage.apply(&Step { output: None, duration_us: 100 }).expect("an output");
    }
    converter.done();
    for pin in [&mut cathodic, &mut anodic, &mut used].into_iter().chain(&mut others) {
        pin.done();
    }
}

/// 10 mA.
const STIMULUS: Stimulus = Stimulus {
    amplitude_ua: 10_000,
    width_us: 200,
    gap_us: 40,
    frequency_tenths_pps: 200,
    recovery: 4,
};

#[test]
fn what_does_not_answer_leaves_the_rest_neutral() {
    let pulse = Pulse::new(&STIMULUS, &SCALE).expect("a legal command");
    let [settling, first, _, last, ..] =
        pulse.phases.map(|phase| Step { output: Some((0, phase)), duration_us: 1 });

    let (mut stage, shared) = stage();
    pass(&mut stage, &shared, &settling);
    pass(&mut stage, &shared, &first);
    shared.borrow_mut().words = 0;
    shared.borrow_mut().broken_converter = true;
    assert_eq!(stage.apply(&last), Err(OutputError::Converter));
    let electrodes = shared.borrow();
    assert!(!electrodes.cathodic && !electrodes.anodic && electrodes.channels == [false; CHANNELS]);
    drop(electrodes);

    let (mut stage, shared) = stimulator_tests::electrodes::stage();
    pass(&mut stage, &shared, &settling);
    pass(&mut stage, &shared, &first);
    shared.borrow_mut().words = 0;
    shared.borrow_mut().broken_pins = true;
    assert_eq!(stage.apply(&last), Err(OutputError::Pin));
    assert_eq!(shared.borrow().counts, 0, "no current through pins that do not switch");

    let (mut stage, shared) = stimulator_tests::electrodes::stage();
    pass(&mut stage, &shared, &settling);
    pass(&mut stage, &shared, &first);
    shared.borrow_mut().words = 0;
    let nowhere = Step { output: first.output.map(|(_, phase)| (CHANNELS, phase)), ..first };
    assert_eq!(stage.apply(&nowhere), Err(OutputError::Channel));
    assert_eq!(shared.borrow().counts, 0);
    assert_eq!(shared.borrow().channels, [false; CHANNELS]);
}

/// A phase that is not preceded by its settling is put out all the same, and nothing switches under
/// its current.
#[test]
fn a_phase_with_current_on_another_channel_switches_first() {
    let [_, phase, ..] = Pulse::new(&STIMULUS, &SCALE).expect("a legal command").phases;
    let (mut stage, shared) = stage();
    for channel in [0, 1] {
        stage.apply(&Step { output: Some((channel, phase)), duration_us: 1 }).expect("an output");
        let electrodes = shared.borrow();
        assert_eq!(electrodes.counts, phase.counts);
        assert!(electrodes.channels[channel] && electrodes.counts > 0);
        let late = "a current that does not begin or end with its step";
        assert!(electrodes.problems.iter().all(|problem| problem == late));
    }
}

#[test]
fn what_a_stimulator_cannot_do_is_named() {
    let good = Stimulus {
        amplitude_ua: 1000,
        width_us: 100,
        gap_us: 40,
        frequency_tenths_pps: 500,
        recovery: 2,
    };
    let refused = |stimulus: Stimulus| {
        let mut schedule = Commanded::default();
        schedule.set(0, Some(stimulus)).expect_err("refused").to_string()
    };
    for (stimulus, message) in [
        (Stimulus { amplitude_ua: 50_001, ..good }, "amplitude_ua = 50001: must be 0 to 50000"),
        (Stimulus { width_us: 19, ..good }, "width_us = 19: must be 20 to 1000"),
        (Stimulus { gap_us: 201, ..good }, "gap_us = 201: must be 40 to 200"),
        (Stimulus { gap_us: 39, ..good }, "gap_us = 39: must be 40 to 200"),
        (
            Stimulus { frequency_tenths_pps: 0, ..good },
            "frequency_tenths_pps = 0: must be 10 to 5000",
        ),
        (Stimulus { recovery: 0, ..good }, "recovery = 0: must be 1 to 8"),
        (
            Stimulus { width_us: 1000, frequency_tenths_pps: 5000, ..good },
            "duration_us = 3100: must be 0 to 2000",
        ),
    ] {
        assert_eq!(refused(stimulus), message);
    }
    let mut schedule = Commanded::default();
    // Two channels that would each take half of the time, and a bit.
    let busy = Stimulus { width_us: 1000, frequency_tenths_pps: 1600, ..good };
    schedule.set(0, Some(busy)).expect("one of them");
    let error = schedule.set(1, Some(busy)).expect_err("refused").to_string();
    assert_eq!(error, "load: thousandths of the time = 992: must be 0 to 900");
}

/// A channel that is switched off and on again all the time has no more pulses than its frequency.
#[test]
fn off_and_on_again_is_no_way_round_a_frequency() {
    let stimulus = Stimulus {
        amplitude_ua: 1000,
        width_us: 100,
        gap_us: 40,
        frequency_tenths_pps: 300,
        recovery: 1,
    };
    let first = Pulse::new(&stimulus, &SCALE).expect("a legal command").phases[1];
    let mut schedule = Commanded::default();
    let (mut now, mut pulses, mut switches) = (0_u32, 0, 0_u32);
    while now < 2_000_000 {
        if now >= switches * 1000 {
            let wanted = switches.is_multiple_of(2).then_some(stimulus);
            schedule.set(0, wanted).expect("a legal command");
            switches += 1;
        }
        let step = schedule.advance();
        pulses += u32::from(step.output == Some((0, first)));
        now += step.duration_us;
    }
    assert!((50..=61).contains(&pulses), "{pulses} pulses in 2 s at 30 pps");
    // After a long pause it begins once, and does not catch up.
    schedule.set(0, None).expect("off");
    (0..10_000).for_each(|_| {
        schedule.advance();
    });
    schedule.set(0, Some(stimulus)).expect("on");
    let started = (0..100).filter(|_| schedule.advance().output == Some((0, first))).count();
    assert_eq!(started, 1, "in 25 ms");
}

#[test]
fn halting_stops_at_once_and_forgets() {
    let stimulus = Stimulus {
        amplitude_ua: 50_000,
        width_us: 1000,
        gap_us: 40,
        frequency_tenths_pps: 300,
        recovery: 8,
    };
    let (mut stage, shared) = stage();
    let mut schedule = Commanded::default();
    schedule.set(3, Some(stimulus)).expect("a legal command");
    // Settling, and then the current.
    pass(&mut stage, &shared, &schedule.advance());
    pass(&mut stage, &shared, &schedule.advance());
    assert_eq!(shared.borrow().counts, 4088);
    schedule.halt();
    assert!(schedule.schedule.is_idle());
    for _ in 0..1000 {
        pass(&mut stage, &shared, &schedule.advance());
        assert_eq!(shared.borrow().counts, 0);
        assert_eq!(shared.borrow().channels, [false; CHANNELS]);
    }
}
