//! A controlled elbow: its uploads, and a host that keeps its device supplied.

use crate::client::Client;
use crate::device::{InProcess, Memory};
use crate::host::{ELECTRODE, Host, READINGS, arm, report};
use firmware::Limits;
use firmware::link::{
    AngleReading, ControlUpload, Electrode, Mode, Modulation, Readings, Request, Target, Upload,
};
use firmware::safety::{Fault, State};
use vm_nostd::FatigueParams;
use vm_nostd::control::{ELBOW, GainParams, LimbParams, PiParams};

/// Channels of flexor and extensor.
pub const CHANNELS: [u8; 2] = [1, 2];
/// Amplitude of the flexor's pulses, µA, and the greatest of the extensor's.
pub const AMPLITUDE_UA: u32 = 30_000;

/// Biceps and triceps with electrodes.
pub fn muscles() -> [Upload; 2] {
    [0, 1].map(|index| Upload {
        mode: Mode::Fes,
        muscle: ELBOW.muscles[index].params(),
        electrode: Some(Electrode { channel: CHANNELS[index], ..ELECTRODE }),
    })
}

/// A controller of their elbow, with readings every 10 ms. The flexor's width is modulated, and the
/// extensor's amplitude.
pub fn control() -> ControlUpload {
    ControlUpload {
        range: ELBOW.range,
        paths: ELBOW.muscles.map(|muscle| muscle.path()),
        limb: LimbParams { inertia: 0.074, damping: 0.2, gravity: 2.83, hanging_angle: 0.0 },
        modulation: [
            Modulation::Width { amplitude_ua: AMPLITUDE_UA },
            Modulation::Amplitude { most_ua: AMPLITUDE_UA },
        ],
        stimulation_frequency: 40.0,
        cocontraction: 0.2,
        feedback: PiParams {
            proportional: 10.0,
            integral: 10.0,
            derivative: 0.5,
            derivative_filter: 0.02,
            most: 25.0,
        },
        expected_lag: 0.1,
        lead_filter_time: 0.025,
        fatigue: [Some(FatigueParams::QUADRICEPS); 2],
        least_fitness: 0.3,
        gain: Some(GainParams { time: 5.0, least: 0.3, most: 2.0, excitation: 0.3 }),
        torque: (-30.0, 30.0),
        sensor_period_us: 10_000,
    }
}

/// A target to hold, rad.
pub fn hold(angle: f32) -> Target {
    Target { angle, ..Target::default() }
}

/// What the host says while ticks pass.
pub struct Elbow {
    /// The host.
    pub host: Host,
    /// The angle that the sensor reads next, µrad; it has noise of 0.1 mrad besides.
    pub angle_urad: i32,
    /// The target that is repeated, if any.
    pub target: Option<Target>,
    /// Angles are read.
    pub reads: bool,
    /// What the sensor's clock is ahead of the device's, µs.
    pub ahead_us: u32,
    next_us: u32,
    count: u32,
}

/// Ticks from one target to the next, and from readings to readings.
const TARGETS: u32 = 2;
const READINGS_OF: u32 = 5;

impl Elbow {
    /// Uploaded, disarmed, with limits.
    pub fn with(limits: Limits) -> Self {
        let mut host = Client::new(InProcess::boot_with(Memory::new(), limits));
        host.greet().expect("a greeting");
        for (place, upload) in (0..).zip(muscles()) {
            host.order(&Request::Upload { place, upload }).expect("a muscle");
        }
        host.order(&Request::Control(Some(control()))).expect("a controller");
        Self {
            host,
            angle_urad: 1_000_000,
            target: None,
            reads: true,
            ahead_us: 77,
            next_us: 0,
            count: 0,
        }
    }

    /// Armed, told to hold an angle (rad).
    pub fn armed(limits: Limits, angle: f32) -> Self {
        let mut elbow = Self::with(limits);
        elbow.read();
        elbow.read();
        arm(&mut elbow.host, Fault::Boot);
        elbow.target = Some(hold(angle));
        elbow
    }

    /// A reading of the angle, 10 ms after the last.
    pub fn read(&mut self) {
        while self.host.line().ticks() * 1000 < self.next_us {
            self.host.line().tick();
        }
        self.next_us = self.host.line().ticks() * 1000 + 10_000;
        let reading = self.reading();
        self.host.order(&Request::Angle(reading)).expect("room");
    }

    /// The reading of now.
    pub fn reading(&mut self) -> AngleReading {
        self.count += 1;
        let noise = (self.count * 7 % 3) as i32 * 100 - 100;
        AngleReading {
            time_us: (self.host.line().ticks() * 1000).wrapping_add(self.ahead_us),
            angle_urad: self.angle_urad + noise,
        }
    }

    /// So many times 10 ms.
    pub fn pass(&mut self, times: u32) {
        for index in 0..times {
            if self.reads {
                self.read();
            } else {
                (0..10).for_each(|_| self.host.line().tick());
            }
            if index.is_multiple_of(TARGETS)
                && let Some(target) = self.target
            {
                self.host.order(&Request::Target(target)).expect("a target");
            }
            if index.is_multiple_of(READINGS_OF) {
                let path_um = Some(160_000 + (self.count % 2) as i32);
                self.host
                    .order(&Request::Readings(Readings { path_um, ..READINGS }))
                    .expect("told");
            }
        }
    }

    /// State of supervision.
    pub fn state(&mut self) -> State {
        report(&mut self.host).state
    }
}
