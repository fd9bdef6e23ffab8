//! The plant: two muscles of the model in `f64`, electrodes, fatigue, and a limb.
//!
//! J q'' + B q' + G sin(q - q_hang) = τ_muscles + τ_push - τ_reflex + τ_stops, 1 ms at a time: the
//! velocity by the torques at the tick's start, the angle by the new velocity.

use super::patient::Patient;
use super::task::Task;
use vm_nostd::control::{AngleRange, PathParams};
use vm_nostd::{
    Fatigue, FatigueState, FesMuscle, Input, IntramuscularFes, ParameterError, State, TimeStep,
};

/// A tick, s.
pub const TICK: f64 = 1e-3;
/// Stimulation frequency, pps: a pulse every 25 ms.
pub const FREQUENCY: f64 = 40.0;
/// Ticks between two pulses.
pub const PULSE_TICKS: usize = 25;
/// The joint's stops beyond its range: N m/rad and N m s/rad per N m of the weight and 5 N m.
const STOP_STIFFNESS: f64 = 20.0;
const STOP_DAMPING: f64 = 0.5;
/// Delay of the reflex, ticks.
const REFLEX_TICKS: usize = 30;

/// One muscle of the plant.
#[derive(Clone, Debug)]
struct Pull {
    muscle: FesMuscle<f64, 2>,
    state: State<f64, IntramuscularFes, 2>,
    fatigue: Fatigue<f64>,
    tired: FatigueState<f64>,
    path: PathParams<1>,
    shortest: f64,
    longest: f64,
    fascicle: f64,
    /// Sine of the pennation at L_ce0.
    sine: f64,
    /// cos α of the last tick.
    cosine: f64,
    /// Fascicles, L_ce0.
    length: f64,
    /// The last pulse (A, s) and what it recruits.
    stimulus: ((f64, f64), f64),
}

/// The plant.
#[derive(Clone, Debug)]
pub struct Plant {
    patient: Patient,
    pulls: [Pull; 2],
    range: AngleRange,
    stop: f64,
    /// rad.
    pub angle: f64,
    /// rad/s.
    pub velocity: f64,
    /// Velocities of the last ticks.
    reflex: [f64; REFLEX_TICKS],
    ticks: usize,
}

/// What a muscle of the plant was given in a tick, and its force before fatigue (N).
pub type Driven = (Input<f64>, f64);

impl Plant {
    /// A patient at rest at the start of a task.
    pub fn at_rest(task: Task, patient: &Patient) -> Result<Self, ParameterError> {
        let preset = task.joint();
        let angle = task.start();
        let pull = |i: usize| -> Result<Pull, ParameterError> {
            let params = &patient.muscles[i];
            let path = preset.muscles[i].path();
            let muscle = FesMuscle::build(params, TimeStep::MILLISECOND)?;
            let (shortest, longest) = muscle.path_length_range();
            let mut pull = Pull {
                state: muscle.rest(path.length_at([angle]).clamp(shortest, longest))?,
                fatigue: Fatigue::build(&patient.fatigue[i], TimeStep::MILLISECOND)?,
                tired: Fatigue::build(&patient.fatigue[i], TimeStep::MILLISECOND)?.rested(),
                muscle,
                path,
                shortest,
                longest,
                fascicle: params.fascicle_length,
                sine: patient.pennation[i].sin(),
                cosine: patient.pennation[i].cos(),
                length: 1.0,
                stimulus: ((0.0, 0.0), patient.electrodes[i].recruited(0.0, 0.0)),
            };
            // Without a jump in the first tick: the fascicles of the path that they will be given.
            for _ in 0..20 {
                let path = pull.in_line(angle);
                pull.state = pull.muscle.rest(path)?;
                pull.observe();
            }
            Ok(pull)
        };
        let nominal = task.limb();
        Ok(Self {
            pulls: [pull(0)?, pull(1)?],
            range: preset.range,
            stop: nominal.gravity + 5.0 * nominal.inertia,
            angle,
            velocity: 0.0,
            reflex: [0.0; REFLEX_TICKS],
            ticks: 0,
            patient: patient.clone(),
        })
    }

    /// One tick with pulses (A, s) of flexor and extensor; returns what the muscles were given.
    pub fn step(&mut self, pulses: [(f64, f64); 2]) -> [Driven; 2] {
        let time = self.ticks as f64 * TICK;
        let mut torque = 0.0;
        let mut driven =
            [(Input { activation: 0.0, path_length: 0.0, stimulation_frequency: 0.0 }, 0.0); 2];
        for (i, pull) in self.pulls.iter_mut().enumerate() {
            // It costs two powers, and pulses last for many ticks.
            if pull.stimulus.0 != pulses[i] {
                let (amplitude, width) = pulses[i];
                let recruited = self.patient.electrodes[i].recruited(amplitude, width);
                pull.stimulus = (pulses[i], recruited);
            }
            let activation = pull.stimulus.1;
            let input = Input {
                activation,
                path_length: pull.in_line(self.angle),
                stimulation_frequency: FREQUENCY,
            };
            let output = pull.muscle.step(&mut pull.state, input);
            driven[i] = (input, output.force);
            let fitness = pull.fatigue.advance(&mut pull.tired, activation, FREQUENCY);
            let force = fitness * output.force * pull.cosine;
            pull.observe();
            torque += force * pull.path.moment_arms_at([self.angle])[0];
        }
        let limb = &self.patient.limb;
        let place = self.ticks % REFLEX_TICKS;
        // The muscle that was stretched pulls back.
        torque -= self.patient.spasticity * self.reflex[place];
        self.reflex[place] = self.velocity;
        let (push, from, to) = self.patient.push;
        if (from..to).contains(&time) {
            torque += push;
        }
        let beyond =
            (self.angle - self.range.least).min(0.0) + (self.angle - self.range.most).max(0.0);
        if beyond != 0.0 {
            torque -= self.stop * (STOP_STIFFNESS * beyond + STOP_DAMPING * self.velocity);
        }
        torque -= limb.gravity * (self.angle - limb.hanging_angle).sin();
        // Damping at the tick's end, so that none is too strong.
        self.velocity = (self.velocity + TICK * torque / limb.inertia)
            / (1.0 + TICK * limb.damping / limb.inertia);
        self.angle += TICK * self.velocity;
        self.ticks += 1;
        driven
    }

