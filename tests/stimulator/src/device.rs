//! The whole firmware but its chip, in this process: a line for the host's end of the link.

use crate::electrodes::{CHANNELS, Converter, Pin, SCALE, Shared, stage};
use embedded_storage::nor_flash::MultiwriteNorFlash;
use firmware::safety::Fault;
use firmware::{
    Controller, Deadline, Device, Limits, LinkQueues, Permission, PlanQueue, Pulses, RamFlash,
    Randomness, Server,
};
use std::collections::VecDeque;
use std::io::{Error, ErrorKind, Read, Result, Write};
use vm_nostd::TimeStep;

/// Memory for two slots.
pub type Memory = RamFlash<8192>;
/// Of the board that the tests have.
pub const LIMITS: Limits = Limits::SURFACE.within_scale(&SCALE);

/// As a part's generator of a boot: other numbers from another seed.
pub struct Numbers(pub u32);

impl Randomness for Numbers {
    fn number(&mut self, _polls: u32) -> Option<u32> {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        Some(self.0 ^ (self.0 >> 16))
    }
}

/// A tick, µs; the timer that calls for ticks counts these.
const TICK: u32 = 1000;
/// A host that hears nothing for so many ticks is told so.
const SILENT_TICKS: u32 = 300;

/// A device and the time. It only passes while the host reads.
pub struct InProcess<F> {
    server: Server<'static, F, &'static mut dyn Randomness>,
    device: Device<'static>,
    pulses: Pulses<'static, Converter, Pin>,
    /// What it does to a patient.
    pub electrodes: Shared,
    /// Bytes on their way to the device.
    arriving: VecDeque<u8>,
    ticks: u32,
    timer: u32,
    step_us: u32,
    /// The most counts at the electrodes since it was asked for.
    flowed: u16,
    /// Channels that carried it.
    carried: [bool; CHANNELS],
}

impl<F: MultiwriteNorFlash> InProcess<F> {
    /// At boot, with what its memory holds.
    pub fn boot(memory: F) -> Self {
        Self::boot_with(memory, LIMITS)
    }

    /// The same with other limits.
    pub fn boot_with(memory: F, limits: Limits) -> Self {
        Self::boot_of(memory, limits, Box::new(Numbers(0x0DD5_EED5)))
    }

    /// The same with another source of randomness.
    pub fn boot_of(memory: F, limits: Limits, randomness: Box<dyn Randomness>) -> Self {
        let (stage, electrodes) = stage();
        // As statics of a firmware are.
        let plans: &'static mut PlanQueue = Box::leak(Box::default());
        let permission: &'static Permission = Box::leak(Box::default());
        let link_queues: &'static mut LinkQueues = Box::leak(Box::default());
        let randomness: &'static mut dyn Randomness = Box::leak(randomness);
        let (give, take) = plans.split();
        let (tick_ends, link_ends) = link_queues.split(Box::leak(Box::default()));
        let controller = Controller::new(limits, TICK, Fault::Boot, SCALE, give, permission)
            .expect("valid limits");
        Self {
            server: Server::new(
                Box::leak(Box::default()),
                link_ends,
                permission,
                memory,
                randomness,
                TimeStep::MILLISECOND,
            ),
            device: Device::new(controller, tick_ends, Deadline::new(TICK, 1)),
            pulses: Pulses::new(stage, take, permission, TICK),
            electrodes,
            arriving: VecDeque::new(),
            ticks: 0,
            timer: 0,
            step_us: Pulses::<Converter, Pin>::FIRST_US,
            flowed: 0,
            carried: [false; CHANNELS],
        }
    }

    /// A tick, and all that pulse timer and link do until the next one.
    pub fn tick(&mut self) {
        self.tick_that_takes(100, false);
    }

    /// The same, but that it ends after the next one was due.
    pub fn tick_late(&mut self) {
        self.tick_that_takes(10, true);
    }

    fn tick_that_takes(&mut self, counts: u32, next_is_due: bool) {
        let armed = self.device.tick(0);
        if !self.device.finish(counts, next_is_due) || !armed {
            self.electrodes.borrow_mut().words = 0;
            self.pulses.attend();
        }
        self.ticks += 1;
        self.see();
        while self.timer < self.ticks * TICK {
            self.timer += self.step_us;
            self.electrodes.borrow_mut().words = 0;
            self.step_us = self.pulses.timer();
            self.see();
        }
        self.server.poll();
        while self.server.is_ready()
            && let Some(byte) = self.arriving.pop_front()
        {
            self.server.receive(byte);
        }
    }

    /// Takes bytes in which the line has lost one, before so many of them.
    pub fn receive_with_a_loss(&mut self, bytes: &[u8], before: usize) {
        for (index, &byte) in bytes.iter().enumerate() {
            if index == before {
                self.server.lost();
            }
            self.server.receive(byte);
        }
    }

    fn see(&mut self) {
        let electrodes = self.electrodes.borrow();
        assert!(electrodes.problems.is_empty(), "{:?}", electrodes.problems);
        if electrodes.cathodic || electrodes.anodic {
            self.flowed = self.flowed.max(electrodes.counts);
            for (carried, connected) in self.carried.iter_mut().zip(electrodes.channels) {
                *carried |= connected && electrodes.counts > 0;
            }
        }
    }

    /// Ticks since boot.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Whether its link has nothing to do.
    pub fn is_idle(&self) -> bool {
        self.server.is_idle()
    }

    /// Takes what it has to say, without the time's passing.
    pub fn drain(&mut self) {
        while self.server.transmit().is_some() {}
    }

    /// The most counts that have flowed since this was asked last.
    pub fn flowed(&mut self) -> u16 {
        std::mem::take(&mut self.flowed)
    }

    /// The channels that current has flowed through since this was asked last.
    pub fn carried(&mut self) -> [bool; CHANNELS] {
        std::mem::take(&mut self.carried)
    }

    /// The line loses a byte.
    pub fn lose(&mut self) {
        self.server.lost();
    }

    /// The power fails; what is left is the memory.
    pub fn into_memory(self) -> F {
        self.server.into_memory()
    }
}

impl<F: MultiwriteNorFlash> Read for InProcess<F> {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize> {
        for _ in 0..SILENT_TICKS {
            let mut length = 0;
            while length < bytes.len()
                && let Some(byte) = self.server.transmit()
            {
                bytes[length] = byte;
                length += 1;
            }
            if length > 0 {
                return Ok(length);
            }
            self.tick();
        }
        Err(Error::from(ErrorKind::TimedOut))
    }
}

impl<F: MultiwriteNorFlash> Write for InProcess<F> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.arriving.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}
