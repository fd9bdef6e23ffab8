//! The random number generator, which runs on the 48 MHz of the main PLL.

use super::chip::pac::RNG;
use firmware::{Noise, NoiseGenerator, NoiseStatus, PollCount, Randomness};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// The part's registers.
pub struct Generator(RNG);

impl Generator {
    fn switch(&mut self, on: bool) {
        self.0.cr().modify(|_, w| w.rngen().bit(on));
    }
}

impl NoiseGenerator for Generator {
    fn status(&mut self) -> NoiseStatus {
        let status = self.0.sr().read();
        NoiseStatus {
            is_ready: status.drdy().bit_is_set(),
            clock_error: status.cecs().bit_is_set() || status.ceis().bit_is_set(),
            seed_error: status.secs().bit_is_set() || status.seis().bit_is_set(),
        }
    }

    fn read(&mut self) -> u32 {
        self.0.dr().read().rndata().bits()
    }

    fn restart(&mut self) {
        // Both are cleared by a 0.
        self.0.sr().modify(|_, w| w.ceis().clear_bit().seis().clear_bit());
        self.switch(false);
        self.switch(true);
    }
}

/// Where the numbers of sessions come from.
pub enum Numbers {
    /// The generator.
    Generator(Noise<Generator>),
    /// An emulator, which has none.
    PollCount(PollCount),
}

impl Numbers {
    pub(super) fn new(generator: RNG, rcc: &mut Rcc, is_emulated: bool) -> Self {
        if is_emulated {
            return Self::PollCount(PollCount);
        }
        RNG::enable(rcc);
        RNG::reset(rcc);
        let mut generator = Generator(generator);
        generator.switch(true);
        Self::Generator(Noise::new(generator))
    }
}

impl Randomness for Numbers {
    fn number(&mut self, polls: u32) -> Option<u32> {
        match self {
            Self::Generator(noise) => noise.number(polls),
            Self::PollCount(count) => count.number(polls),
        }
    }
}
