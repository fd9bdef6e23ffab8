//! The link: what a host can do to a device, and what nothing on the line can.

use firmware::link::{Answer, Electrode, Readings, Request, RowInputs, Upload, encode};
use firmware::safety::{Fault, NotArmed, State};
use firmware::{MUSCLES, Stimulus};
use stimulator_tests::client::{Client, ClientError};
use stimulator_tests::device::{InProcess, LIMITS};
use stimulator_tests::host::{ELECTRODE, Host, READINGS, STIMULUS, arm, booted, fes, report};
use vm_nostd::RecruitmentCurveParams;

#[test]
fn an_activation_becomes_pulses_once_somebody_has_armed() {
    let mut host = booted();
    let electrode = Electrode { channel: 2, ..ELECTRODE };
    let upload = Upload { electrode: Some(electrode), ..fes() };
    host.order(&Request::Upload { place: 1, upload }).expect("a muscle");
    host.order(&Request::Rest([None, Some(0.16)])).expect("a path");
    let rows = |first: u32, count: usize| {
        let inputs = RowInputs { activation: 0.5, path_length: 0.16, stimulation_frequency: 40.0 };
        let rows = std::iter::repeat_n([RowInputs::default(), inputs], count).collect();
        Request::Rows { first, rows }
    };
    // Not armed: the muscle is computed, and nothing flows.
    host.order(&rows(0, 8)).expect("room");
    (0..20).for_each(|_| host.line().tick());
    assert_eq!(host.line().flowed(), 0);
    arm(&mut host, Fault::Boot);
    for first in (8..1600).step_by(8) {
        while let Err(error) = host.order(&rows(first, 8)) {
            assert!(matches!(error, ClientError::Refused { no_room: true, .. }), "{error:?}");
        }
        // A sensor has noise.
        let path_um = Some(160_000 + i32::try_from(first / 8 % 2).expect("0 or 1"));
        host.order(&Request::Readings(Readings { path_um, ..READINGS })).expect("readings");
    }
    // As much as recruits one half: 8 mA for ever, 16 mA for a chronaxie; of 50 mA by 4095 counts.
    assert_eq!(host.line().flowed(), 16 * 4095 / 50);
    let electrodes = host.line().electrodes.borrow();
    assert_eq!(electrodes.channels, [false, false, electrodes.channels[2], false]);
    drop(electrodes);
    let mut last = None;
    while let Some(traced) = host.next_trace() {
        last = Some(traced);
    }
    let force = last.expect("traces").outputs[1].force;
    assert!((20.0..200.0).contains(&force), "{force} N");
    // A host that falls silent: off after a tenth of a second.
    (0..102).for_each(|_| host.line().tick());
    host.line().flowed();
    (0..1000).for_each(|_| host.line().tick());
    assert_eq!(host.line().flowed(), 0);
    assert_eq!(report(&mut host).state, State::Latched(Fault::Silence));
}

/// The core may sleep while the link is idle: not while the tick has its order, or an answer is on
/// its way.
#[test]
fn the_link_is_idle_when_everything_is_said() {
    let mut host = booted();
    host.line().drain();
    assert!(host.line().is_idle());
    let (session, sequence) = host.session();
    let frame = encode(session, sequence, &Request::Report).expect("a short one");
    host.send_raw(&frame);
    assert!(host.line().is_idle());
    // It arrives behind this tick, and the next one answers it.
    host.line().tick();
    assert!(!host.line().is_idle());
    host.line().tick();
    assert!(!host.line().is_idle());
    host.line().drain();
    assert!(host.line().is_idle());
}

