//! Muscles and skeleton, coupled at every tick.

use super::data::{Arm, ArmMuscle, Group};
use super::skeleton::{Joints, Skeleton};
use crate::engine::{self, Arithmetic, RunError, Running};
use crate::reference::{Input, Mode};
use ode_solvers::{Rk4, System, Vector4};
use vm_nostd::Status;

/// Constant activations of the groups of muscles, 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Activations {
    /// Of both shoulder muscles.
    pub shoulder: f64,
    /// Of both elbow muscles.
    pub elbow: f64,
    /// Of both biarticular muscles.
    pub biarticular: f64,
}

impl Activations {
    fn of(&self, group: Group) -> f64 {
        match group {
            Group::Shoulder => self.shoulder,
            Group::Elbow => self.elbow,
            Group::Biarticular => self.biarticular,
        }
    }
}

/// Inputs of an arm run.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    /// Recruitment mode.
    pub mode: Mode,
    /// Arithmetic.
    pub arithmetic: Arithmetic,
    /// Constant activations.
    pub activations: Activations,
    /// Stimulation frequency, under FES, pps.
    pub stimulation_frequency: f64,
    /// Initial angles, at rest, rad.
    pub start: Joints,
    /// s.
    pub time_step: f64,
    /// s.
    pub duration: f64,
}

/// The arm at the end of a tick.
#[derive(Clone, Debug)]
pub struct Moment {
    /// s.
    pub time: f64,
    /// rad.
    pub angles: Joints,
    /// rad/s.
    pub velocities: Joints,
    /// Tendon forces, N, in the arm's order of muscles.
    pub forces: Vec<f64>,
    /// J.
    pub kinetic_energy: f64,
    /// Work of the muscles so far, J: the sum over muscles of -∫ F dL_mt.
    pub work: f64,
    /// Work done and absorbed: the sum of |F dL_mt|, J.
    pub turnover: f64,
    /// Flags of all muscles in this tick.
    pub status: Status,
}

/// Why an arm run failed.
#[derive(Debug, thiserror::Error)]
pub enum ArmError {
    /// A muscle cannot rest at the initial angles.
    #[error("start = {shoulder:.3}, {elbow:.3} degrees: {name}: {source} (m)")]
    Start {
        /// Degrees.
        shoulder: f64,
        /// Degrees.
        elbow: f64,
        /// Which muscle.
        name: String,
        /// Why.
        source: RunError,
    },
    /// A muscle failed.
    #[error("{name}: {source}")]
    Muscle {
        /// Which.
        name: String,
        /// Why.
        source: RunError,
    },
    /// A value out of range.
    #[error("{field} = {value}: must be {least} to {most}{unit}")]
    Value {
        /// Which.
        field: &'static str,
        /// The refused value.
        value: f64,
        /// Least allowed value.
        least: f64,
        /// Greatest allowed value.
        most: f64,
        /// Unit with a leading space, or empty.
        unit: &'static str,
    },
}

impl Drive {
    fn validate(&self, arm: &Arm) -> Result<(), ArmError> {
        let within = |field, value: f64, least, most, unit| {
            let inside = (least..=most).contains(&value);
            if inside { Ok(()) } else { Err(ArmError::Value { field, value, least, most, unit }) }
        };
        let (least, most) = (arm.least_angles, arm.greatest_angles);
        for (field, joint) in [("shoulder angle", 0), ("elbow angle", 1)] {
            let [value, least, most] =
                [self.start, least, most].map(|angles| angles[joint].to_degrees());
            within(field, value, least, most, " degrees")?;
        }
        within("shoulder activation", self.activations.shoulder, 0.0, 1.0, "")?;
        within("elbow activation", self.activations.elbow, 0.0, 1.0, "")?;
        within("biarticular activation", self.activations.biarticular, 0.0, 1.0, "")?;
        within("stimulation frequency", self.stimulation_frequency, 0.0, 500.0, " pps")?;
        within("tick", self.time_step * 1e3, 0.1, 2.0, " ms")?;
        within("duration", self.duration, self.time_step, 600.0, " s")
    }
}

/// Runs the arm from rest at constant activations; returns every tick, the initial state first.
pub fn run(arm: &Arm, drive: &Drive) -> Result<Vec<Moment>, ArmError> {
    drive.validate(arm)?;
    let mut simulation = Simulation::new(arm, drive)?;
    let mut moments = vec![simulation.now.clone()];
    for _ in 0..(drive.duration / drive.time_step).round() as usize {
        simulation.step()?;
        moments.push(simulation.now.clone());
    }
    Ok(moments)
}

struct Simulation<'a> {
    arm: &'a Arm,
    drive: &'a Drive,
    running: Vec<Box<dyn Running>>,
    paths: Vec<f64>,
    /// Forces one tick earlier, N.
    forces_before: Vec<f64>,
    now: Moment,
}

