//! One recording of a protocol: what the muscle is made to do.

use crate::fit::Role;
use crate::muscle_file::NamedMuscle;
use crate::reference::{Input, Mode, Muscle};
use crate::trace::InputTrace;
use vm_nostd::{ParameterError, Pulse, RecruitmentCurve, RecruitmentCurveParams};

/// Pairs of a time (s) and the value from then on.
pub type Steps = Vec<(f64, f64)>;

/// A recording, from rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Bout {
    /// Name, of its files too.
    pub name: &'static str,
    /// What it is for.
    pub role: Role,
    /// How long it lasts, s.
    pub seconds: f64,
    /// Effort (natural) or amplitude of the stimulus over that of [`Setting::full_ma`]; 0 to 1.
    pub level: Steps,
    /// Width of the pulses, µs.
    pub width_us: Steps,
    /// Stimulation frequency, pps; 0 in natural recruitment.
    pub pps: Steps,
    /// Path beyond the neutral one, L_ce0: linear between these times (s), held before and after.
    pub path: Vec<(f64, f64)>,
}

/// Width of the pulses where a bout does not vary it, µs.
pub const WIDTH_US: f64 = 300.0;
/// A pulse of level 1 is so many times what saturates the mean muscle: it saturates patients, too.
const SATURATION: f64 = 1.6;
/// Tick of what is played, s.
pub const TICK: f64 = 1e-3;

/// What a protocol is scaled by: the muscle that is expected.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Path at which the fascicles are at L_ce0 with the tendon at F0, m.
    pub neutral: f64,
    /// L_ce0, m.
    pub fascicle: f64,
    /// Amplitude at level 1, mA; none without a recruitment curve, where the level is the
    /// activation.
    pub full_ma: Option<f64>,
}

impl Setting {
    /// For a muscle and a mode.
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
    /// The file of its inputs, as `vm run` and `vm hil` take it.
    pub fn file_name(&self) -> String {
        format!("{}.csv", self.name)
    }

    /// For how long the muscle is driven, s.
    pub fn driven(&self) -> f64 {
        let ends = self.level.iter().skip(1).map(|step| step.0).chain([self.seconds]);
        let lasts = self.level.iter().zip(ends).map(|(step, end)| (step.1, end - step.0));
        lasts.filter(|(level, _)| *level > 0.0).map(|(_, lasts)| lasts).sum()
    }

    /// What a muscle with this recruitment curve, on a path longer by `offset` (m), is made to do,
    /// tick by tick.
    pub fn inputs(
        &self,
        setting: &Setting,
        curve: Option<&RecruitmentCurveParams>,
        offset: f64,
    ) -> Result<InputTrace, ParameterError> {
        let curve = curve.map(RecruitmentCurve::<f64>::build).transpose()?;
        let input = |tick: usize| {
            let end = tick as f64 * TICK;
            // In force during the tick.
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

/// The value of steps at a time; before the first, the first.
fn at(steps: &Steps, time: f64) -> f64 {
    let after = steps.partition_point(|step| step.0 <= time);
    steps[after.saturating_sub(1)].1
}

/// Linear between the points.
fn between(points: &[(f64, f64)], time: f64) -> f64 {
    let after = points.partition_point(|point| point.0 <= time);
    match (after.checked_sub(1).map(|before| points[before]), points.get(after)) {
        (Some((t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * (time - t0) / (t1 - t0),
        (Some((_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => 0.0,
    }
}