#[test]
fn what_is_refused_is_named_and_changes_nothing() {
    let mut host = booted();
    let mut refused = |request: &Request| match host.ask(request) {
        Err(ClientError::Refused { reason, .. }) => reason,
        other => panic!("{request:?}: {other:?}"),
    };
    let mut upload = fes();
    upload.muscle.mass = -1.0;
    assert_eq!(
        refused(&Request::Upload { place: 0, upload }),
        "mass = -1: must be between 0.00001 and 30"
    );
    let mut upload = fes();
    upload.muscle.fibers[1].fiber_type.half_force_frequency = f64::NAN;
    assert_eq!(
        refused(&Request::Upload { place: 0, upload }),
        "fibers[1].half_force_frequency = NaN: must be between 0.5 and 200"
    );
    assert_eq!(refused(&Request::Upload { place: 2, upload: fes() }), "place = 2: must be 0 to 1");
    let electrode = Electrode { channel: 4, ..ELECTRODE };
    let with = |electrode| Request::Upload {
        place: 0,
        upload: Upload { electrode: Some(electrode), ..fes() },
    };
    assert_eq!(refused(&with(electrode)), "electrode.channel = 4: must be 0 to 3");
    assert_eq!(
        refused(&with(Electrode { recovery: 9, ..ELECTRODE })),
        "recovery = 9: must be 1 to 8"
    );
    assert_eq!(
        refused(&with(Electrode {
            curve: RecruitmentCurveParams { slope: 0.5, ..ELECTRODE.curve },
            ..ELECTRODE
        })),
        "slope = 0.5: must be between 1 and 10"
    );
    assert_eq!(refused(&Request::State { place: 0 }), "Empty");
    assert_eq!(refused(&Request::Arm), "NotAcknowledged");
    let rows = heapless::Vec::from_slice(&[[RowInputs::default(); MUSCLES]]).expect("room");
    assert_eq!(refused(&Request::Rows { first: 1, rows }), "first = 1: must be 0 to 0");
    host.order(&Request::Upload { place: 0, upload: fes() }).expect("a muscle");
    let rest = host.ask(&Request::Rest([Some(0.5), None]));
    let Err(ClientError::Refused { reason, .. }) = rest else { panic!("{rest:?}") };
    assert!(reason.starts_with("path_length = 0.5: must be between 0.0"), "{reason}");
    // A device that is armed keeps its muscles.
    arm(&mut host, Fault::Boot);
    for request in [Request::Upload { place: 0, upload: fes() }, Request::Rest([None; MUSCLES])] {
        let answer = host.ask(&request);
        assert!(
            matches!(&answer, Err(ClientError::Refused { reason, .. }) if reason == "Armed"),
            "{answer:?}"
        );
    }
    assert_eq!(report(&mut host).state, State::Armed);
    host.order(&Request::Stop).expect("a stop");
    assert_eq!(report(&mut host).state, State::Latched(Fault::Stopped));
}

#[test]
fn what_is_asked_of_supervision_is_answered_by_it() {
    let mut host = booted();
    let mut not_armed = |request: &Request| match host.ask(request) {
        Err(ClientError::Refused { reason, .. }) => reason,
        other => panic!("{request:?}: {other:?}"),
    };
    let other = format!("{:?}", NotArmed::OtherFault);
    assert_eq!(not_armed(&Request::Acknowledge(Fault::Supply)), other);
    host.order(&Request::Acknowledge(Fault::Boot)).expect("its name");
    // No sensor has said anything yet.
    let Err(ClientError::Refused { reason, .. }) = host.ask(&Request::Arm) else { panic!("armed") };
    assert_eq!(reason, format!("{:?}", NotArmed::StillThere(Fault::Supply)));
    arm(&mut host, Fault::Boot);
    // More than is allowed latches; the fault is named by whoever asks.
    let stimulus = Stimulus { amplitude_ua: LIMITS.amplitude_ua + 1, ..STIMULUS };
    host.order(&Request::Drive([Some(stimulus), None, None, None])).expect("taken");
    host.line().tick();
    assert_eq!(report(&mut host).state, State::Latched(Fault::Amplitude));
    assert_eq!(host.line().flowed(), 0);
}

/// What was asked for before a fault is not what whoever arms next asks for.
#[test]
fn nothing_that_was_asked_for_outlasts_a_fault() {
    let mut host = booted();
    arm(&mut host, Fault::Boot);
    host.order(&Request::Drive([Some(STIMULUS), None, None, None])).expect("taken");
    let keep = |host: &mut Host| {
        for index in 0..40 {
            let path_um = Some(160_000 + index % 2);
            host.order(&Request::Readings(Readings { path_um, ..READINGS })).expect("readings");
        }
        host.line().flowed()
    };
    assert!(keep(&mut host) > 0);
    host.order(&Request::Stop).expect("a stop");
    (0..3).for_each(|_| host.line().tick());
    host.line().flowed();
    assert_eq!(keep(&mut host), 0);
    arm(&mut host, Fault::Stopped);
    assert_eq!(keep(&mut host), 0, "a stimulus that nobody has asked for");
    // A stop between the two steps of arming counts, too.
    host.order(&Request::Stop).expect("a stop");
    host.order(&Request::Acknowledge(Fault::Stopped)).expect("its name");
    host.order(&Request::Stop).expect("a stop");
    assert!(host.order(&Request::Arm).is_err());
    assert_eq!(report(&mut host).state, State::Latched(Fault::Stopped));
}

