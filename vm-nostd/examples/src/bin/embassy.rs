//! A muscle in an embassy task, woken by the tick. Other tasks may delay it: for a hard tick, spawn
//! it on an `InterruptExecutor`, or use the RTIC example.
//!
//! The chip is an LM3S6965. It has no floating-point unit: the muscle is in fixed point.
#![no_std]
#![no_main]

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use embassy_executor::Spawner;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use lm3s6965 as _;
use vm_nostd::paper_table_1::{ELEMENTS, FAST, SLOW};
use vm_nostd::{Class, ContinuousMuscle, FiberParams, Fixed, Input, MuscleParams, TimeStep};

const PARAMS: MuscleParams<2> = MuscleParams {
    mass: 97.5e-3,
    fascicle_length: 0.11,
    tendon_length: 0.02,
    max_path_length: 0.184,
    recruitment_saturation: 0.8,
    class: Class::Standard,
    elements: ELEMENTS,
    fibers: [
        FiberParams { fraction: 0.6, fiber_type: SLOW },
        FiberParams { fraction: 0.4, fiber_type: FAST },
    ],
};
/// Hz; 1 kHz ticks.
const CORE_CLOCK: u32 = 12_000_000;
/// Initial path length, µm.
const PATH_UM: i32 = 160_000;

/// Signals a tick.
static TICK: Signal<CriticalSectionRawMutex, ()> = Signal::new();
/// Force of the last tick, mN.
static FORCE: Signal<CriticalSectionRawMutex, i32> = Signal::new();

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
        let _force = FORCE.wait().await;
    }
}

/// Steps a muscle in every tick.
#[embassy_executor::task]
async fn step() {
    let rest = Input::<Fixed>::from_integers(0, PATH_UM, 0);
    let built = ContinuousMuscle::<Fixed, 2>::build(&PARAMS, TimeStep::MILLISECOND)
        .and_then(|muscle| Ok((muscle, muscle.rest(rest.path_length)?)));
    let Ok((muscle, mut state)) = built else { return };
    loop {
        TICK.wait().await;
        // From a sensor and a controller.
        let input = Input::<Fixed>::from_integers(500, PATH_UM, 0);
        FORCE.signal(muscle.step(&mut state, input).force);
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
