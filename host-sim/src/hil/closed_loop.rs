//! The loop of `vm loop` with the controller on a device, in lockstep: a tick of the plant is a
//! step of the device. Every bit is compared with the host's own controller.
//!
//! The device stays disarmed, so that none of its limits is in the way of a slow line.

use super::playback::{begin, report};
use crate::closed_loop::{
    AMPLITUDE, ELECTRODE, GREATEST_WIDTH, Kind, Motion, Patient, Score, Task, Trial, params,
};
use crate::hil::{Client, HilError, Line};
use firmware::link::{
    AngleReading, Answer, Commanded, ControlUpload, Electrode, Mode, Modulation, Report, Request,
    Target, Upload,
};
use vm_nostd::TimeStep;
use vm_nostd::control::{
    self, FesController, FesControllerParams, FesControllerState, JointError, Sensors,
};

/// Result of a closed loop.
#[derive(Clone, Copy, Debug)]
pub struct Looped {
    /// How well the device did on the patient.
    pub score: Score,
    /// Steps, all bits equal to the host's.
    pub steps: u32,
    /// Report of the device.
    pub report: Report,
}

/// Greatest width of a pulse and its amplitude, in the link's units.
const WIDTH_US: u16 = (GREATEST_WIDTH * 1e6) as u16;
const AMPLITUDE_UA: u32 = (AMPLITUDE * 1e6) as u32;

/// Uploads a task's controller, closes the loop over a patient (by number, of those that `vm loop`
/// scores), and compares every step's bits with the host's own controller in `f32`.
pub fn close<L: Line>(
    client: &mut Client<L>,
    task: Task,
    patient: u64,
    progress: &mut dyn FnMut(u32),
) -> Result<Looped, HilError> {
    begin(client, 1e-3)?;
    let settings = Kind::Model.untuned();
    let params = params(task, &settings);
    for place in 0..2 {
        let upload = muscle(&params, place);
        client.order(&Request::Upload { place, upload })?;
    }
    client.order(&Request::Control(Some(upload(&params))))?;
    let patient = Patient::scored(task, patient);
    let trial =
        Trial { task, patient: &patient, kind: Kind::Model, settings: &settings, tuning: false };
    let mut twin = Twin::new(&params)?;
    let mut steps = 0;
    let score = trial.run_by(
        |motion, measured| {
            let widths = step(client, &mut twin, steps, motion, measured)?;
            steps += 1;
            progress(steps);
            Ok::<_, HilError>(widths)
        },
        |_| (),
    )?;
    Ok(Looped { score, steps, report: report(client)? })
}

/// The host's own controller.
struct Twin {
    controller: FesController<f32, 2>,
    state: Option<FesControllerState<f32>>,
}

impl Twin {
    fn new(params: &FesControllerParams<2>) -> Result<Self, JointError> {
        let controller = FesController::build(params, TimeStep::MILLISECOND)?;
        Ok(Self { controller, state: None })
    }

    fn step(&mut self, target: Target, reading: &AngleReading) -> Commanded {
        let angle = reading.angle();
        let state = self.state.get_or_insert_with(|| self.controller.start(angle));
        let Target { angle: wanted, velocity, acceleration, torque } = target;
        let target = control::Target { angle: wanted, velocity, acceleration, torque };
        let command = self.controller.step(state, target, Sensors { angle, torque: 0.0 });
        Commanded {
            activations: command.activations,
            pulses: command.pulses.map(|pulse| (pulse.amplitude, pulse.width)),
            torque: command.torque,
            gain: command.gain,
            status: command.status.bits(),
            state: state.checksum(),
        }
    }
}

/// One step: the device's pulse widths, s.
fn step<L: Line>(
    client: &mut Client<L>,
    twin: &mut Twin,
    steps: u32,
    [angle, velocity, acceleration]: Motion,
    measured: f64,
) -> Result<[f64; 2], HilError> {
    let [angle, velocity, acceleration] = [angle, velocity, acceleration].map(|x| x as f32);
    let target = Target { angle, velocity, acceleration, torque: 0.0 };
    let reading = AngleReading {
        time_us: steps.wrapping_mul(1000),
        angle_urad: (measured * 1e6).round() as i32,
    };
    let Answer::Stepped(command) = client.ask(&Request::Step { target, reading })? else {
        return Err(HilError::OtherAnswer { request: "step" });
    };
    let expected = twin.step(target, &reading);
    if bits(&command) != bits(&expected) {
        let message = format!("step {steps}: the device has {command:?}, the host {expected:?}");
        return Err(HilError::Differs(message));
    }
    Ok([0, 1].map(|index| {
        // As the device: the greatest pulse that recruits nothing is left out.
        let width = f64::from(command.pulses[index].1) * 1e-6;
        if command.activations[index] <= 0.0 { 0.0 } else { width.min(GREATEST_WIDTH) }
    }))
}

fn bits(command: &Commanded) -> [u32; 10] {
    let Commanded { activations, pulses, torque, gain, status, state } = *command;
    let [a, b] = activations.map(f32::to_bits);
    let [c, d] = pulses.map(|(amplitude, width)| [amplitude.to_bits(), width.to_bits()]);
    [a, b, c[0], c[1], d[0], d[1], torque.to_bits(), gain.to_bits(), status.into(), state]
}

/// A muscle of the controller, with its electrode.
fn muscle(params: &FesControllerParams<2>, place: u8) -> Upload {
    Upload {
        mode: Mode::Fes,
        muscle: params.muscles[usize::from(place)],
        electrode: Some(Electrode {
            channel: place,
            curve: ELECTRODE,
            width_us: WIDTH_US,
            gap_us: 50,
            recovery: 1,
        }),
    }
}

fn upload(params: &FesControllerParams<2>) -> ControlUpload {
    ControlUpload {
        range: params.range,
        paths: params.paths,
        limb: params.limb,
        modulation: [Modulation::Width { amplitude_ua: AMPLITUDE_UA }; 2],
        stimulation_frequency: params.stimulation_frequency,
        cocontraction: params.cocontraction,
        feedback: params.feedback,
        expected_lag: params.expected_lag,
        lead_filter_time: params.lead_filter_time,
        fatigue: params.fatigue,
        least_fitness: params.least_fitness,
        gain: params.gain,
        torque: params.torque,
        sensor_period_us: 1000,
    }
}