/// A tick that is late while nothing is armed is no fault, and costs no row.
#[test]
fn a_late_tick_costs_no_row_while_nothing_is_armed() {
    let mut host = booted();
    host.order(&Request::Upload { place: 0, upload: fes() }).expect("a muscle");
    host.order(&Request::Rest([Some(0.16), None])).expect("a path");
    let rows = heapless::Vec::from_slice(&[[RowInputs::default(); MUSCLES]; 8]).expect("room");
    host.order(&Request::Rows { first: 0, rows }).expect("room");
    host.line().tick_late();
    (0..20).for_each(|_| host.line().tick());
    let report = report(&mut host);
    assert_eq!((report.rows, report.late, report.state), (8, 1, State::Latched(Fault::Boot)));
    let rows: Vec<u32> =
        std::iter::from_fn(|| host.next_trace()).map(|traced| traced.row).collect();
    assert_eq!(rows, [0, 1, 2, 3, 4, 5, 6, 7]);
    // Armed it is, and takes those with it that waited.
    arm(&mut host, Fault::Boot);
    let rows = heapless::Vec::from_slice(&[[RowInputs::default(); MUSCLES]; 8]).expect("room");
    host.order(&Request::Rows { first: 8, rows }).expect("room");
    host.line().tick_late();
    (0..20).for_each(|_| host.line().tick());
    let report = self::report(&mut host);
    assert_eq!((report.rows, report.late, report.state), (16, 2, State::Latched(Fault::Deadline)));
    let traced = std::iter::from_fn(|| host.next_trace()).count();
    assert!(traced < 8, "{traced} rows had their tick");
}

/// A host that keeps itself heard, and has nothing to say of its sensors.
#[test]
fn readings_that_are_old_are_none() {
    let mut host = booted();
    arm(&mut host, Fault::Boot);
    let before = report(&mut host).ticks;
    let keep = |host: &mut Host, until: u32| {
        loop {
            let report = report(host);
            if report.ticks - before >= until {
                return report.state;
            }
        }
    };
    assert_eq!(keep(&mut host, 180), State::Armed);
    assert_eq!(keep(&mut host, 210), State::Latched(Fault::SensorMissing));
    assert_eq!(report(&mut host).state, State::Latched(Fault::SensorMissing));
}

#[test]
fn muscles_outlast_a_loss_of_power() {
    let mut host = booted();
    host.order(&Request::Upload { place: 1, upload: fes() }).expect("a muscle");
    host.order(&Request::Rest([None; MUSCLES])).expect("rest");
    let Answer::State(before) = host.ask(&Request::State { place: 1 }).expect("words") else {
        panic!("no words")
    };
    let memory = host.into_line().into_memory();
    let mut host = Client::new(InProcess::boot(memory));
    let info = host.greet().expect("a greeting");
    assert_eq!(info.restored, 1);
    let Answer::State(after) = host.ask(&Request::State { place: 1 }).expect("words") else {
        panic!("no words")
    };
    assert_eq!(after, before);
    assert_eq!(report(&mut host).state, State::Latched(Fault::Boot));
}

/// A muscle at place 0 whose electrode is channel 0, armed, and rows that ask for pulses.
fn stimulated() -> Host {
    let mut host = booted();
    let upload = Upload { electrode: Some(ELECTRODE), ..fes() };
    host.order(&Request::Upload { place: 0, upload }).expect("a muscle");
    host.order(&Request::Rest([Some(0.16), None])).expect("a path");
    arm(&mut host, Fault::Boot);
    for first in (0..400).step_by(8) {
        let inputs = RowInputs { activation: 0.6, path_length: 0.16, stimulation_frequency: 40.0 };
        let rows = heapless::Vec::from_slice(&[[inputs, RowInputs::default()]; 8]).expect("room");
        let request = Request::Rows { first, rows };
        while let Err(error) = host.order(&request) {
            assert!(matches!(error, ClientError::Refused { no_room: true, .. }), "{error:?}");
        }
        read(&mut host, first / 8);
    }
    host
}

