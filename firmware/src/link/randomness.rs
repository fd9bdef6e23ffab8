//! Random numbers from a part's noise generator, checked as its manual requires.

/// Source of session numbers.
pub trait Randomness {
    /// 32 bits; none if the generator failed. `polls` counts the polls of the link since boot.
    fn number(&mut self, polls: u32) -> Option<u32>;
}

impl<R: Randomness + ?Sized> Randomness for &mut R {
    fn number(&mut self, polls: u32) -> Option<u32> {
        (**self).number(polls)
    }
}

/// Replacement without a generator, as in QEMU: the polls since boot. Repeating a boot to the poll
/// repeats the number; only the host's nonce is then new.
#[derive(Clone, Copy, Debug, Default)]
pub struct PollCount;

impl Randomness for PollCount {
    fn number(&mut self, polls: u32) -> Option<u32> {
        // Neighbours differ in all bits.
        Some(polls.wrapping_mul(0x9E37_79B1))
    }
}

/// Flags of a noise generator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoiseStatus {
    /// A number can be read.
    pub is_ready: bool,
    /// Clock error (too slow or stopped), now or since the flag was cleared.
    pub clock_error: bool,
    /// Noise error (constant or alternating bits), now or since the flag was cleared.
    pub seed_error: bool,
}

/// A noise generator's registers.
pub trait NoiseGenerator {
    /// Its flags.
    fn status(&mut self) -> NoiseStatus;
    /// The number that is ready.
    fn read(&mut self) -> u32;
    /// Clears the error flags and restarts it.
    fn restart(&mut self);
}

/// Most polls for a number, which takes 40 clocks of the generator, less than a µs.
const MOST_POLLS: u32 = 10_000;
/// Restarts for one number before the generator counts as broken.
const MOST_RESTARTS: u32 = 8;

/// Numbers of a noise generator, per RM0090 24.3.1: the first number after a start is only compared
/// with, no number may repeat the last, and a clock or noise error restarts it.
#[derive(Clone, Debug)]
pub struct Noise<G> {
    generator: G,
    before: Option<u32>,
}

impl<G: NoiseGenerator> Noise<G> {
    /// Takes over a generator that is switched on.
    pub const fn new(generator: G) -> Self {
        Self { generator, before: None }
    }
}

impl<G: NoiseGenerator> Randomness for Noise<G> {
    fn number(&mut self, _polls: u32) -> Option<u32> {
        let mut restarts = 0;
        for _ in 0..MOST_POLLS {
            let NoiseStatus { is_ready, clock_error, seed_error } = self.generator.status();
            if !(clock_error || seed_error) {
                if !is_ready {
                    continue;
                }
                let number = self.generator.read();
                match self.before.replace(number) {
                    None => continue,
                    Some(before) if before != number => return Some(number),
                    Some(_repeated) => (),
                }
            }
            self.before = None;
            self.generator.restart();
            restarts += 1;
            if restarts > MOST_RESTARTS {
                break;
            }
        }
        None
    }
}
