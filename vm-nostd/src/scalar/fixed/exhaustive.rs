//! Largest error of a kernel over all its arguments, for tests.

use std::sync::atomic::{AtomicI64, Ordering};
use std::thread;

pub(super) const UNIT: f64 = (1_u32 << 24) as f64;

/// Step between arguments. With overflow checks, testing all arguments would take too long.
const STEP: usize = if cfg!(debug_assertions) { 1009 } else { 1 };

/// Largest `error` over all arguments from `least` to `most`, inclusive, computed on all cores; NaN
/// if any error is NaN.
pub(super) fn largest_error(least: i64, most: i64, error: impl Fn(i64) -> f64 + Sync) -> f64 {
    const BLOCK: i64 = 1 << 20;
    let next = AtomicI64::new(least);
    let work = || {
        let mut largest = 0.0_f64;
        loop {
            let first = next.fetch_add(BLOCK, Ordering::Relaxed);
            if first > most {
                return largest;
            }
            for number in (first..(first + BLOCK).min(most + 1)).step_by(STEP) {
                let error = error(number);
                // Keeps NaN.
                largest = if error <= largest { largest } else { error };
            }
        }
    };
    thread::scope(|scope| {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .map(|worker| worker.join().expect("no panic"))
            .fold(0.0, |a, b| if b <= a { a } else { b })
    })
}

/// Largest `error` over all Q8.24 numbers between two whole numbers, and over every 4099th number
/// of the entire range: outside the interval a kernel is constant or the identity.
pub(super) fn largest_error_between(
    least: i64,
    most: i64,
    error: impl Fn(i32) -> f64 + Sync,
) -> f64 {
    const SPACE: i64 = 4099;
    let every = largest_error(least << 24, most << 24, |number| error(number as i32));
    let all = i64::from(i32::MIN) / SPACE..=i64::from(i32::MAX) / SPACE;
    let spaced = largest_error(*all.start(), *all.end(), |place| error((place * SPACE) as i32));
    let ends = [i32::MIN, i32::MIN + 1, i32::MAX - 1, i32::MAX].map(error);
    // Keeps NaN.
    ends.into_iter().chain([spaced]).fold(every, |a, b| if b <= a { a } else { b })
}

/// Reproducible pseudo-random numbers of any magnitude.
pub(super) fn random_numbers() -> impl Iterator<Item = i32> {
    let mut state = 1_u64;
    core::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 32) as i32 >> (state >> 27 & 31)
    })
}
