//! Numbers that nobody can foretell, from a part's noise generator: checked as its manual asks.

/// Where the numbers of sessions come from.
pub trait Randomness {
    /// 32 bits; none if the generator gives none. `polls` is how often the link was looked after since boot.
    fn number(&mut self, polls: u32) -> Option<u32>;
}

impl<R: Randomness + ?Sized> Randomness for &mut R {
    fn number(&mut self, polls: u32) -> Option<u32> {
        (**self).number(polls)
    }
}

/// What there is where there is no generator, as in an emulator: the polls since boot. Whoever repeats a boot to
/// the poll repeats the number; only what the host adds to it is then new.
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
    /// Its clock is too slow or has stopped, now or since the flag was cleared.
    pub clock_error: bool,
    /// Its noise is none: a bit that stays, or alternates; now or since the flag was cleared.
    pub seed_error: bool,
}

/// A noise generator's registers.
pub trait NoiseGenerator {
    /// Its flags.
    fn status(&mut self) -> NoiseStatus;
    /// The number that is ready.
    fn read(&mut self) -> u32;
    /// Clears its error flags, switches it off and on again.
    fn restart(&mut self);
}

/// A number takes 40 of the generator's clocks, less than a µs; a poll takes more than one of the core's.
const MOST_POLLS: u32 = 10_000;
/// A generator that errs as often for one number is broken.
const MOST_RESTARTS: u32 = 8;

/// Numbers of a noise generator. As RM0090 asks (24.3.1), the first after a start is only compared with, no number
/// follows itself, and after an error of its clock or of its noise it starts again.
#[derive(Clone, Debug)]
pub struct Noise<G> {
    generator: G,
    before: Option<u32>,
}

impl<G: NoiseGenerator> Noise<G> {
    /// Takes over a generator that was switched on.
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
