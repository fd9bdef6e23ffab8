//! The chip and its pins: an STM32F405. Only this file and its folder name the chip.
//!
//! | what | where |
//! |---|---|
//! | converter (like MCP4921; no readback) | SPI1: SCK PA5, MOSI PA7, chip select PA4 |
//! | bridge | cathodic PB0, anodic PB1 |
//! | channels | PC0, PC1, PC2, PC3 |
//! | link | USART1: TX PA9, RX PA10, 460,800 Bd |
//! | pulse timer, tick | TIM2, SysTick |
//! | crystal | 8 MHz |
//! | stored muscles | the last two sectors of flash, 128 KiB each |
//!
//! The same image runs in QEMU, whose chip has no clock control: [`is_emulated`] tells them apart.

mod chip;
mod memory;
mod noise;
mod watchdog;

use chip::{CORE_CLOCK, is_emulated};
pub use chip::{pac, reset};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use embedded_hal_bus::spi::{ExclusiveDevice, NoDelay};
use firmware::flash::Flash;
use firmware::safety::{CHANNELS, Fault};
use firmware::{Bridge, LEAST_PHASE_US, OutputStage, Pulses};
pub use memory::{EmulatedFlash, Memory};
pub use noise::Numbers;
use stm32f4xx_hal::gpio::{ErasedPin, Output, PushPull, Speed};
use stm32f4xx_hal::nb;
use stm32f4xx_hal::pac::{SPI1, TIM2, USART1};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{self, Rcc};
use stm32f4xx_hal::serial::{Config, Rx, Serial, Tx};
use stm32f4xx_hal::spi::{self, Spi};
pub use watchdog::Watchdog;

/// An output pin.
pub type Pin = ErasedPin<Output<PushPull>>;
/// The converter.
pub type Converter = ExclusiveDevice<Spi<SPI1>, Pin, NoDelay>;
/// The output stage.
pub type Stage = OutputStage<Converter, Pin, CHANNELS>;

/// Baud rate of the link. A byte takes 21.7 µs: longer than the pulse timer's interrupt, which
/// alone may delay its own, and whose deadline is the shortest phase. None is lost.
const BAUD: u32 = 460_800;
const _: () = assert!(10_000_000 / BAUD > LEAST_PHASE_US, "bytes that the pulse timer loses");

/// The emulator's TIM2 counts ns.
const EMULATED_TIMER_CLOCK: u32 = 1_000_000_000;

/// The board's peripherals, in neutral.
pub struct Board {
    /// Output stage, in neutral; none if it does not answer.
    pub stage: Option<Stage>,
    /// Stopped.
    pub pulse_timer: PulseTimer,
    /// Stopped.
    pub tick_timer: TickTimer,
    /// Running.
    pub watchdog: Watchdog,
    /// To the host.
    pub to_host: ToHost,
    /// From the host.
    pub from_host: FromHost,
    /// Non-volatile memory.
    pub memory: Memory,
    /// Source of session numbers.
    pub numbers: Numbers,
    /// Cause of the boot.
    pub boot: Fault,
}

