//! The closed loop in real time: what of the line it takes, and that a device follows it.

use firmware::link::{AngleReading, ControlUpload, Readings, Request, encode};
use firmware::safety::{Fault, State};
use std::io::{Read, Write};
use stimulator_tests::device::LIMITS;
use stimulator_tests::host::{READINGS, arm, report};
use stimulator_tests::joint::{Elbow, control, hold};

const README: &str = include_str!("../../../firmware/README.md");

/// Bytes that the line carries in a ms, each way.
const LINE: f64 = 460.8 / 10.0;

/// 1,000 angles, 50 targets and 10 readings a second, sent without waiting for answers: every
/// angle has its tick, and both ways of the line have room.
#[test]
fn a_thousand_angles_a_second_fit_the_line() {
    const TICKS: u32 = 5_000;
    let mut elbow = Elbow::with(LIMITS);
    let control = ControlUpload { sensor_period_us: 1_000, ..control() };
    elbow.host.order(&Request::Control(Some(control))).expect("a controller");
    elbow.read();
    arm(&mut elbow.host, Fault::Boot);
    let (session, mut sequence) = elbow.host.session();
    let (mut to_device, mut to_host) = (0, 0);
    let mut answers = [0; 4096];
    for tick in 0..TICKS {
        let time_us = elbow.host.line().ticks() * 1000 + elbow.ahead_us;
        let angle_urad = 1_000_000 + (tick % 5) as i32 * 100;
        let mut requests = vec![Request::Angle(AngleReading { time_us, angle_urad })];
        if tick % 20 == 0 {
            requests.push(Request::Target(hold(1.6)));
        }
        if tick % 100 == 0 {
            let path_um = Some(160_000 + (tick / 100 % 2) as i32);
            requests.push(Request::Readings(Readings { path_um, ..READINGS }));
        }
        for request in &requests {
            let frame = encode(session, sequence, request).expect("a frame");
            sequence = sequence.wrapping_add(1);
            to_device += frame.len();
            elbow.host.line().write_all(&frame).expect("a line");
        }
        elbow.host.line().tick();
        to_host += elbow.host.line().read(&mut answers).expect("answers");
    }
    let [down, up] = [to_device, to_host].map(|bytes| bytes as f64 / f64::from(TICKS));
    assert!(down < LINE && up < LINE, "{down} and {up} bytes in a ms");
    assert!(elbow.host.line().flowed() > 0);
    let (down, up) = ((100.0 * down / LINE).ceil(), (100.0 * up / LINE).ceil());
    let sentence = format!("{down} % of the line, their answers {up} %");
    assert!(README.contains(&sentence), "not in firmware/README.md: {sentence}");
    // The client that did not count along begins a session of its own, disarmed.
    elbow.host.line().tick();
    (0..200).for_each(|_| elbow.host.line().tick());
    elbow.host.greet().expect("a greeting");
    assert_eq!(report(&mut elbow.host).state, State::Latched(Fault::SensorMissing));
    assert_eq!(report(&mut elbow.host).frames.refused, 0);
}
