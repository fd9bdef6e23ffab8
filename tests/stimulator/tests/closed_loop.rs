//! A joint's controller on the device: what its host can make of it, and how each loss ends.

use firmware::link::{
    AngleReading, Answer, ControlUpload, Info, Modulation, Readings, Request, RowInputs, Target,
    Upload,
};
use firmware::safety::{Fault, NotArmed, State};
use firmware::{Limits, MUSCLES};
use stimulator_tests::client::{Client, ClientError};
use stimulator_tests::device::{InProcess, LIMITS};
use stimulator_tests::host::{ELECTRODE, Host, READINGS, arm, booted, fes, report};
use stimulator_tests::joint::{AMPLITUDE_UA, CHANNELS, Elbow, control, hold, muscles};
use vm_nostd::TimeStep;
use vm_nostd::control::{
    self, FesController, FesControllerParams, Measured, Modulation as OfModel, Sensors,
};

#[test]
fn targets_and_angles_become_pulses_of_the_right_muscle() {
    // Without a target, a controller that is armed puts nothing out.
    let mut elbow = Elbow::armed(LIMITS, 1.0);
    elbow.target = None;
    elbow.pass(30);
    assert_eq!((elbow.state(), elbow.host.line().flowed()), (State::Armed, 0));
    // A joint at 1 rad that is to go to 1.6 rad is flexed.
    elbow.target = Some(hold(1.6));
    elbow.pass(60);
    let counts = elbow.host.line().flowed();
    assert_eq!(counts, (AMPLITUDE_UA * 4095 / 50_000) as u16, "the flexor's amplitude");
    let [flexor, extensor] = CHANNELS.map(usize::from);
    assert!(elbow.host.line().carried()[flexor]);
    // One that is to go to 0.3 rad is extended, and no longer flexed.
    elbow.target = Some(hold(0.3));
    elbow.pass(100);
    elbow.host.line().carried();
    elbow.pass(200);
    let carried = elbow.host.line().carried();
    assert!(carried[extensor] && !carried[0] && !carried[3], "{carried:?}");
    assert_eq!(elbow.state(), State::Armed);
}

/// How each loss of the loop is injected over the link, and the fault it must end in.
type Case = (Fault, fn(&mut Elbow));

/// Each of them while pulses flow: the fault is latched, no current flows after it, and it does not
/// go on by itself.
#[test]
fn every_loss_of_the_loop_ends_in_neutral() {
    let cases: [Case; 8] = [
        (Fault::SensorMissing, |elbow| elbow.reads = false),
        (Fault::StaleTarget, |elbow| elbow.target = None),
        // 10.1 degrees beyond the joint's range, without a jump.
        (Fault::SensorRange, |elbow| {
            for _ in 0..40 {
                elbow.angle_urad = (elbow.angle_urad - 45_000).max(-176_200);
                elbow.pass(1);
            }
        }),
        // 20 rad/s are 0.2 rad in 10 ms.
        (Fault::SensorJump, |elbow| elbow.angle_urad += 350_000),
        (Fault::SensorTime, |elbow| elbow.ahead_us += 40_000),
        (Fault::SensorTime, |elbow| elbow.ahead_us = elbow.ahead_us.wrapping_sub(9_000)),
        // A clock that is 2 % fast, which adds up.
        (Fault::SensorTime, |elbow| {
            for _ in 0..160 {
                elbow.ahead_us += 220;
                elbow.pass(1);
            }
        }),
        (Fault::Stopped, |elbow| elbow.host.order(&Request::Stop).expect("a stop")),
    ];
    for (fault, inject) in cases {
        let mut elbow = Elbow::armed(LIMITS, 1.6);
        elbow.pass(100);
        assert!(elbow.host.line().flowed() > 0, "{fault:?}");
        assert_eq!(elbow.state(), State::Armed, "{fault:?}");
        inject(&mut elbow);
        elbow.pass(12);
        assert_eq!(elbow.state(), State::Latched(fault));
        elbow.host.line().flowed();
        // Everything is well again, and the target is repeated: only arming lets current flow.
        (elbow.reads, elbow.angle_urad, elbow.target) = (true, 1_000_000, Some(hold(1.6)));
        elbow.pass(50);
        assert_eq!(elbow.host.line().flowed(), 0, "{fault:?}");
        assert_eq!(elbow.state(), State::Latched(fault));
        arm(&mut elbow.host, fault);
        elbow.pass(100);
        assert!(elbow.host.line().flowed() > 0, "{fault:?}");
        assert_eq!(elbow.state(), State::Armed, "{fault:?}");
    }
}