impl Board {
    /// Initialises the outputs first, then the rest; ticks of `tick_us` µs.
    pub fn start(
        mut core: cortex_m::Peripherals,
        device: pac::Peripherals,
        tick_us: u32,
        ram: &'static mut EmulatedFlash,
    ) -> Self {
        let is_emulated = is_emulated(&device.RCC);
        let watchdog_reset = device.RCC.csr().read().wdgrstf().bit_is_set();
        device.RCC.csr().modify(|_, w| w.rmvf().set_bit());
        let watchdog = Watchdog::start(device.IWDG, tick_us);
        let mut rcc = device.RCC.constrain();

        let a = device.GPIOA.split(&mut rcc);
        let b = device.GPIOB.split(&mut rcc);
        let c = device.GPIOC.split(&mut rcc);
        // Low from the moment they are outputs; until then, resistors of the board keep them so.
        let bridge = Bridge {
            cathodic: b.pb0.into_push_pull_output().erase(),
            anodic: b.pb1.into_push_pull_output().erase(),
        };
        let channels = [
            c.pc0.into_push_pull_output().erase(),
            c.pc1.into_push_pull_output().erase(),
            c.pc2.into_push_pull_output().erase(),
            c.pc3.into_push_pull_output().erase(),
        ];
        let mut select: Pin = a.pa4.into_push_pull_output().erase();
        select.set_high();
        if !is_emulated {
            // Without its crystal it stays here, in neutral, until the watchdog starts it again.
            // 48 MHz for the random number generator: the PLL's 336 MHz by 7, as 168 MHz are by 2.
            rcc = rcc.freeze(rcc::Config::hse(8.MHz()).sysclk(CORE_CLOCK.Hz()).require_pll48clk());
            // Flash is waited for by this clock.
            core.DCB.enable_trace();
            core.DWT.enable_cycle_counter();
            // A crystal that fails later is an interrupt that cannot be masked: a reset.
            rcc.cr().modify(|_, w| w.csson().set_bit());
        }

        let clock = a.pa5.into_alternate().speed(Speed::High);
        let data = a.pa7.into_alternate().speed(Speed::High);
        let mode = spi::Mode {
            polarity: spi::Polarity::IdleLow,
            phase: spi::Phase::CaptureOnFirstTransition,
        };
        let nothing = None::<stm32f4xx_hal::gpio::Pin<'A', 6>>;
        let bus =
            Spi::new(device.SPI1, (Some(clock), nothing, Some(data)), mode, 10.MHz(), &mut rcc);
        let stage = ExclusiveDevice::new_no_delay(bus, select)
            .ok()
            .and_then(|converter| OutputStage::new(converter, bridge, channels).ok());

        let serial = Serial::new(
            device.USART1,
            (a.pa9, a.pa10),
            Config::default().baudrate(BAUD.bps()),
            &mut rcc,
        );
        // Refused only for a rate that this clock cannot make; the watchdog is not fed then, and
        // nothing runs.
        let (to_host, mut from_host) = serial.map_or_else(|_| reset(), Serial::split);
        from_host.listen();

        Self {
            stage,
            pulse_timer: PulseTimer::new(device.TIM2, &mut rcc, is_emulated),
            tick_timer: TickTimer::new(core.SYST, tick_us),
            watchdog,
            to_host: ToHost { line: to_host, is_emulated },
            from_host: FromHost { line: from_host, is_emulated },
            memory: if is_emulated {
                Memory::Ram(ram)
            } else {
                Memory::Flash(Flash::new(memory::Controller::new(device.FLASH)))
            },
            numbers: Numbers::new(device.RNG, &mut rcc, is_emulated),
            boot: if watchdog_reset { Fault::Watchdog } else { Fault::Boot },
        }
    }
}

/// Received by the serial port.
#[derive(Clone, Copy)]
pub enum Received {
    /// A byte.
    Byte(u8),
    /// A byte was lost or damaged.
    Lost,
}

/// The serial port's receiver.
pub struct FromHost {
    line: Rx<USART1>,
    is_emulated: bool,
}

impl FromHost {
    /// Next received byte, if any. Called by the interrupt of a byte and, if
    /// [`ToHost::is_emulated`], before idle waits.
    pub fn read(&mut self) -> Option<Received> {
        let received = match self.line.read() {
            Ok(byte) => Some(Received::Byte(byte)),
            Err(nb::Error::Other(_)) => Some(Received::Lost),
            Err(nb::Error::WouldBlock) => None,
        };
        if self.is_emulated {
            // QEMU has no baud rate: a whole frame would interrupt one tick, of which a line
            // delivers a byte in 21.7 µs. The next byte interrupts after idle has run.
            match received {
                Some(_) => self.line.unlisten(),
                None => self.line.listen(),
            }
        }
        received
    }
}

