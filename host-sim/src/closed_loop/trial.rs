//! One controller on one patient: the run, and its score.

use super::controller::{AMPLITUDE, Controller, GREATEST_WIDTH, Kind};
use super::patient::Patient;
use super::plant::{PULSE_TICKS, Plant, TICK};
use super::random::Random;
use super::task::{APPROACH, Motion, Task};
use vm_nostd::control::JointError;

/// Degrees beyond the joint's range in which its stops are pressed as by no controlled limb.
const PRESSED: f64 = 5.0;
/// Peak to peak of the error in the last quarter of a held target, degrees, that counts as
/// oscillating.
const OSCILLATING: f64 = 15.0;
/// An error (degrees) that ends a held task, and for how long (s).
const ENDED: (f64, f64) = (10.0, 2.0);

/// A moment of a run, for plots.
#[derive(Clone, Copy, Debug)]
pub struct Instant {
    /// s.
    pub time: f64,
    /// rad.
    pub target: f64,
    /// rad.
    pub angle: f64,
    /// Pulse widths of flexor and extensor, s.
    pub widths: [f64; 2],
    /// Lowest fitness of both muscles.
    pub fitness: f64,
}

/// What a run was like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Root mean square of the tracking error, degrees.
    pub rms: f64,
    /// Greatest angle beyond what is ever wanted, degrees.
    pub overshoot: f64,
    /// Charge of all pulses, µC.
    pub charge: f64,
    /// When fatigue, or anything else, ended the task, s: its duration if nothing did.
    pub endured: f64,
    /// It oscillated or ran into the joint's stops.
    pub unstable: bool,
    /// A command was not finite or beyond its greatest width.
    pub limit_broken: bool,
}

/// One controller on one patient.
pub struct Trial<'a> {
    /// What is to be done.
    pub task: Task,
    /// On whom.
    pub patient: &'a Patient,
    /// By whom.
    pub kind: Kind,
    /// With what settings.
    pub settings: &'a [f64],
    /// For the time of a tuner's run.
    pub tuning: bool,
}

impl Trial<'_> {
    /// Runs it; `watch` sees every pulse.
    pub fn run(&self, watch: impl FnMut(Instant)) -> Result<Score, JointError> {
        let mut controller = Controller::new(self.kind, self.task, self.settings)?;
        self.run_by(|target, measured| Ok(controller.step(target, measured)), watch)
    }

    /// Runs it with a controller of the caller's: pulse widths of flexor and extensor (s) for a
    /// target and a measured angle (rad), in every tick.
    pub fn run_by<E: From<JointError>>(
        &self,
        mut controller: impl FnMut(Motion, f64) -> Result<[f64; 2], E>,
        mut watch: impl FnMut(Instant),
    ) -> Result<Score, E> {
        let own = |error| JointError { muscle: None, error };
        let mut plant = Plant::at_rest(self.task, self.patient).map_err(own)?;
        let duration = self.task.duration(self.tuning);
        let ticks = (duration / TICK) as usize;
        let late = (self.patient.delay / TICK).round() as usize;
        let mut line = vec![plant.angle; late + 1];
        let mut noise = Random::new(3, self.patient.delay.to_bits());
        let (least, most) = self.task.extent();
        let range = self.task.joint().range;
        let mut widths = [0.0; 2];
        let (mut squares, mut overshoot, mut charge) = (0.0, 0.0_f64, 0.0);
        let (mut pressed, mut broken) = (false, false);
        let mut beyond_since = None;
        let mut endured = duration;
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        for tick in 0..ticks {
            let time = tick as f64 * TICK;
            let target = self.task.target(time);
            let place = tick % line.len();
            line[place] = plant.angle;
            let oldest = line[(tick + 1) % line.len()];
            let commanded = controller(target, oldest + self.patient.noise * noise.normal())?;
            if tick % PULSE_TICKS == 0 {
                widths = commanded;
                let good = |width: &f64| (0.0..=GREATEST_WIDTH).contains(width);
                broken |= !widths.iter().all(good);
                charge += (widths[0] + widths[1]) * AMPLITUDE * 1e6;
                let (angle, fitness) = (plant.angle, plant.fitness());
                watch(Instant { time, target: target[0], angle, widths, fitness });
            }
            plant.step(widths.map(|width| (AMPLITUDE, width)));
            let error = (plant.angle - target[0]).to_degrees();
            if time >= APPROACH {
                squares += error * error;
                overshoot = overshoot
                    .max((plant.angle - most).to_degrees())
                    .max((least - plant.angle).to_degrees());
            }
            let out = (range.least - plant.angle).max(plant.angle - range.most).to_degrees();
            pressed |= out >= PRESSED || out.is_nan();
            if time > 0.75 * duration {
                (lowest, highest) = (lowest.min(error), highest.max(error));
            }
            if error.abs() > ENDED.0 && time > APPROACH + 3.0 {
                let since = *beyond_since.get_or_insert(time);
                if time - since > ENDED.1 {
                    endured = endured.min(since);
                }
            } else {
                beyond_since = None;
            }
        }
        let scored = (ticks as f64 - APPROACH / TICK).max(1.0);
        let swings = self.task == Task::KneeHold && highest - lowest > OSCILLATING;
        let rms = (squares / scored).sqrt();
        Ok(Score {
            rms,
            overshoot,
            charge,
            endured,
            unstable: pressed || swings || !rms.is_finite(),
            limit_broken: broken,
        })
    }
}