/// An angle that does not change at all while it stimulates.
#[test]
fn a_stuck_angle_ends_in_neutral() {
    let mut elbow = Elbow::armed(LIMITS, 1.6);
    elbow.pass(50);
    (0..10).for_each(|_| elbow.host.line().tick());
    let begun = elbow.host.line().ticks();
    loop {
        let AngleReading { time_us, .. } = elbow.reading();
        let reading = AngleReading { time_us, angle_urad: 1_000_000 };
        elbow.host.order(&Request::Angle(reading)).expect("room");
        elbow.host.order(&Request::Target(hold(1.6))).expect("a target");
        let path_um = Some(160_000 + (elbow.host.line().ticks() % 7) as i32);
        elbow.host.order(&Request::Readings(Readings { path_um, ..READINGS })).expect("told");
        (0..5).for_each(|_| elbow.host.line().tick());
        if elbow.state() != State::Armed {
            break;
        }
        assert!(elbow.host.line().ticks() - begun < 4_000);
    }
    assert_eq!(elbow.state(), State::Latched(Fault::SensorStuck));
    let ticks = elbow.host.line().ticks() - begun;
    assert!((1_990..2_100).contains(&ticks), "{ticks}");
}

/// Without readings of the angle nothing can be armed; without a controller none are needed.
#[test]
fn a_controller_without_its_sensor_cannot_be_armed() {
    let mut elbow = Elbow::with(LIMITS);
    elbow.host.order(&Request::Readings(READINGS)).expect("readings");
    elbow.host.order(&Request::Acknowledge(Fault::Boot)).expect("its name");
    let Err(ClientError::Refused { reason, .. }) = elbow.host.ask(&Request::Arm) else {
        panic!("armed")
    };
    assert_eq!(reason, format!("{:?}", NotArmed::StillThere(Fault::SensorMissing)));
    elbow.host.order(&Request::Control(None)).expect("no controller");
    arm(&mut elbow.host, Fault::Boot);
}

/// A target of before arming is not what whoever arms next wants, if it is too old.
#[test]
fn targets_expire_while_disarmed() {
    let mut elbow = Elbow::with(LIMITS);
    elbow.pass(2);
    elbow.host.order(&Request::Target(hold(1.6))).expect("a target");
    elbow.pass(15);
    arm(&mut elbow.host, Fault::Boot);
    elbow.pass(40);
    assert_eq!((elbow.state(), elbow.host.line().flowed()), (State::Armed, 0));
}

fn refused(host: &mut Host, request: &Request) -> String {
    match host.ask(request) {
        Err(ClientError::Refused { reason, .. }) => reason,
        other => panic!("{request:?}: {other:?}"),
    }
}

#[test]
fn targets_beyond_the_joint_are_refused_by_name() {
    let mut elbow = Elbow::armed(LIMITS, 1.0);
    elbow.pass(30);
    let good = hold(1.0);
    for (target, reason) in [
        (hold(-0.001), "target.angle = -0.0010000000474974513: must be between 0 and 2.44"),
        (hold(2.45), "target.angle = 2.450000047683716: must be between 0 and 2.44"),
        (hold(f32::NAN), "target.angle = NaN: must be between 0 and 2.44"),
        (Target { velocity: 101.0, ..good }, "target.velocity = 101: must be between -100 and 100"),
        (
            Target { acceleration: f32::INFINITY, ..good },
            "target.acceleration = inf: must be between -100 and 100",
        ),
        (Target { torque: -31.0, ..good }, "target.torque = -31: must be between -30 and 30"),
    ] {
        let got = refused(&mut elbow.host, &Request::Target(target));
        assert!(got.starts_with(reason), "{got}");
    }
    // They change nothing: what was wanted before is, until it is too old.
    elbow.pass(2);
    assert_eq!(elbow.state(), State::Armed);
    elbow.target = None;
    for _ in 0..12 {
        elbow.pass(1);
        refused(&mut elbow.host, &Request::Target(hold(9.0)));
    }
    assert_eq!(elbow.state(), State::Latched(Fault::StaleTarget));
}

