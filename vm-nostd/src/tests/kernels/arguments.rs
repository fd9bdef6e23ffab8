//! Arguments of kernels: every bit pattern of a range, or random ones.

use std::sync::atomic::{AtomicI64, Ordering};
use std::thread;

/// Which arguments a row is tested with. Each is a number, which the row's function turns into the
/// kernel's arguments.
pub(super) enum Arguments {
    /// Every `f32` between two, as a [place](f32_at).
    Floats(f32, f32),
    /// Every integer between two: bits of fixed point.
    Bits(i64, i64),
    /// So many random ones: a number from 0 on is the seed of [`Random`].
    Random(i64),
}

impl Arguments {
    pub(super) fn text(&self) -> &'static str {
        match self {
            Self::Floats(..) | Self::Bits(..) => "all",
            Self::Random(_) => "random",
        }
    }

    fn range(&self) -> (i64, i64) {
        match *self {
            Self::Floats(least, most) => (place_of(least), place_of(most)),
            Self::Bits(least, most) => (least, most),
            Self::Random(count) => (0, count - 1),
        }
    }
}

/// Place of a number among all `f32`: in ascending order, 0 for 0.
fn place_of(x: f32) -> i64 {
    let magnitude = i64::from(x.abs().to_bits());
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

/// The `f32` at a place. Negative 0 has none.
pub(super) fn f32_at(place: i64) -> f32 {
    let magnitude = f32::from_bits(place.unsigned_abs() as u32);
    if place < 0 { -magnitude } else { magnitude }
}

/// Reproducible pseudo-random numbers.
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: i64) -> Self {
        Self((seed as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    /// Any bits (splitmix64).
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let a = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let b = (a ^ (a >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        b ^ (b >> 31)
    }

    /// Evenly from `least` to `most`.
    pub(super) fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * (self.bits() >> 11) as f64 * 2_f64.powi(-53)
    }

    /// Positive, evenly by its logarithm.
    pub(super) fn magnitude(&mut self, least: f64, most: f64) -> f64 {
        self.between(least.ln(), most.ln()).exp()
    }

    /// One of some.
    pub(super) fn one_of<const N: usize>(&mut self, some: [f64; N]) -> f64 {
        some[self.bits() as usize % N]
    }

    /// A number of any magnitude and sign in fixed point, the ends among them.
    pub(super) fn number(&mut self) -> i32 {
        let bits = self.bits();
        match bits & 63 {
            0 => i32::MIN,
            1 => i32::MAX,
            2 => 0,
            _ => (bits >> 32) as i32 >> (bits >> 6 & 31),
        }
    }

    /// An integer from 1 to 2^60 of any magnitude.
    pub(super) fn wide(&mut self) -> u64 {
        let shift = 4 + self.bits() % 60;
        (self.bits() >> shift).max(1)
    }
}

/// Largest `error` over every `stride`-th argument and those near both ends, computed on all cores;
/// NaN if any error is NaN.
pub(super) fn largest_error(
    arguments: &Arguments,
    stride: i64,
    error: impl Fn(i64) -> f64 + Sync,
) -> f64 {
    const BLOCK: i64 = 1 << 22;
    const NEAR: i64 = 2000;
    let (least, most) = arguments.range();
    // Random arguments are the same in every run, but for one with overflow checks.
    let stride = match arguments {
        Arguments::Random(_) if cfg!(debug_assertions) => 101,
        Arguments::Random(_) => 1,
        _ => stride,
    };
    // Keeps NaN.
    let larger = |a: f64, b: f64| if b <= a { a } else { b };
    let next = AtomicI64::new(least);
    let work = || {
        let mut largest = 0.0_f64;
        loop {
            let first = next.fetch_add(BLOCK * stride, Ordering::Relaxed);
            if first > most {
                return largest;
            }
            let last = (first + BLOCK * stride - 1).min(most);
            for number in (first..=last).step_by(stride as usize) {
                largest = larger(largest, error(number));
            }
        }
    };
    let spaced = thread::scope(|scope| {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        workers.into_iter().map(|worker| worker.join().expect("no panic")).fold(0.0, larger)
    });
    let near = (least..=most.min(least + NEAR)).chain(least.max(most - NEAR)..=most);
    near.map(error).fold(spaced, larger)
}