/// The serial port's transmitter.
pub struct ToHost {
    line: Tx<USART1>,
    is_emulated: bool,
}

impl ToHost {
    /// Whether it can take a byte.
    pub fn is_ready(&self) -> bool {
        self.line.is_tx_empty()
    }

    /// Sends a byte.
    pub fn write(&mut self, byte: u8) {
        let _it_was_ready = self.line.write(byte);
    }

    /// Whether the line is QEMU's.
    pub fn is_emulated(&self) -> bool {
        self.is_emulated
    }
}

/// Timer of the schedule's steps.
///
/// Its reload is buffered: a value written during a step takes effect at its end, so that the delay
/// of an interrupt does not change the duration of a phase.
pub struct PulseTimer {
    timer: TIM2,
    is_emulated: bool,
}

impl PulseTimer {
    fn new(timer: TIM2, rcc: &mut Rcc, is_emulated: bool) -> Self {
        use rcc::{Enable, Reset};
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        let clock = if is_emulated { EMULATED_TIMER_CLOCK } else { rcc.clocks.timclk1().raw() };
        let count = timer.cnt().read().cnt().bits();
        // Counts µs; 16 bits are enough for either.
        timer.psc().write(|w| w.psc().set((clock / 1_000_000 - 1) as u16));
        if is_emulated {
            // To every alarm, QEMU's adds the time at which its count was 0. That stays the time of
            // reset if the count goes on from the ns there were before.
            timer.cnt().write(|w| w.cnt().set(count / 1000));
        }
        timer.arr().write(|w| w.arr().set(Pulses::<Converter, Pin>::FIRST_US - 1));
        timer.cr1().modify(|_, w| w.arpe().set_bit());
        timer.dier().modify(|_, w| w.uie().set_bit());
        Self { timer, is_emulated }
    }

    /// Starts with the first step.
    pub fn start(&mut self) {
        if !self.is_emulated {
            // Takes over prescaler and reload, which are buffered.
            self.timer.egr().write(|w| w.ug().set_bit());
        }
        self.timer.sr().modify(|_, w| w.uif().clear_bit());
        self.timer.cr1().modify(|_, w| w.cen().set_bit());
        // The emulator's alarm may have gone by before anything listened.
        self.set_next(Pulses::<Converter, Pin>::FIRST_US);
    }

    /// Whether it has expired since the last call.
    pub fn has_run_out(&mut self) -> bool {
        let has = self.timer.sr().read().uif().bit_is_set();
        if has {
            self.timer.sr().modify(|_, w| w.uif().clear_bit());
        }
        has
    }

    /// Whether it has expired again; does not clear that.
    pub fn is_late(&self) -> bool {
        self.timer.sr().read().uif().bit_is_set()
    }

    /// Sets the duration of the step after the current one, µs.
    pub fn set_next(&mut self, duration_us: u32) {
        self.timer.arr().write(|w| w.arr().set(duration_us.saturating_sub(1)));
    }
}

/// Timer of ticks: counts down the core clock.
pub struct TickTimer {
    timer: SYST,
    reload: u32,
}

impl TickTimer {
    /// Counts per µs.
    pub const COUNTS_PER_US: u32 = CORE_CLOCK / 1_000_000;

    fn new(mut timer: SYST, tick_us: u32) -> Self {
        let reload = tick_us * Self::COUNTS_PER_US - 1;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(reload);
        timer.clear_current();
        Self { timer, reload }
    }

    /// Starts; the first tick is due after a whole period.
    pub fn start(&mut self) {
        self.timer.enable_counter();
        self.timer.enable_interrupt();
    }

    /// Counts since the last tick was due.
    pub fn since_due(&self) -> u32 {
        self.reload.saturating_sub(SYST::get_current())
    }

    /// Whether a tick was due since the last call.
    pub fn was_due(&mut self) -> bool {
        self.timer.has_wrapped()
    }
}
