//! A controller and its pulse timer on fake electrodes, ticked by a test, without link and muscles.

use crate::device::LIMITS as BOARD;
use crate::electrodes::{Converter, Pin, SCALE, Shared, stage};
use firmware::safety::{Fault, Observed, Requested};
use firmware::{Controller, Limits, Permission, PlanQueue, Pulses, Stimulus};

/// What a test does to observation and request of a tick, counted from when it was injected.
pub type Inject = Box<dyn FnMut(&mut Observed, &mut Requested, u32)>;

/// A pulse at the electrodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PutOut {
    /// When its stimulating phase began, µs.
    pub at_us: u32,
    /// Its channel.
    pub channel: usize,
    /// Of that phase.
    pub counts: u16,
}

/// A controller and its pulse timer on fakes, and the time.
pub struct Bench {
    /// The half that the tick drives.
    pub controller: Controller<'static>,
    /// The half that the pulse timer drives.
    pub pulses: Pulses<'static, Converter, Pin>,
    /// What is at the electrodes.
    pub electrodes: Shared,
    /// Ticks so far.
    pub tick: u32,
    tick_us: u32,
    /// When the pulse timer runs out, µs, and how long the step lasts that begins then.
    pub timer: u32,
    step_us: u32,
    inject: Option<Inject>,
    injected: u32,
    /// The tick is not called.
    pub hangs: bool,
    /// The last tick allowed current.
    pub armed: bool,
    /// Every pulse that was put out.
    pub put_out: Vec<PutOut>,
}

/// Of 40 pps and 200 µs.
pub fn stimulus(amplitude_ua: u32) -> Stimulus {
    Stimulus { amplitude_ua, width_us: 200, gap_us: 50, frequency_tenths_pps: 400, recovery: 1 }
}

/// Long sessions cost time; and each limit is reached before another one.
pub const LIMITS: Limits =
    Limits { session_ms: 5_000, rest_ms: 600, charge_nc: 20_000, rms_ua: 10_000, ..BOARD };

impl Bench {
    /// At boot, with limits that tests reach soon, ticks of 1 ms, and two channels that ask for 20
    /// mA.
    pub fn new(boot: Fault) -> Self {
        Self::with(LIMITS, 1000, boot)
    }

    /// The same with other limits and ticks of so many µs.
    pub fn with(limits: Limits, tick_us: u32, boot: Fault) -> Self {
        let (stage, electrodes) = stage();
        // As statics of a firmware are.
        let queue: &'static mut PlanQueue = Box::leak(Box::default());
        let permission: &'static Permission = Box::leak(Box::default());
        let (give, take) = queue.split();
        let controller = Controller::new(limits, tick_us, boot, SCALE, give, permission);
        Self {
            controller: controller.expect("valid limits"),
            pulses: Pulses::new(stage, take, permission, tick_us),
            electrodes,
            tick: 0,
            tick_us,
            timer: 0,
            step_us: Pulses::<Converter, Pin>::FIRST_US,
            inject: None,
            injected: 0,
            hangs: false,
            armed: false,
            put_out: Vec::new(),
        }
    }

    /// Changes observation and request of each tick from now on.
    pub fn inject(&mut self, inject: impl FnMut(&mut Observed, &mut Requested, u32) + 'static) {
        self.inject = Some(Box::new(inject));
        self.injected = self.tick;
    }

    /// Ends that.
    pub fn inject_nothing(&mut self) {
        self.inject = None;
    }

    /// A tick, and all that the timer does until the next one. True if current can flow at any time
    /// after the tick itself.
    pub fn tick(&mut self) -> bool {
        self.counts() > 0
    }

    /// The same: the most counts while a way for the current is open.
    pub fn counts(&mut self) -> u16 {
        self.control();
        let mut most = self.flowing();
        while self.timer < self.tick * self.tick_us {
            self.run_out();
            most = most.max(self.flowing());
        }
        most
    }

    /// Until the middle of a phase with current, ticks as they come.
    pub fn until_current(&mut self) {
        for _ in 0..10_000 {
            if self.electrodes.borrow().counts > 0 {
                return;
            }
            if self.timer >= self.tick * self.tick_us {
                self.control();
            }
            self.run_out();
        }
        panic!("no current");
    }

    /// The tick itself.
    pub fn control(&mut self) {
        let mut observed = Observed {
            host_heard: self.tick.is_multiple_of(20),
            impedance_ohm: [Some(900), Some(1100), None, None],
            supply_mv: 3700,
            // With the noise that a sensor has.
            path_um: Some(160_000 + (self.tick % 3) as i32),
            path_is_new: true,
            angle: None,
            in_time: true,
            memory_is_intact: true,
            output_answers: true,
        };
        let mut request = Requested {
            stimuli: [Some(stimulus(20_000)), Some(stimulus(20_000)), None, None],
            ..Requested::NOTHING
        };
        if let Some(inject) = &mut self.inject {
            inject(&mut observed, &mut request, self.tick - self.injected);
        }
        if !self.hangs {
            self.armed = self.controller.tick(&observed, &request);
            if !self.armed {
                self.electrodes.borrow_mut().words = 0;
                self.pulses.attend();
            }
        }
        self.tick += 1;
    }

    /// The pulse timer runs out.
    pub fn run_out(&mut self) {
        self.electrodes.borrow_mut().words = 0;
        let before = self.stimulating();
        let at_us = self.timer;
        self.timer += self.step_us;
        self.step_us = self.pulses.timer();
        let now = self.stimulating();
        if let Some((channel, counts)) = now.filter(|_| now != before) {
            self.put_out.push(PutOut { at_us, channel, counts });
        }
    }

    /// The channel that stimulates now, and its counts.
    fn stimulating(&self) -> Option<(usize, u16)> {
        let electrodes = self.electrodes.borrow();
        let channel = electrodes.channels.iter().position(|connected| *connected)?;
        (electrodes.cathodic && electrodes.counts > 0).then_some((channel, electrodes.counts))
    }

    /// Counts of the current that flows now.
    pub fn flowing(&self) -> u16 {
        let electrodes = self.electrodes.borrow();
        assert!(electrodes.problems.is_empty(), "{:?}", electrodes.problems);
        if electrodes.cathodic || electrodes.anodic { electrodes.counts } else { 0 }
    }

    /// Whether any of so many ticks lets current flow.
    pub fn flows(&mut self, ticks: u32) -> bool {
        (0..ticks).fold(false, |flows, _| self.tick() | flows)
    }

    /// Names the fault and arms.
    pub fn arm(&mut self, fault: Fault) {
        self.controller.acknowledge(fault).expect("the fault that is latched");
        self.tick();
        self.controller.arm().expect("nothing is wrong");
    }

    /// Giving pulses of full amplitude.
    pub fn running() -> Self {
        let mut bench = Self::new(Fault::Boot);
        bench.tick();
        bench.arm(Fault::Boot);
        assert!(bench.flows(1000));
        bench
    }
}
