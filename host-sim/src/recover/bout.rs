//! A bout: the inputs of one recording of a protocol.

use crate::fit::Role;
use crate::muscle_file::NamedMuscle;
use crate::reference::{Input, Mode, Muscle};
use crate::trace::InputTrace;
use vm_nostd::{ParameterError, Pulse, RecruitmentCurve, RecruitmentCurveParams};

/// Pairs of time (s) and value from that time on.
pub type Steps = Vec<(f64, f64)>;

/// A recording that starts at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Bout {
    /// Name, also of its files.
    pub name: &'static str,
    /// Role.
    pub role: Role,
    /// Duration, s.
    pub seconds: f64,
    /// Activation (natural) or amplitude of the stimulus over [`Setting::full_ma`]; 0 to 1.
    pub level: Steps,
    /// Pulse width, µs.
    pub width_us: Steps,
    /// Stimulation frequency, pps; 0 in natural recruitment.
    pub pps: Steps,
    /// Path beyond the neutral one, L_ce0: linear between these times (s), held before and after.
    pub path: Vec<(f64, f64)>,
}

/// Default pulse width, µs.
pub const WIDTH_US: f64 = 300.0;
/// Amplitude at level 1 over the saturation of the mean muscle, so that it saturates all patients.
const SATURATION: f64 = 1.6;
/// Time step of the inputs, s.
pub const TICK: f64 = 1e-3;

/// Scales of a protocol, from the expected muscle.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Path at which the fascicles are at L_ce0 with the tendon at F0, m.
    pub neutral: f64,
    /// L_ce0, m.
    pub fascicle: f64,
    /// Amplitude at level 1, mA; `None` without a recruitment curve: the level is the activation.
    pub full_ma: Option<f64>,
}

impl Setting {
    /// The scales for a muscle and a mode.
    pub fn of(named: &NamedMuscle, mode: Mode) -> Self {
        let Muscle { L_ce0: fascicle, L_se0: tendon, .. } = named.muscle;
        let curve = named.curve.filter(|_| mode == Mode::Fes);
        let full = curve.map(|curve| {
            let share = WIDTH_US / (WIDTH_US + curve.chronaxie * 1e6);
            (SATURATION * curve.saturation * 1e3 / share).round()
        });
        Self { neutral: fascicle + tendon, fascicle, full_ma: full }
    }

    /// Path (m) of a bout at a time.
    pub fn path(&self, bout: &Bout, time: f64) -> f64 {
        self.neutral + self.fascicle * between(&bout.path, time)
    }
}

impl Bout {
    /// Input file for `vm run` and `vm hil`.
    pub fn file_name(&self) -> String {
        format!("{}.csv", self.name)
    }

    /// Time with activation or stimulation, s.
    pub fn driven(&self) -> f64 {
        let ends = self.level.iter().skip(1).map(|step| step.0).chain([self.seconds]);
        let lasts = self.level.iter().zip(ends).map(|(step, end)| (step.1, end - step.0));
        lasts.filter(|(level, _)| *level > 0.0).map(|(_, lasts)| lasts).sum()
    }

    /// Inputs per tick of a muscle with a recruitment curve, on a path longer by `offset` (m).
    pub fn inputs(
        &self,
        setting: &Setting,
        curve: Option<&RecruitmentCurveParams>,
        offset: f64,
    ) -> Result<InputTrace, ParameterError> {
        let curve = curve.map(RecruitmentCurve::<f64>::build).transpose()?;
        let input = |tick: usize| {
            let end = tick as f64 * TICK;
            // Constant during the tick.
            let middle = end - 0.5 * TICK;
            let level = at(&self.level, middle);
            let activation = match (&curve, setting.full_ma) {
                (Some(curve), Some(full)) => {
                    let width = at(&self.width_us, middle);
                    curve.activation(Pulse { amplitude: level * full, width }).0
                }
                _ => level,
            };
            Input {
                activation,
                path_length: setting.path(self, end) + offset,
                stimulation_frequency: at(&self.pps, middle),
            }
        };
        let ticks = (self.seconds / TICK).round() as usize;
        let mut inputs: Vec<Input> = (0..=ticks).map(input).collect();
        inputs[0].activation = 0.0;
        Ok(InputTrace { start: 0.0, time_step: TICK, inputs })
    }
}

/// Value of steps at a time; the first value also applies before.
fn at(steps: &Steps, time: f64) -> f64 {
    let after = steps.partition_point(|step| step.0 <= time);
    steps[after.saturating_sub(1)].1
}

/// Linear interpolation.
fn between(points: &[(f64, f64)], time: f64) -> f64 {
    let after = points.partition_point(|point| point.0 <= time);
    match (after.checked_sub(1).map(|before| points[before]), points.get(after)) {
        (Some((t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * (time - t0) / (t1 - t0),
        (Some((_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => 0.0,
    }
}
