//! The stimulator: three interrupt levels, of which none waits for another, and idle.
//!
//! A byte comes faster than a tick ends, so that its interrupt is above the tick. It only puts the
//! byte into a queue for idle.
//!
//! | priority | task | by |
//! |---:|---|---|
//! | 4 | pulses | the pulse timer |
//! | 3 | bytes from the host | the serial port |
//! | 2 | muscles and supervision | the tick |
//! | 0 | link, storage, log | idle |
#![no_std]
#![no_main]

mod board;
mod fault_handlers;

#[rtic::app(device = crate::board::pac, peripherals = true)]
mod app {
    use crate::board::{
        self, Board, Converter, EmulatedFlash, FromHost, Memory, Numbers, Pin, PulseTimer,
        Received, TickTimer, ToHost, Watchdog, pac,
    };
    use defmt_rtt as _;
    use firmware::safety::Fault;
    use firmware::{
        Banks, Controller, Deadline, Device, Limits, LinkQueues, Permission, PlanQueue, Pulses,
        SCALE, Server, ServerRoom, TICK_US,
    };
    use heapless::spsc::{Consumer, Producer, Queue};
    use vm_nostd::TimeStep;

    /// The board's limits, validated at compile time.
    const LIMITS: Limits = Limits::SURFACE.within_scale(&SCALE);
    const _: () = assert!(LIMITS.validate(TICK_US, &SCALE).is_ok(), "limits that are none");

    /// Bytes that can wait for the link: several longest frames.
    const WAITING: usize = 4096;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        pulses: Pulses<'static, Converter, Pin>,
        pulse_timer: PulseTimer,
        device: Device<'static>,
        tick_timer: TickTimer,
        watchdog: Watchdog,
        from_host: FromHost,
        received: Producer<'static, Received>,
        arrived: Consumer<'static, Received>,
        to_host: ToHost,
        server: Server<'static, Memory, Numbers>,
    }

    /// Puts the outputs in neutral first. Large values are built in place, not on the stack.
    #[init(local = [
        permission: Permission = Permission::new(),
        plans: PlanQueue = Queue::new(),
        link_queues: LinkQueues = LinkQueues::new(),
        banks: Banks = Banks::new(),
        bytes: Queue<Received, WAITING> = Queue::new(),
        room: ServerRoom = ServerRoom::new(),
        flash: EmulatedFlash = EmulatedFlash::new(),
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources {
            permission, plans, link_queues, banks, bytes, room, flash, ..
        } = context.local;
        let Board {
            stage,
            mut pulse_timer,
            mut tick_timer,
            watchdog,
            to_host,
            from_host,
            memory,
            numbers,
            boot,
        } = Board::start(context.core, context.device, TICK_US, flash);
        // Without an output stage that answers there is nothing to do; it may after a restart.
        let Some(stage) = stage else { board::reset() };
        let Ok(step) = TimeStep::from_seconds(f64::from(TICK_US) * 1e-6) else { board::reset() };
        let permission: &'static Permission = permission;
        let (give_plan, take_plan) = plans.split();
        let (tick_ends, link_ends) = link_queues.split(banks);
        let (received, arrived) = bytes.split();
        let Ok(controller) = Controller::new(LIMITS, TICK_US, boot, SCALE, give_plan, permission)
        else {
            board::reset()
        };
        let deadline = Deadline::new(TICK_US, TickTimer::COUNTS_PER_US);
        let server = Server::new(room, link_ends, permission, memory, numbers, step);
        defmt::info!("a tick of {=u32} us", TICK_US);
        if boot == Fault::Watchdog {
            defmt::warn!("started again by the watchdog");
        }
        pulse_timer.start();
        tick_timer.start();
        let local = Local {
            pulses: Pulses::new(stage, take_plan, permission, TICK_US),
            pulse_timer,
            device: Device::new(controller, tick_ends, deadline),
            tick_timer,
            watchdog,
            from_host,
            received,
            arrived,
            to_host,
            server,
        };
        (Shared {}, local)
    }

    /// A step of the schedule begins, or the tick calls. Deadline: [`firmware::LEAST_PHASE_US`].
    #[task(binds = TIM2, priority = 4, local = [pulses, pulse_timer])]
    fn pulse(context: pulse::Context) {
        let pulse::LocalResources { pulses, pulse_timer, .. } = context.local;
        if !pulse_timer.has_run_out() {
            pulses.attend();
            return;
        }
        let next_us = pulses.timer();
        pulse_timer.set_next(next_us);
        if pulse_timer.is_late() {
            pulses.overran();
        }
    }

    /// The hard tick. Deadline: the next one.
    #[task(binds = SysTick, priority = 2, local = [device, tick_timer, watchdog])]
    fn tick(context: tick::Context) {
        let tick::LocalResources { device, tick_timer, watchdog, .. } = context.local;
        // The one that calls.
        tick_timer.was_due();
        let armed = device.tick(tick_timer.since_due());
        if !armed {
            rtic::pend(pac::Interrupt::TIM2);
        }
        let next_is_due = tick_timer.was_due();
        if device.finish(tick_timer.since_due(), next_is_due) {
            watchdog.feed(armed);
        } else {
            rtic::pend(pac::Interrupt::TIM2);
        }
    }

    /// Receives a byte. A byte takes longer than the pulse that may delay this.
    #[task(binds = USART1, priority = 3, local = [from_host, received])]
    fn receive(context: receive::Context) {
        let receive::LocalResources { from_host, received, .. } = context.local;
        if let Some(byte) = from_host.read() {
            // A host that does not wait for answers loses what it sends; the frame's checksum tells
            // it.
            let _full = received.enqueue(byte);
        }
    }

    /// Link and log. It logs only while disarmed, because logging masks the pulse timer's
    /// interrupt.
    #[idle(local = [arrived, to_host, server])]
    fn idle(context: idle::Context) -> ! {
        let idle::LocalResources { arrived, to_host, server, .. } = context.local;
        let mut was_armed = false;
        loop {
            server.poll();
            let armed = server.is_armed();
            if was_armed && !armed {
                defmt::info!("off");
            }
            was_armed = armed;
            while server.is_ready()
                && let Some(received) = arrived.dequeue()
            {
                match received {
                    Received::Byte(byte) => server.receive(byte),
                    Received::Lost => server.lost(),
                }
            }
            if to_host.is_ready()
                && let Some(byte) = server.transmit()
            {
                to_host.write(byte);
            }
            if to_host.is_emulated() && server.is_idle() {
                rtic::pend(pac::Interrupt::USART1);
            }
            if server.is_idle() && !arrived.ready() {
                cortex_m::asm::wfi();
            }
        }
    }
}

/// Resets the chip: everything is off at boot.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    board::reset()
}
