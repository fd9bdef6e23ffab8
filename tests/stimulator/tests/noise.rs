//! Failures of the chip's noise generator, per its manual: a part in this process that errs,
//! repeats itself or gives nothing.

use firmware::{Noise, NoiseGenerator, NoiseStatus, Randomness};
use std::collections::VecDeque;

/// A generator with scripted flags and numbers.
struct Script {
    looks: VecDeque<NoiseStatus>,
    numbers: VecDeque<u32>,
    restarts: u32,
    /// Flags after the script.
    then: NoiseStatus,
    looked: u32,
}

const READY: NoiseStatus = NoiseStatus { is_ready: true, clock_error: false, seed_error: false };
const SEED: NoiseStatus = NoiseStatus { seed_error: true, ..READY };
const CLOCK: NoiseStatus = NoiseStatus { clock_error: true, ..READY };

impl NoiseGenerator for &mut Script {
    fn status(&mut self) -> NoiseStatus {
        self.looked += 1;
        self.looks.pop_front().unwrap_or(self.then)
    }

    fn read(&mut self) -> u32 {
        self.numbers.pop_front().expect("a number that is there")
    }

    fn restart(&mut self) {
        self.restarts += 1;
    }
}

fn script(looks: &[NoiseStatus], numbers: &[u32], then: NoiseStatus) -> Script {
    let (looks, numbers) = (looks.iter().copied().collect(), numbers.iter().copied().collect());
    Script { looks, numbers, restarts: 0, then, looked: 0 }
}

#[test]
fn a_generators_first_number_is_not_used_and_none_follows_itself() {
    let mut generator = script(&[], &[1, 2, 3, 3, 4, 5], READY);
    let mut noise = Noise::new(&mut generator);
    assert_eq!(noise.number(0), Some(2));
    assert_eq!(noise.number(0), Some(3));
    // 3 again: it starts again, and 4 is its first.
    assert_eq!(noise.number(0), Some(5));
    assert_eq!(generator.restarts, 1);
}

#[test]
fn a_generator_that_errs_starts_again_and_its_number_is_not_used() {
    for error in [SEED, CLOCK] {
        let mut generator = script(&[READY, error, READY, READY], &[1, 2, 3], READY);
        assert_eq!(Noise::new(&mut generator).number(0), Some(3), "{error:?}");
        assert_eq!(generator.restarts, 1, "{error:?}");
    }
}

#[test]
fn a_generator_that_gives_nothing_is_not_waited_for_for_ever() {
    for then in [NoiseStatus::default(), SEED, CLOCK] {
        let mut generator = script(&[], &[], then);
        assert_eq!(Noise::new(&mut generator).number(0), None, "{then:?}");
        assert!(generator.looked <= 10_000, "{then:?}");
    }
    // It may err eight times for a number.
    for (errors, number) in [(8, Some(2)), (9, None)] {
        let looks = [SEED; 9];
        let mut generator = script(&looks[..errors], &[1, 2], READY);
        assert_eq!(Noise::new(&mut generator).number(0), number, "{errors} errors");
    }
    // Nothing but the same number.
    let mut generator = script(&[], &[7; 100], READY);
    assert_eq!(Noise::new(&mut generator).number(0), None);
}
