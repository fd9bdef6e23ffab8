//! Plays a trace of inputs to a muscle on a device.

use crate::engine::{self, Arithmetic, Class};
use crate::hil::{Client, HilError, Line};
use crate::model_muscle;
use crate::reference::{self, Muscle, Sample};
use crate::trace::InputTrace;
use firmware::TYPES;
use firmware::link::{Answer, MOST_ROWS, Mode, Report, Request, RowInputs, Traced, Upload};
use vm_nostd::{MuscleParams, Status};

/// Result of a playback.
#[derive(Clone, Debug)]
pub struct Played {
    /// Output of each row, bit-equal to the host's; the first is the muscle at rest.
    pub rows: Vec<engine::Row>,
    /// Final words of the state, equal to the host's.
    pub words: Vec<u32>,
    /// Report of the device after the playback.
    pub report: Report,
}

/// Uploads a muscle, plays a trace to it, and compares every bit with the host's own run in `f32`.
///
/// Stimulation stays disarmed.
pub fn play<L: Line>(
    client: &mut Client<L>,
    muscle: &Muscle,
    class: Class,
    mode: reference::Mode,
    trace: &InputTrace,
    progress: &mut dyn FnMut(usize),
) -> Result<Played, HilError> {
    let upload = upload(muscle, class, mode)?;
    begin(client, trace.time_step)?;
    client.order(&Request::Upload { place: 0, upload })?;
    let path = trace.inputs[0].path_length;
    client.order(&Request::Rest([Some(path as f32), None]))?;
    let arithmetic = Arithmetic::F32;
    let mut host =
        engine::at_rest_in_class(muscle, mode, arithmetic, class, trace.time_step, path)?;
    compare_words(client, host.as_ref(), "at rest")?;

    let inputs: Vec<[RowInputs; 2]> = trace.inputs[1..]
        .iter()
        .map(|input| {
            // Rounded as in the host's run.
            let first = RowInputs {
                activation: input.activation as f32,
                path_length: input.path_length as f32,
                stimulation_frequency: input.stimulation_frequency as f32,
            };
            [first, RowInputs::default()]
        })
        .collect();
    let mut rows = vec![host.row()];
    let mut sent = 0;
    while rows.len() <= inputs.len() {
        sent += send_some(client, sent, &inputs)?;
        while let Some(traced) = client.next_trace() {
            let row = rows.len() - 1;
            let expected = host.step(trace.inputs[row + 1])?;
            rows.push(compare(&traced, row, &expected)?);
        }
        progress(rows.len() - 1);
    }
    let words = compare_words(client, host.as_ref(), "at the end")?;
    Ok(Played { rows, words, report: report(client)? })
}

/// Begins a session; an error if the device has another tick.
pub(super) fn begin<L: Line>(client: &mut Client<L>, time_step: f64) -> Result<(), HilError> {
    let tick = f64::from(client.greet()?.tick_us) * 1e-6;
    if (tick - time_step).abs() > 1e-9 {
        let limit = format!("the device's tick is {tick} s");
        return Err(HilError::Unfit { what: "time step (s)", value: time_step.to_string(), limit });
    }
    Ok(())
}

/// The upload of a muscle.
pub fn upload(muscle: &Muscle, class: Class, mode: reference::Mode) -> Result<Upload, HilError> {
    let unfit = |what, value: String, limit: String| Err(HilError::Unfit { what, value, limit });
    if muscle.fibers.len() != TYPES {
        let limit = format!("the device's muscles have {TYPES}");
        return unfit("fibre types", muscle.fibers.len().to_string(), limit);
    }
    if muscle.fatigue.is_some() {
        return unfit("fatigue", "a table".to_owned(), "the device has no fatigue".to_owned());
    }
    let mode = match mode {
        reference::Mode::Continuous => Mode::Continuous,
        reference::Mode::Fes => Mode::Fes,
        other => {
            let limit = "the device has continuous and fes".to_owned();
            return unfit("mode", engine::mode_name(other).to_owned(), limit);
        }
    };
    let muscle = MuscleParams { class: class.of_model(), ..model_muscle::params(muscle) };
    Ok(Upload { mode, muscle, electrode: None })
}

/// Sends the next message of rows, or listens if the device has no room.
fn send_some<L: Line>(
    client: &mut Client<L>,
    sent: usize,
    inputs: &[[RowInputs; 2]],
) -> Result<usize, HilError> {
    let rows: heapless::Vec<[RowInputs; 2], MOST_ROWS> =
        inputs[sent..].iter().take(MOST_ROWS).copied().collect();
    if rows.is_empty() {
        client.listen()?;
        return Ok(0);
    }
    let count = rows.len();
    match client.order(&Request::Rows { first: sent as u32, rows }) {
        Ok(()) => Ok(count),
        Err(HilError::Refused { no_room: true, .. }) => Ok(0),
        Err(error) => Err(error),
    }
}

/// Checks that a row of the device is the next one and has the host's bits.
fn compare(traced: &Traced, row: usize, expected: &engine::Row) -> Result<engine::Row, HilError> {
    if traced.row as usize != row {
        return Err(HilError::Differs(format!("received row {}, expected {row}", traced.row)));
    }
    let output = traced.outputs[0];
    let sample = Sample {
        force: output.force.into(),
        fascicle_length: output.fascicle_length.into(),
        fascicle_velocity: output.fascicle_velocity.into(),
    };
    let got = (sample, Status::from_bits_retain(output.status));
    if bits(&got) == bits(expected) {
        Ok(got)
    } else {
        let message = format!("row {row}: the device has {got:?}, the host {expected:?}");
        Err(HilError::Differs(message))
    }
}

fn bits((sample, status): &engine::Row) -> [u64; 4] {
    let Sample { force, fascicle_length, fascicle_velocity } = sample;
    let status = status.bits().into();
    [force.to_bits(), fascicle_length.to_bits(), fascicle_velocity.to_bits(), status]
}

fn compare_words<L: Line>(
    client: &mut Client<L>,
    host: &dyn engine::Running,
    when: &str,
) -> Result<Vec<u32>, HilError> {
    let Answer::State(words) = client.ask(&Request::State { place: 0 })? else {
        return Err(HilError::OtherAnswer { request: "state" });
    };
    let mut expected = Vec::new();
    host.watch(&mut |word| expected.push(word));
    if words.iter().map(|&word| u64::from(word)).eq(expected.iter().copied()) {
        Ok(words.to_vec())
    } else {
        let message = format!("state {when}: the device has {words:x?}, the host {expected:x?}");
        Err(HilError::Differs(message))
    }
}

/// Report of a device.
pub(super) fn report<L: Line>(client: &mut Client<L>) -> Result<Report, HilError> {
    match client.ask(&Request::Report)? {
        Answer::Report(report) => Ok(report),
        _ => Err(HilError::OtherAnswer { request: "report" }),
    }
}
