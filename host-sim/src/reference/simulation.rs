//! Integration of the model over ticks, by an adaptive Dormand-Prince 5(4) pair that is restarted
//! at every tick, because inputs jump there. An implicit method fails: its finite-difference
//! Jacobian has an infinite slope at the kink f_int = f_eff.

use super::elements as element;
use super::muscle::Muscle;
use super::recruitment::{self, Mode, Unit};
use ode_solvers::dop_shared::{IntegrationError, OutputType, System};
use ode_solvers::{DVector, Dopri5};

/// Inputs of a tick that ends at the sample's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// U, 0..1, constant during the tick.
    pub activation: f64,
    /// L_mt at the end of the tick, m; linear from the previous tick's.
    pub path_length: f64,
    /// f_stim, pps, constant during the tick (FES).
    pub stimulation_frequency: f64,
}

/// Output of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Tendon force, N.
    pub force: f64,
    /// L, L_ce0.
    pub fascicle_length: f64,
    /// V, L_ce0/s.
    pub fascicle_velocity: f64,
}

/// The integrator failed.
#[derive(Debug, thiserror::Error)]
#[error("the reference integrator failed in tick {tick}: {source}")]
pub struct SolverError {
    /// Tick, counted from 1.
    pub tick: u64,
    /// The solver's error.
    pub source: IntegrationError,
}

/// Tolerance per step, relative and absolute (in L_ce0, f0.5, ...).
const TOLERANCE: f64 = 1e-9;
/// Maximum number of steps per tick.
const MOST_STEPS: u32 = 200_000;

// Layout of the state vector: L, V, U_eff, then Y of each type, then four per unit.
const L: usize = 0;
const V: usize = 1;
const U_EFF: usize = 2;
const FIRST_TYPE: usize = 3;
const PER_UNIT: usize = 4;
const F_INT: usize = 0;
const F_EFF: usize = 1;
const S: usize = 2;
const L_EFF: usize = 3;

/// L_eff at rest, L_ce0.
const RESTING_L_EFF: f64 = 1.0;

/// A muscle being simulated.
#[derive(Clone, Debug)]
pub struct Simulation {
    muscle: Muscle,
    mode: Mode,
    units: Vec<Unit>,
    time_step: f64,
    state: DVector<f64>,
    path_length: f64,
    /// Fitness; 1 without fatigue.
    fitness: f64,
    first_step: f64,
    tick: u64,
}

impl Simulation {
    /// A muscle at rest at `path_length` (m), stepped by `time_step` (s).
    pub fn at_rest(muscle: Muscle, mode: Mode, time_step: f64, path_length: f64) -> Self {
        let units = recruitment::units(&muscle, mode);
        let first_unit = FIRST_TYPE + muscle.fibers.len();
        let mut state = DVector::zeros(first_unit + PER_UNIT * units.len());
        state[L] = resting_length(&muscle, path_length);
        for i in 0..muscle.fibers.len() {
            state[FIRST_TYPE + i] = 1.0;
        }
        for (j, unit) in units.iter().enumerate() {
            let at = first_unit + PER_UNIT * j;
            state[at + S] = muscle.fibers[unit.fiber].fiber_type.sag.map_or(1.0, |sag| sag.aS1);
            state[at + L_EFF] = RESTING_L_EFF;
        }
        Self {
            muscle,
            mode,
            units,
            time_step,
            state,
            path_length,
            fitness: 1.0,
            first_step: 0.0,
            tick: 0,
        }
    }

    /// The state as a sample.
    pub fn sample(&self) -> Sample {
        let e = &self.muscle.elements;
        Sample {
            force: self.fitness
                * self.muscle.f0()
                * element::tendon(e, self.tendon_length(self.path_length)),
            fascicle_length: self.state[L],
            fascicle_velocity: self.state[V],
        }
    }

    fn tendon_length(&self, path_length: f64) -> f64 {
        (path_length - self.state[L] * self.muscle.L_ce0) / self.muscle.L_se0
    }

    /// Steps one tick.
    pub fn step(&mut self, input: Input) -> Result<Sample, SolverError> {
        let u = input.activation.clamp(0.0, 1.0);
        let tick = Tick {
            muscle: &self.muscle,
            mode: self.mode,
            l_max: self.muscle.maximum_fascicle_length(),
            acceleration: self.muscle.f0() / (0.5 * self.muscle.mass * self.muscle.L_ce0),
            units: &self.units,
            f_env: recruitment::firing_frequencies(
                &self.muscle,
                self.mode,
                &self.units,
                u,
                input.stimulation_frequency,
            ),
            u,
            path_start: self.path_length,
            path_rate: (input.path_length - self.path_length) / self.time_step,
        };
        let mut stepper = Dopri5::from_param(
            tick,
            0.0,
            self.time_step,
            self.time_step,
            self.state.clone(),
            TOLERANCE,
            TOLERANCE,
            0.9,
            0.04,
            0.2,
            10.0,
            self.time_step,
            self.first_step,
            MOST_STEPS,
            MOST_STEPS, // also the stiffness test's, which would refuse feasible small steps
            OutputType::Sparse,
        );
        self.tick += 1;
        stepper.integrate().map_err(|source| SolverError { tick: self.tick, source })?;
        let times = stepper.x_out();
        // The last step is cut to end with the tick; the next tick starts with the one before.
        self.first_step = match times.as_slice() {
            [.., a, b, _] => b - a,
            _ => 0.0,
        };
        if let Some(state) = stepper.y_out().last() {
            self.state.clone_from(state);
        }
        self.path_length = input.path_length;
        if let Some(fatigue) = &self.muscle.fatigue {
            // Natural firing counts as the highest stimulation frequency.
            let frequency =
                if self.mode == Mode::Fes { input.stimulation_frequency } else { f64::INFINITY };
            self.fitness = fatigue.fitness(self.fitness, self.time_step, u, frequency);
        }
        Ok(self.sample())
    }
}