/// Readings of a sensor that has noise.
fn read(host: &mut Host, index: u32) {
    let path_um = Some(160_000 + i32::try_from(index % 2).expect("0 or 1"));
    host.order(&Request::Readings(Readings { path_um, ..READINGS })).expect("readings");
}

/// A host whose rows end, and that goes on reading its sensors.
#[test]
fn a_stimulus_does_not_outlive_the_rows_it_comes_from() {
    let mut host = stimulated();
    assert!(host.line().flowed() > 0);
    assert_eq!(report(&mut host).state, State::Armed);
    for index in 0..20 {
        read(&mut host, index);
        (0..5).for_each(|_| host.line().tick());
    }
    host.line().flowed();
    assert_eq!(report(&mut host).state, State::Latched(Fault::StaleRow));
    for index in 0..100 {
        read(&mut host, index);
        (0..5).for_each(|_| host.line().tick());
    }
    assert_eq!(host.line().flowed(), 0);
    // Armed again, what those rows asked for is not put out.
    arm(&mut host, Fault::StaleRow);
    (0..20).for_each(|_| host.line().tick());
    assert_eq!(host.line().flowed(), 0);
}

#[test]
fn a_drive_is_put_out_for_a_second_and_no_longer() {
    let mut host = booted();
    arm(&mut host, Fault::Boot);
    host.order(&Request::Drive([None, Some(STIMULUS), None, None])).expect("taken");
    let begun = report(&mut host).ticks;
    let mut index = 0;
    let ticks = loop {
        read(&mut host, index);
        index += 1;
        let report = report(&mut host);
        if report.state != State::Armed {
            assert_eq!(report.state, State::Latched(Fault::StaleDrive));
            break report.ticks - begun;
        }
    };
    assert!((990..1_010).contains(&ticks), "{ticks}");
    assert!(host.line().flowed() > 0);
    // Repeated, it goes on.
    arm(&mut host, Fault::StaleDrive);
    for index in 0..600 {
        host.order(&Request::Drive([None, Some(STIMULUS), None, None])).expect("taken");
        read(&mut host, index);
    }
    assert_eq!(report(&mut host).state, State::Armed);
}

/// A channel stimulates what one electrode, or what a drive, asks for.
#[test]
fn a_channel_has_one_electrode_and_no_drive_beside_it() {
    let mut host = booted();
    let upload = Upload { electrode: Some(ELECTRODE), ..fes() };
    let taken = |answer: Result<(), ClientError>| match answer {
        Err(ClientError::Refused { reason, .. }) => reason,
        other => panic!("{other:?}"),
    };
    host.order(&Request::Upload { place: 1, upload }).expect("a muscle");
    let reason = taken(host.order(&Request::Upload { place: 0, upload }));
    assert_eq!(reason, "ChannelTaken { channel: 0, place: 1 }");
    let reason = taken(host.order(&Request::Drive([Some(STIMULUS), None, None, None])));
    assert_eq!(reason, "ChannelTaken { channel: 0, place: 1 }");
    // Its own place may have it again, other channels may be driven, and it is free when it is
    // given up.
    host.order(&Request::Upload { place: 1, upload }).expect("the same muscle");
    host.order(&Request::Drive([None, Some(STIMULUS), None, None])).expect("a free channel");
    let elsewhere = Electrode { channel: 3, ..ELECTRODE };
    let upload = Upload { electrode: Some(elsewhere), ..upload };
    host.order(&Request::Upload { place: 1, upload }).expect("the same muscle elsewhere");
    host.order(&Request::Drive([Some(STIMULUS), None, None, None])).expect("a free channel");
    let upload = Upload { electrode: Some(ELECTRODE), ..upload };
    host.order(&Request::Upload { place: 0, upload }).expect("a free channel");
}