    /// Lowest fitness of both muscles.
    pub fn fitness(&self) -> f64 {
        self.pulls.iter().map(|pull| pull.tired.fitness()).fold(1.0, f64::min)
    }
}

impl Pull {
    /// The path of a muscle in line whose fascicles are as long as those at an angle to the tendon:
    /// what they lose along it is added.
    fn in_line(&self, angle: f64) -> f64 {
        let lost = self.length * self.fascicle * (1.0 - self.cosine);
        (self.path.length_at([angle]) + lost).clamp(self.shortest, self.longest)
    }

    fn observe(&mut self) {
        self.length = self.muscle.observe(&self.state).fascicle_length;
        self.cosine = (1.0 - (self.sine / self.length).powi(2)).max(0.0).sqrt();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coefficients;
    use crate::engine::{self, Arithmetic};
    use crate::reference::{self, Mode, Muscle};
    use crate::trace::InputTrace;

    /// A muscle of the plant in the reference's symbols.
    fn referred(params: &vm_nostd::MuscleParams<2>) -> Muscle {
        let names = ["human-vm4/slow", "human-vm4/fast"];
        let fibers = params.fibers.iter().zip(names).map(|(fiber, name)| {
            let mut known = coefficients::fiber(name, fiber.fraction).expect("a type");
            let e = &fiber.fiber_type.excitation;
            let t = &mut known.fiber_type;
            (t.Tf1, t.Tf2, t.Tf3, t.Tf4) =
                (e.rise, e.rise_per_frequency, e.fall, e.fall_per_activation);
            known
        });
        Muscle {
            mass: params.mass,
            L_ce0: params.fascicle_length,
            L_se0: params.tendon_length,
            L_mt_max: params.max_path_length,
            U_r: params.recruitment_saturation,
            elements: coefficients::elements("human-vm4").expect("a set"),
            fibers: fibers.collect(),
            fatigue: None,
        }
    }

    /// The forces of 20 patients' muscles, in motion, are those of the reference within 0.1 % of
    /// F0.
    #[test]
    fn the_plant_is_the_reference_on_20_patients() {
        for number in 0..20 {
            let task = Task::ALL[number as usize % 4];
            let patient = Patient::scored(task, number);
            let mut plant = Plant::at_rest(task, &patient).expect("a plant");
            let first = plant.pulls.each_ref().map(|pull| pull.in_line(plant.angle));
            let mut driven = Vec::new();
            for tick in 0..1500 {
                // Pulses that change every 25 ms, of one muscle and the other.
                let phase = (tick / PULSE_TICKS) as f64 * 0.2 + number as f64;
                let widths = [phase.sin(), -phase.sin()].map(|x| 1.2e-4 * x.max(0.0));
                driven.push(plant.step(widths.map(|width| (0.03, width))));
            }
            for i in 0..2 {
                let muscle = referred(&patient.muscles[i]);
                let input = |activation, path_length| reference::Input {
                    activation,
                    path_length,
                    stimulation_frequency: FREQUENCY,
                };
                let mut inputs = vec![input(0.0, first[i])];
                inputs.extend(driven.iter().map(|d| input(d[i].0.activation, d[i].0.path_length)));
                let trace = InputTrace { start: 0.0, time_step: TICK, inputs };
                let rows = engine::run(&muscle, Mode::Fes, Arithmetic::Reference, &trace);
                let rows = rows.expect("a run");
                let f0 = muscle.f0();
                let worst = rows[1..]
                    .iter()
                    .zip(&driven)
                    .map(|(row, driven)| (row.0.force - driven[i].1).abs() / f0)
                    .fold(0.0, f64::max);
                assert!(worst < 1e-3, "{task:?} {number} muscle {i}: {worst:e} F0");
                let strongest = driven.iter().map(|d| d[i].1 / f0).fold(0.0, f64::max);
                assert!(strongest > 0.02, "{task:?} {number} muscle {i} pulls {strongest} F0");
            }
        }
    }

    /// Without stimulation a limb comes to rest where its weight and its passive muscles are in
    /// balance; its energy is not made from nothing.
    #[test]
    fn an_idle_limb_comes_to_rest() {
        for task in Task::ALL {
            let mut patient = Patient::scored(task, 7);
            (patient.push.0, patient.spasticity) = (0.0, 0.0);
            let mut plant = Plant::at_rest(task, &patient).expect("a plant");
            for _ in 0..20_000 {
                plant.step([(0.0, 0.0); 2]);
            }
            assert!(plant.velocity.abs() < 1e-3, "{task:?}: {} rad/s", plant.velocity);
        }
    }
}
