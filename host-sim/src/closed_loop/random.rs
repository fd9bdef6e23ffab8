//! Random numbers of a patient.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

/// A stream of numbers that is the same whenever it is asked for.
#[derive(Clone, Debug)]
pub struct Random(ChaCha8Rng);

impl Random {
    pub fn new(stream: u64, number: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(number);
        generator.set_stream(stream);
        Self(generator)
    }

    /// 0..1.
    pub fn share(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        least + self.share() * (most - least)
    }

    /// As likely to be less than 1 as more, by the same factor.
    pub fn factor(&mut self, most: f64) -> f64 {
        most.powf(self.between(-1.0, 1.0))
    }

    /// Normal, of mean 0 and deviation 1 (Box & Muller 1958).
    pub fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.share()).ln()).sqrt() * (TAU * self.share()).cos()
    }
}
