//! A muscle in a hard RTIC tick, which interrupts everything else.
//!
//! The chip is an LM3S6965, whose peripheral crate is small. It has no floating-point unit: the
//! muscle is in fixed point.
#![no_std]
#![no_main]

#[rtic::app(device = lm3s6965, peripherals = true)]
mod app {
    use cortex_m::peripheral::syst::SystClkSource;
    use vm_nostd::paper_table_1::{ELEMENTS, FAST, SLOW};
    use vm_nostd::{
        Class, FesMuscle, FiberParams, Fixed, Input, IntramuscularFes, MuscleParams, State,
        TimeStep,
    };

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

    #[shared]
    struct Shared {
        /// Force of the last tick, mN.
        force: i32,
    }

    #[local]
    struct Local {
        muscle: FesMuscle<Fixed, 2>,
        state: State<Fixed, IntramuscularFes, 2>,
    }

    #[init]
    fn init(context: init::Context) -> (Shared, Local) {
        let rest = Input::<Fixed>::from_integers(0, PATH_UM, 0);
        let built = FesMuscle::build(&PARAMS, TimeStep::MILLISECOND)
            .and_then(|muscle| Ok((muscle, muscle.rest(rest.path_length)?)));
        // The parameters are constants: an error here is found in the first run.
        let Ok((muscle, state)) = built else {
            loop {
                cortex_m::asm::wfi();
            }
        };
        let mut timer = context.core.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(CORE_CLOCK / 1000 - 1);
        timer.clear_current();
        timer.enable_counter();
        timer.enable_interrupt();
        (Shared { force: 0 }, Local { muscle, state })
    }

    /// Runs every millisecond; deadline: the next one.
    #[task(binds = SysTick, priority = 2, local = [muscle, state], shared = [force])]
    fn tick(mut context: tick::Context) {
        // From a sensor and the stimulator.
        let input = Input::<Fixed>::from_integers(500, PATH_UM, 250);
        let output = context.local.muscle.step(context.local.state, input);
        context.shared.force.lock(|force| *force = output.force);
    }

    /// Low-priority work.
    #[idle(shared = [force])]
    fn idle(mut context: idle::Context) -> ! {
        loop {
            let _force = context.shared.force.lock(|force| *force);
            cortex_m::asm::wfi();
        }
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