#[test]
fn controllers_are_refused_by_name() {
    let mut host = booted();
    let upload =
        |host: &mut Host, control: ControlUpload| refused(host, &Request::Control(Some(control)));
    assert_eq!(refused(&mut host, &Request::Target(hold(1.0))), "NoController");
    assert_eq!(refused(&mut host, &Request::Angle(AngleReading::default())), "NoController");
    let step = Request::Step { target: hold(1.0), reading: AngleReading::default() };
    assert_eq!(refused(&mut host, &step), "NoController");
    assert_eq!(upload(&mut host, control()), "NotControllable { place: 0 }");
    let [flexor, extensor] = muscles();
    host.order(&Request::Upload { place: 0, upload: flexor }).expect("a muscle");
    assert_eq!(upload(&mut host, control()), "NotControllable { place: 1 }");
    let bare = Upload { electrode: None, ..extensor };
    host.order(&Request::Upload { place: 1, upload: bare }).expect("a muscle");
    assert_eq!(upload(&mut host, control()), "NotControllable { place: 1 }");
    host.order(&Request::Upload { place: 1, upload: extensor }).expect("a muscle");
    let changed = |change: fn(&mut ControlUpload)| {
        let mut control = control();
        change(&mut control);
        control
    };
    for (change, reason) in [
        (
            (|c| c.sensor_period_us = 999) as fn(&mut ControlUpload),
            "sensor_period_us = 999: must be 1000 to 10000",
        ),
        (|c| c.sensor_period_us = 10_001, "sensor_period_us = 10001: must be 1000 to 10000"),
        (
            |c| c.modulation[1] = Modulation::Amplitude { most_ua: 0 },
            "modulation.most_ua = 0: must be 1 to 500000",
        ),
        (
            |c| c.modulation[0] = Modulation::Width { amplitude_ua: 99 },
            "muscles[0].modulation.amplitude = 0.000099: must be between 0.0001 and 0.2",
        ),
        (|c| c.limb.inertia = -1.0, "limb.inertia = -1: must be between 0 and 10"),
        (|c| c.lead_filter_time = 1e-3, "muscles[0].lead.filter_time = 0.001: must be between"),
        (|c| c.feedback.integral = f64::NAN, "pi.integral = NaN: must be between 0 and 10000"),
    ] {
        let got = upload(&mut host, changed(change));
        assert!(got.starts_with(reason), "{got}");
    }
    assert_eq!(refused(&mut host, &Request::Target(hold(1.0))), "NoController");
    host.order(&Request::Control(Some(control()))).expect("a controller");
    // It has the electrodes.
    let rows = heapless::Vec::from_slice(&[[RowInputs::default(); MUSCLES]]).expect("room");
    assert_eq!(refused(&mut host, &Request::Rows { first: 0, rows }), "Controlled");
    // A muscle that is replaced takes its controller with it.
    host.order(&Request::Upload { place: 1, upload: extensor }).expect("a muscle");
    assert_eq!(refused(&mut host, &Request::Target(hold(1.0))), "NoController");
    let rows = heapless::Vec::from_slice(&[[RowInputs::default(); MUSCLES]]).expect("room");
    host.order(&Request::Rows { first: 0, rows }).expect("no controller");
}

#[test]
fn an_armed_device_keeps_its_controller() {
    let mut elbow = Elbow::armed(LIMITS, 1.0);
    let step = Request::Step { target: hold(1.0), reading: AngleReading::default() };
    for request in [Request::Control(None), Request::Control(Some(control())), step] {
        elbow.read();
        assert_eq!(refused(&mut elbow.host, &request), "Armed");
    }
    assert_eq!(elbow.state(), State::Armed);
}

/// Pulses stay within the electrode's width and the amplitude that was uploaded, whatever the
/// controller would need.
#[test]
fn commands_saturate_at_the_electrodes() {
    let mut elbow = Elbow::armed(Limits { stuck_ms: 60_000, ..LIMITS }, 2.4);
    // It never moves, and all of both muscles is asked for.
    for target in [2.4, 0.0] {
        elbow.target = Some(hold(target));
        for _ in 0..60 {
            elbow.pass(10);
            assert_eq!(elbow.state(), State::Armed);
        }
        let most = (AMPLITUDE_UA * 4095 / 50_000) as u16;
        let counts = elbow.host.line().flowed();
        assert!(counts <= most && counts > most / 2, "{counts} of {most}");
    }
}