/// Passive equilibrium F_se = F_pe1 by bisection: the difference falls monotonically with L.
fn resting_length(muscle: &Muscle, path_length: f64) -> f64 {
    let e = &muscle.elements;
    let l_max = muscle.maximum_fascicle_length();
    let (mut low, mut high) = (0.0, path_length / muscle.L_ce0);
    while high - low > 1e-14 * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        let tendon = element::tendon(e, (path_length - middle * muscle.L_ce0) / muscle.L_se0);
        if tendon > element::parallel_elastic(e, middle, l_max, 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The right-hand side during one tick.
struct Tick<'a> {
    muscle: &'a Muscle,
    mode: Mode,
    l_max: f64,
    acceleration: f64,
    units: &'a [Unit],
    f_env: Vec<f64>,
    u: f64,
    path_start: f64,
    path_rate: f64,
}

impl System<f64, DVector<f64>> for Tick<'_> {
    fn system(&self, time: f64, y: &DVector<f64>, dy: &mut DVector<f64>) {
        let m = self.muscle;
        let e = &m.elements;
        let (l, v, u_eff) = (y[L], y[V], y[U_EFF]);
        let weights = recruitment::weights(self.units, u_eff);
        let first_unit = FIRST_TYPE + m.fibers.len();
        let mut filament_force = 0.0;
        let mut compression_force = 0.0;
        for (i, fiber) in m.fibers.iter().enumerate() {
            dy[FIRST_TYPE + i] = element::yielding_rate(&fiber.fiber_type, y[FIRST_TYPE + i], v);
        }
        for (j, unit) in self.units.iter().enumerate() {
            let t = &m.fibers[unit.fiber].fiber_type;
            let at = first_unit + PER_UNIT * j;
            let (f_int, f_eff) = (y[at + F_INT], y[at + F_EFF]);
            let f_env = self.f_env[j];
            let rising = f_int >= f_eff;
            // Frequency at the filaments, input of the excitation chain, sag of the unit, and
            // weights of the two kinds of force.
            let (f, drive, sagging, weight, compression_weight) = match self.mode {
                Mode::Continuous => {
                    let weight = u_eff * weights[j];
                    (f_eff, f_env, f_eff >= 0.1, weight, weight)
                }
                Mode::Fes => (f_env, self.u, f_env > 0.1, f_eff * unit.pcsa, unit.pcsa),
                Mode::Discrete | Mode::DiscreteEffectiveLength => {
                    (f_eff, f_env, f_eff >= 0.1, unit.pcsa, unit.pcsa)
                }
            };
            let acting_length =
                if self.mode == Mode::DiscreteEffectiveLength { y[at + L_EFF] } else { l };
            let yielding = y[FIRST_TYPE + unit.fiber];
            let af = element::activation_frequency(t, f, acting_length, yielding, y[at + S]);
            let slowing = match self.mode {
                Mode::Fes => f64::from(u8::from(self.u > 0.0)),
                _ => af,
            };
            let time_constant = element::excitation_time(t, rising, l, f_env, slowing);
            dy[at + F_INT] = (drive - f_int) / time_constant;
            dy[at + F_EFF] = (f_int - f_eff) / time_constant;
            dy[at + S] = element::sag_rate(t, y[at + S], sagging);
            dy[at + L_EFF] = match self.mode {
                Mode::DiscreteEffectiveLength => {
                    element::effective_length_rate(t, l, y[at + L_EFF], af)
                }
                _ => 0.0,
            };
            filament_force +=
                weight * af * element::force_length(t, l) * element::force_velocity(t, l, v);
            compression_force += compression_weight * af * element::compression(e, l);
        }
        let passive = element::parallel_elastic(e, l, self.l_max, v) + compression_force;
        let contractile = match self.mode {
            Mode::Fes => passive.max(0.0) + filament_force,
            _ => passive + filament_force,
        }
        .max(0.0);
        let path = self.path_start + self.path_rate * time;
        let tendon = element::tendon(e, (path - l * m.L_ce0) / m.L_se0);
        dy[L] = v;
        dy[V] = self.acceleration * (tendon - contractile);
        dy[U_EFF] = recruitment::effective_activation_rate(self.u, u_eff);
    }
}
