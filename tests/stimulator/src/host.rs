//! A host at the other end of a device's line, with common requests.

use crate::client::Client;
use crate::device::{InProcess, Memory};
use firmware::Stimulus;
use firmware::link::{Answer, Electrode, Mode, Readings, Report, Request, Upload};
use firmware::safety::{CHANNELS, Fault, State};
use vm_nostd::RecruitmentCurveParams;
use vm_nostd_cores::MUSCLE;

/// A host and its device.
pub type Host = Client<InProcess<Memory>>;

/// Readings with which nothing is wrong.
pub const READINGS: Readings =
    Readings { impedance_ohm: [Some(1000); CHANNELS], supply_mv: 3700, path_um: Some(160_000) };

/// A stimulus with which nothing is wrong.
pub const STIMULUS: Stimulus = Stimulus {
    amplitude_ua: 10_000,
    width_us: 200,
    gap_us: 40,
    frequency_tenths_pps: 400,
    recovery: 1,
};

/// An electrode with which nothing is wrong.
pub const ELECTRODE: Electrode = Electrode {
    channel: 0,
    curve: RecruitmentCurveParams {
        threshold: 4e-3,
        saturation: 12e-3,
        chronaxie: 200e-6,
        slope: 2.0,
    },
    width_us: 200,
    gap_us: 40,
    recovery: 1,
};

/// A device that has just booted, greeted.
pub fn booted() -> Host {
    let mut host = Client::new(InProcess::boot(Memory::new()));
    host.greet().expect("a greeting");
    host
}

/// Report of the device.
pub fn report(host: &mut Host) -> Report {
    match host.ask(&Request::Report).expect("an answer") {
        Answer::Report(report) => report,
        other => panic!("{other:?}"),
    }
}

/// The paper's muscle, without an electrode.
pub fn fes() -> Upload {
    Upload { mode: Mode::Fes, muscle: MUSCLE, electrode: None }
}

/// Names the fault and arms.
pub fn arm(host: &mut Host, fault: Fault) {
    host.order(&Request::Readings(READINGS)).expect("readings");
    host.order(&Request::Acknowledge(fault)).expect("its name");
    host.order(&Request::Arm).expect("nothing is wrong");
    assert_eq!(report(host).state, State::Armed);
}
