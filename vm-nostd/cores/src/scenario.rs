//! The compiled-in scenario: twelve seconds that visit what a muscle can meet.

use crate::rig::Inputs;
use core::f32::consts::TAU;
use vm_nostd::{Input, Scalar};

/// Length of the scenario, ticks.
pub const TICKS: u32 = 12_000;

/// Steps and ramps of activation, moving paths with a slack tendon among them, changes of
/// stimulation frequency, and now and then an input that no sensor should deliver.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scenario;

impl Scenario {
    /// Path length the muscles rest at before the first tick, m.
    pub const RESTING_PATH: f32 = 0.16;
}

/// Ticks that an activation is held for.
const HOLD: u32 = 250;
/// Ticks between two inputs that are out of their range.
const MISHAP: u32 = 997;

impl<S: Scalar> Inputs<S> for Scenario {
    fn inputs(&mut self, tick: u32) -> [Input<S>; 2] {
        numbers(tick).map(|input| Input {
            activation: S::from_f64(input.activation.into()),
            path_length: S::path_length(input.path_length.into()),
            stimulation_frequency: S::quantity(input.stimulation_frequency.into()),
        })
    }
}

/// The inputs of a tick as numbers.
fn numbers(tick: u32) -> [Input<f32>; 2] {
    let time = tick as f32 * 1e-3;
    let epoch = tick / HOLD;
    let held = share(epoch, 0);
    let next = share(epoch + 1, 0);
    // Every other epoch ramps to the next level instead of holding its own.
    let ramp = if epoch.is_multiple_of(2) { (tick % HOLD) as f32 / HOLD as f32 } else { 0.0 };
    let activation = held + (next - held) * ramp;

    // The path starts where the muscles rest, and swings wide enough for a slack tendon.
    let swing = libm::sinf(TAU * 1.3 * time) * (time * 0.5).min(1.0);
    let path_length = Scenario::RESTING_PATH + 0.02 * swing;
    let stimulation_frequency = 5.0 + 45.0 * share(tick / (2 * HOLD), 1);

    let mut natural = Input { activation, path_length, stimulation_frequency: 0.0 };
    let mut stimulated = Input { activation: share(epoch, 2), path_length, stimulation_frequency };
    if tick % MISHAP == MISHAP - 1 {
        match (tick / MISHAP) % 6 {
            0 => natural.activation = f32::NAN,
            1 => natural.path_length = 0.3,
            2 => stimulated.stimulation_frequency = f32::INFINITY,
            3 => stimulated.path_length = f32::NAN,
            4 => stimulated.activation = -0.5,
            _ => natural.activation = 7.0,
        }
    }
    [natural, stimulated]
}

/// A number 0..1 that looks random, the same on every machine; one in four is 0 or 1.
fn share(index: u32, stream: u32) -> f32 {
    let mut bits = index.wrapping_mul(0x9E37_79B9).wrapping_add(stream.wrapping_mul(0x85EB_CA6B));
    bits ^= bits >> 16;
    bits = bits.wrapping_mul(0x7FEB_352D);
    bits ^= bits >> 15;
    match bits & 7 {
        0 => 0.0,
        1 => 1.0,
        _ => (bits >> 8) as f32 / (1 << 24) as f32,
    }
}
