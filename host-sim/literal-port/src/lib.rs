//! The baseline for cycles: a direct port of Virtual Muscle. The paper's equations line by line,
//! its validation muscle, libm, and the classical Runge-Kutta method at the longest stable fixed
//! step.
//!
//! It shares no code with the model or the reference and checks no input. It is a fair baseline:
//! nothing is computed twice, and `f32` uses libm's single-precision functions.
#![no_std]

mod equations;
mod kernels;
mod real;

pub use equations::Drive;
use equations::{Excitation, F0, STATES, rates, rest, tendon_force};
pub use kernels::kernels_of_one_evaluation;
pub use real::Real;

/// Runge-Kutta steps per millisecond: the fewest with an error of at most 0.1 % of F0 in double
/// precision on smooth and sudden inputs. With fewer the scheme chatters about the kink of the
/// force-velocity relation.
pub const STABLE_STEPS: u32 = 31;

/// A muscle with its state.
#[derive(Clone, Debug)]
pub struct LiteralMuscle<R> {
    /// Runge-Kutta steps per tick.
    steps: u32,
    /// s.
    step: R,
    state: [R; STATES],
    /// m.
    path_length: R,
}

impl<R: Real> LiteralMuscle<R> {
    /// The muscle at rest on a path (m), with a number of steps per tick of 1 ms.
    pub fn at_rest(path_length: R, steps: u32) -> Self {
        let step = R::of(1e-3) / R::of(f64::from(steps));
        Self { steps, step, state: rest(path_length), path_length }
    }

    /// Tendon force, N.
    pub fn force(&self) -> R {
        R::of(F0) * tendon_force(self.path_length, self.state[0])
    }

    /// Steps one millisecond to a path length (m) and returns the tendon force, N.
    pub fn tick(&mut self, drive: Drive<R>, path_length: R) -> R {
        let excitation = Excitation::of(drive);
        let slope = (path_length - self.path_length) / R::of(1e-3);
        for step in 0..self.steps {
            let start = self.path_length + slope * self.step * R::of(f64::from(step));
            self.runge_kutta(&excitation, start, slope);
        }
        self.path_length = path_length;
        self.force()
    }

    /// One step of the classical Runge-Kutta method.
    fn runge_kutta(&mut self, excitation: &Excitation<R>, path: R, slope: R) {
        let (whole, half) = (self.step, self.step * R::of(0.5));
        let y = self.state;
        let k1 = rates(excitation, &y, path);
        let k2 = rates(excitation, &along(&y, &k1, half), path + slope * half);
        let k3 = rates(excitation, &along(&y, &k2, half), path + slope * half);
        let k4 = rates(excitation, &along(&y, &k3, whole), path + slope * whole);
        let sixth = whole / R::of(6.0);
        for i in 0..STATES {
            let middle = k2[i] + k3[i];
            self.state[i] = y[i] + sixth * (k1[i] + middle + middle + k4[i]);
        }
    }
}

fn along<R: Real>(y: &[R; STATES], rates: &[R; STATES], time: R) -> [R; STATES] {
    let mut moved = *y;
    for (value, &rate) in moved.iter_mut().zip(rates) {
        *value = *value + rate * time;
    }
    moved
}
