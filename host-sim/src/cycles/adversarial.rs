//! Adversarial inputs: missing, denormal and jumping values.

use crate::reference::{Input, Mode};
use crate::scenario::{Scenario, paper_muscle};
use crate::trace::InputTrace;
use vm_nostd::Status;

/// Length of the scenario, ticks.
const TICKS: u32 = 6_000;

/// Reproducible pseudo-random numbers 0..1 (xorshift32).
struct Noise(u32);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        f64::from(self.0) / f64::from(u32::MAX)
    }
}

/// Clipped, denormal and missing inputs; paths that jump, creep through V = 0 or follow the limits
/// of the validity range; activations at which f_int and f_eff cross in every tick.
pub fn scenario() -> Scenario {
    let mut noise = Noise(0x1234_5678);
    let mut path = 0.16;
    let odd = [-1.0, 7.0, 1e-40, 0.0, 1.0, f64::NAN, f64::INFINITY];
    let inputs = (0..=TICKS)
        .map(|tick| {
            // Half a second of each kind.
            path = match (tick / 500) % 6 {
                0 => 0.16 + 1e-6 * noise.next(),
                1 => 0.08 + 0.104 * noise.next(),
                2 => path + 2e-4 * (noise.next() - 0.5),
                3 => 0.0759 + 1e-3 * noise.next(),
                4 => 0.183 + 1e-3 * noise.next(),
                _ => path + 1e-3 * (noise.next() - 0.5),
            };
            let choice = (noise.next() * 40.0) as usize;
            let steady = if tick % 2 == 0 { 0.2 } else { 0.9 };
            Input {
                activation: odd.get(choice).copied().unwrap_or(steady),
                path_length: if choice == 20 { f64::NAN } else { path },
                stimulation_frequency: 60.0 * noise.next(),
            }
        })
        .collect();
    Scenario {
        name: "adversarial".to_owned(),
        muscle: paper_muscle(),
        mode: Mode::Continuous,
        trace: InputTrace { start: 0.0, time_step: 1e-3, inputs },
        vector: None,
        flags: Status::all(),
    }
}
