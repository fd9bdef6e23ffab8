//! A neuromuscular prosthesis of the knee in a hard RTIC tick: two EMGs and an angle in, torque and
//! stiffness out.
//!
//! The chip is an LM3S6965, whose peripheral crate is small. It has no floating-point unit: all is
//! in fixed point.
#![no_std]
#![no_main]

#[rtic::app(device = lm3s6965, peripherals = true)]
mod app {
    use cortex_m::peripheral::syst::SystClkSource;
    use vm_nostd::control::{
        CommandLimits, EnvelopeParams, KNEE, Prosthesis, ProsthesisCommand, ProsthesisInput,
        ProsthesisParams, ProsthesisState,
    };
    use vm_nostd::{Fixed, Scalar, TimeStep};

    /// Hz; 1 kHz ticks.
    const CORE_CLOCK: u32 = 12_000_000;

    #[shared]
    struct Shared {
        /// For the motor's controller.
        command: Option<ProsthesisCommand<Fixed>>,
    }

    #[local]
    struct Local {
        prosthesis: Prosthesis<Fixed, 2, 0>,
        state: ProsthesisState<Fixed, 2, 0>,
    }

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

    #[init]
    fn init(context: init::Context) -> (Shared, Local) {
        let angle = Fixed::from_f64(0.5);
        let built = Prosthesis::build(&params(), TimeStep::MILLISECOND)
            .ok()
            .and_then(|prosthesis| Some((prosthesis, prosthesis.rest(angle).ok()?)));
        // The parameters are constants: an error here is found in the first run.
        let Some((prosthesis, state)) = built else {
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
        (Shared { command: None }, Local { prosthesis, state })
    }

    /// Runs every millisecond; deadline: the next one.
    #[task(binds = SysTick, priority = 2, local = [prosthesis, state], shared = [command])]
    fn tick(mut context: tick::Context) {
        // From two amplifiers (mV) and an encoder (rad).
        let emg = [0.1, 0.2].map(Fixed::quantity);
        let input = ProsthesisInput { emg, angle: Fixed::from_f64(0.5) };
        let stepped = context.local.prosthesis.step(context.local.state, input);
        context.shared.command.lock(|command| *command = Some(stepped));
    }

    /// Low-priority work.
    #[idle(shared = [command])]
    fn idle(mut context: idle::Context) -> ! {
        loop {
            let _command = context.shared.command.lock(|command| *command);
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