impl<'a> Simulation<'a> {
    fn new(arm: &'a Arm, drive: &'a Drive) -> Result<Self, ArmError> {
        let paths: Vec<f64> = arm.muscles.iter().map(|m| m.path.length_at(drive.start)).collect();
        let running: Vec<_> = arm
            .muscles
            .iter()
            .zip(&paths)
            .map(|(ArmMuscle { name, muscle, .. }, &path)| {
                engine::at_rest(muscle, drive.mode, drive.arithmetic, drive.time_step, path)
                    .map_err(|source| {
                        let [shoulder, elbow] = drive.start.map(f64::to_degrees);
                        ArmError::Start { shoulder, elbow, name: name.clone(), source }
                    })
            })
            .collect::<Result<_, _>>()?;
        let forces: Vec<f64> = running.iter().map(|running| running.row().0.force).collect();
        let now = Moment {
            time: 0.0,
            angles: drive.start,
            velocities: [0.0; 2],
            forces: forces.clone(),
            kinetic_energy: 0.0,
            work: 0.0,
            turnover: 0.0,
            status: Status::empty(),
        };
        Ok(Self { arm, drive, running, paths, forces_before: forces, now })
    }

    /// One tick as predictor and corrector: predicted with extrapolated forces, then corrected with
    /// the forces on the predicted path. A force that lags by a tick would feed energy into
    /// oscillations.
    fn step(&mut self) -> Result<(), ArmError> {
        let now = &self.now;
        let predicted: Vec<f64> = now
            .forces
            .iter()
            .zip(&self.forces_before)
            .map(|(now, before)| 2.0 * now - before)
            .collect();
        let state = self.moved(&predicted);
        let mut forked: Vec<_> = self.running.iter().map(|running| running.fork()).collect();
        let (forces, ..) = self.pull(&mut forked, &state)?;

        let state = self.moved(&forces);
        let mut running = std::mem::take(&mut self.running);
        let pulled = self.pull(&mut running, &state);
        self.running = running;
        let (forces, paths, status) = pulled?;

        let (angles, velocities) = ([state[0], state[1]], [state[2], state[3]]);
        let now = &mut self.now;
        for (index, force) in forces.iter().enumerate() {
            let shortening = self.paths[index] - paths[index];
            let work = 0.5 * (now.forces[index] + force) * shortening;
            now.work += work;
            now.turnover += work.abs();
        }
        self.forces_before = std::mem::replace(&mut now.forces, forces);
        self.paths = paths;
        now.time += self.drive.time_step;
        (now.angles, now.velocities) = (angles, velocities);
        now.kinetic_energy = self.arm.skeleton.kinetic_energy(angles, velocities);
        now.status = status;
        Ok(())
    }

    /// Angles and velocities at the tick's end, with forces linear from now to `end`.
    fn moved(&self, end: &[f64]) -> Vector4<f64> {
        let now = &self.now;
        let start =
            Vector4::new(now.angles[0], now.angles[1], now.velocities[0], now.velocities[1]);
        let time_step = self.drive.time_step;
        let pulled = Pulled {
            skeleton: &self.arm.skeleton,
            muscles: &self.arm.muscles,
            start: &now.forces,
            end,
            time_step,
        };
        let mut stepper = Rk4::new(pulled, 0.0, start, time_step, time_step);
        stepper.integrate().expect("a step of fixed size does not fail");
        *stepper.y_out().last().expect("the end of the step")
    }

    /// Steps the muscles to a state of the arm; returns forces, paths and flags.
    fn pull(
        &self,
        running: &mut [Box<dyn Running>],
        state: &Vector4<f64>,
    ) -> Result<(Vec<f64>, Vec<f64>, Status), ArmError> {
        let angles = [state[0], state[1]];
        let paths: Vec<f64> =
            self.arm.muscles.iter().map(|muscle| muscle.path.length_at(angles)).collect();
        let mut status = Status::empty();
        let mut forces = Vec::with_capacity(paths.len());
        for ((running, &path_length), muscle) in
            running.iter_mut().zip(&paths).zip(&self.arm.muscles)
        {
            let input = Input {
                activation: self.drive.activations.of(muscle.group),
                path_length,
                stimulation_frequency: self.drive.stimulation_frequency,
            };
            let (sample, flags) = running
                .step(input)
                .map_err(|source| ArmError::Muscle { name: muscle.name.clone(), source })?;
            forces.push(sample.force);
            status |= flags;
        }
        Ok((forces, paths, status))
    }
}

/// The skeleton under forces that change linearly during a tick.
struct Pulled<'a> {
    skeleton: &'a Skeleton,
    muscles: &'a [ArmMuscle],
    start: &'a [f64],
    end: &'a [f64],
    time_step: f64,
}

impl System<f64, Vector4<f64>> for Pulled<'_> {
    fn system(&self, time: f64, state: &Vector4<f64>, change: &mut Vector4<f64>) {
        let share = time / self.time_step;
        let (angles, velocities) = ([state[0], state[1]], [state[2], state[3]]);
        let mut torques = [0.0; 2];
        for ((muscle, start), end) in self.muscles.iter().zip(self.start).zip(self.end) {
            let force = start + share * (end - start);
            let arms = muscle.path.moment_arms_at(angles);
            torques[0] += force * arms[0];
            torques[1] += force * arms[1];
        }
        let [shoulder, elbow] = self.skeleton.acceleration(angles, velocities, torques);
        *change = Vector4::new(velocities[0], velocities[1], shoulder, elbow);
    }
}