/// Muscles and controller outlast a loss of power; nothing is stimulated then.
#[test]
fn a_controller_outlasts_a_loss_of_power() {
    let elbow = Elbow::with(LIMITS);
    let memory = elbow.host.into_line().into_memory();
    let mut host = Client::new(InProcess::boot(memory));
    let Info { restored, controlled, .. } = host.greet().expect("a greeting");
    assert_eq!((restored, controlled), (2, true));
    host.order(&Request::Target(hold(1.0))).expect("a controller");
    // Removed, it stays so.
    host.order(&Request::Control(None)).expect("none");
    let mut host = Client::new(InProcess::boot(host.into_line().into_memory()));
    let Info { restored, controlled, .. } = host.greet().expect("a greeting");
    assert_eq!((restored, controlled), (2, false));
    // So it is by another muscle.
    host.order(&Request::Control(Some(control()))).expect("a controller");
    host.order(&Request::Upload { place: 0, upload: fes() }).expect("a muscle");
    let mut host = Client::new(InProcess::boot(host.into_line().into_memory()));
    let Info { restored, controlled, .. } = host.greet().expect("a greeting");
    assert_eq!((restored, controlled), (2, false));
    assert_eq!(report(&mut host).state, State::Latched(Fault::Boot));
}

/// Step by step, the device's controller has the bits of the same one on the host.
#[test]
fn steps_have_the_hosts_bits() {
    let mut elbow = Elbow::with(LIMITS);
    let control = control();
    let params = FesControllerParams {
        range: control.range,
        muscles: muscles().map(|upload| upload.muscle),
        paths: control.paths,
        limb: control.limb,
        electrodes: [ELECTRODE.curve; 2],
        modulation: [
            OfModel::Width { amplitude: f64::from(AMPLITUDE_UA) * 1e-6 },
            OfModel::Amplitude { width: f64::from(ELECTRODE.width_us) * 1e-6 },
        ],
        stimulation_frequency: control.stimulation_frequency,
        cocontraction: control.cocontraction,
        measured: Measured::Angle,
        feedback: control.feedback,
        expected_lag: control.expected_lag,
        lead_filter_time: control.lead_filter_time,
        fatigue: control.fatigue,
        least_fitness: control.least_fitness,
        gain: control.gain,
        torque: control.torque,
    };
    let twin = FesController::<f32, 2>::build(&params, TimeStep::MILLISECOND).expect("a twin");
    for run in 0..2 {
        let mut state = None;
        for tick in 0..1_000_i32 {
            let time = tick as f32 * 1e-3;
            let target = Target {
                angle: 1.2 + 0.6 * (3.0 * time).sin(),
                velocity: 1.8 * (3.0 * time).cos(),
                acceleration: -5.4 * (3.0 * time).sin(),
                torque: 0.1,
            };
            let angle_urad = 1_200_000 + (500_000.0 * (3.0 * time - 0.3).sin()) as i32 + tick % 7;
            let reading = AngleReading { time_us: tick as u32 * 1000, angle_urad };
            let answer = elbow.host.ask(&Request::Step { target, reading });
            let Ok(Answer::Stepped(command)) = answer else { panic!("{answer:?}") };
            let angle = angle_urad as f32 * 1e-6;
            let state = state.get_or_insert_with(|| twin.start(angle));
            let Target { angle: wanted, velocity, acceleration, torque } = target;
            let target = control::Target { angle: wanted, velocity, acceleration, torque };
            let expected = twin.step(state, target, Sensors { angle, torque: 0.0 });
            let pulses = expected.pulses.map(|pulse| (pulse.amplitude, pulse.width));
            assert_eq!(command.activations, expected.activations, "{run} {tick}");
            assert_eq!(command.pulses, pulses, "{run} {tick}");
            assert_eq!((command.torque, command.gain), (expected.torque, expected.gain));
            assert_eq!((command.status, command.state), (expected.status.bits(), state.checksum()));
        }
        assert_eq!(elbow.host.line().flowed(), 0);
        // It begins anew with the upload, and with a stop.
        match run {
            0 => elbow.host.order(&Request::Control(Some(control))).expect("a controller"),
            _ => elbow.host.order(&Request::Stop).expect("a stop"),
        }
    }
}
