//! A neuromuscular prosthesis of the knee in an embassy task, woken by the tick. Other tasks may
//! delay it: for a hard tick, spawn it on an `InterruptExecutor`, or use the RTIC example.
//!
//! The chip is an LM3S6965. It has no floating-point unit: all is in fixed point.
#![no_std]
#![no_main]

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use embassy_executor::Spawner;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use lm3s6965 as _;
use vm_nostd::control::{
    CommandLimits, EnvelopeParams, KNEE, Prosthesis, ProsthesisCommand, ProsthesisInput,
    ProsthesisParams,
};
use vm_nostd::{Fixed, Scalar, TimeStep};

/// Hz; 1 kHz ticks.
const CORE_CLOCK: u32 = 12_000_000;

/// Signals a tick.
static TICK: Signal<CriticalSectionRawMutex, ()> = Signal::new();
/// For the motor's controller.
static COMMAND: Signal<CriticalSectionRawMutex, ProsthesisCommand<Fixed>> = Signal::new();

fn params() -> ProsthesisParams<2> {
    ProsthesisParams {
        range: KNEE.range,
        muscles: KNEE.muscles.map(|muscle| muscle.params()),
        paths: KNEE.muscles.map(|muscle| muscle.path()),
        envelopes: [EnvelopeParams {
            rest: 0.01,
            maximal: 0.5,
            cutoff_frequency: 4.0,
            delay: 0.0,
            shape: -1.0,
        }; 2],
        torque: CommandLimits { least: -120.0, most: 60.0, rate: 1000.0 },
        stiffness: CommandLimits { least: 5.0, most: 300.0, rate: 2000.0 },
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let Some(peripherals) = cortex_m::Peripherals::take() else { return };
    let mut timer = peripherals.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(CORE_CLOCK / 1000 - 1);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();
    if let Ok(task) = step() {
        spawner.spawn(task);
    }
    loop {
        let _command = COMMAND.wait().await;
    }
}

/// Steps the prosthesis in every tick.
#[embassy_executor::task]
async fn step() {
    let angle = Fixed::from_f64(0.5);
    let Ok(prosthesis) = Prosthesis::<Fixed, 2, 0>::build(&params(), TimeStep::MILLISECOND) else {
        return;
    };
    let Ok(mut state) = prosthesis.rest(angle) else { return };
    loop {
        TICK.wait().await;
        // From two amplifiers (mV) and an encoder (rad).
        let emg = [0.1, 0.2].map(Fixed::quantity);
        COMMAND.signal(prosthesis.step(&mut state, ProsthesisInput { emg, angle }));
    }
}

#[exception]
fn SysTick() {
    TICK.signal(());
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
