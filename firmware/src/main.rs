//! The firmware: a 1 kHz SysTick interrupt steps two muscles through the compiled-in scenario,
//! and the bits of every tick leave through semihosting, little-endian frames on standard
//! output.
#![no_std]
#![no_main]

mod board;

use core::cell::RefCell;
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m_rt::{entry, exception};
use cortex_m_semihosting::hio;
use critical_section::Mutex;
use firmware::{Record, Rig, Scenario, TICKS, end, frame_words};
use heapless::spsc::{Consumer, Producer, Queue};

/// All bits that a tick leaves.
type Frame = [u32; frame_words::<f32>()];

/// Frames that can wait between the tick and the host: the tick itself never waits.
const WAITING: usize = 64;

/// Hands the tick's own half over to the interrupt, once.
static HANDOVER: Mutex<RefCell<Option<Tick>>> = Mutex::new(RefCell::new(None));

/// What the interrupt owns.
struct Tick {
    rig: Rig<f32>,
    outlet: Outlet,
}

/// A frame found the queue full. The run is then worthless, and ends with a failure.
static LOST: AtomicBool = AtomicBool::new(false);

/// The producing end of the queue.
struct Outlet(Producer<'static, Frame>);

impl Record for Outlet {
    fn record(&mut self, words: impl Iterator<Item = u32>) {
        let mut frame: Frame = [0; _];
        frame.iter_mut().zip(words).for_each(|(place, word)| *place = word);
        if self.0.enqueue(frame).is_err() {
            LOST.store(true, Ordering::Relaxed);
        }
    }
}

#[entry]
fn main() -> ! {
    static mut QUEUE: Queue<Frame, WAITING> = Queue::new();
    let (producer, consumer) = QUEUE.split();
    let ready = Rig::at_rest(Scenario::RESTING_PATH).ok().zip(cortex_m::Peripherals::take());
    let Some((rig, peripherals)) = ready else { end::finish(false) };
    let tick = Tick { rig, outlet: Outlet(producer) };
    critical_section::with(|cs| HANDOVER.replace(cs, Some(tick)));
    board::start_tick(peripherals);
    end::finish(report(consumer).is_ok())
}

/// Sends every frame of the scenario to the host.
fn report(mut frames: Consumer<'static, Frame>) -> Result<(), ()> {
    let mut host = hio::hstdout()?;
    let mut sent = 0;
    while sent < TICKS {
        if LOST.load(Ordering::Relaxed) {
            return Err(());
        }
        let Some(frame) = frames.dequeue() else {
            cortex_m::asm::wfi();
            continue;
        };
        let mut bytes = [0; size_of::<Frame>()];
        for (place, word) in bytes.chunks_exact_mut(4).zip(frame) {
            place.copy_from_slice(&word.to_le_bytes());
        }
        host.write_all(&bytes)?;
        sent += 1;
    }
    Ok(())
}

/// The tick. Deadline: the next one, 1 ms on.
#[exception]
fn SysTick() {
    static mut TICK: Option<Tick> = None;
    if TICK.is_none() {
        *TICK = critical_section::with(|cs| HANDOVER.take(cs));
    }
    if let Some(tick) = TICK
        && tick.rig.ticks() < TICKS
    {
        tick.rig.tick(&mut Scenario, &mut tick.outlet);
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    end::finish(false)
}
