//! A device, a patient and a host that knows what it has said: every answer and every trace is held
//! against the limits.

mod controlled;

use crate::device::{LIMITS as BOARD, Memory, Numbers};
use crate::electrodes::{Converter, Pin, SCALE, Shared, stage};
use crate::host;
use crate::patient::{Bounds, Patient};
use firmware::link::{
    AngleReading, Answer, Electrode, Message, Mode, NO_SESSION, Receiver, Request, RowInputs,
    SessionNumber, Upload, encode,
};
use firmware::safety::{Fault, State};
use firmware::{
    Controller, Deadline, Device, Limits, LinkQueues, Permission, PlanQueue, Pulses, Server,
    Stimulus,
};
use std::collections::{HashMap, VecDeque};
use vm_nostd::TimeStep;
use vm_nostd_cores::MUSCLE;

const TICK: u64 = 1000;

/// Each limit is reached before another one, and soon.
const LIMITS: Limits = Limits {
    amplitude_ua: 40_000,
    width_us: 450,
    frequency_tenths_pps: 800,
    charge_nc: 10_000,
    rms_ua: 5_000,
    rise_ua: 2_000,
    session_ms: 3_000,
    rest_ms: 300,
    silence_ms: 100,
    readings_ms: 200,
    rows_ms: 50,
    drives_ms: 400,
    targets_ms: 50,
    stuck_ms: 500,
    ..BOARD
};

/// The same as the electrodes have it: 50 mA are 4095 counts.
const BOUNDS: Bounds = Bounds {
    counts: 3276,
    width_us: 450,
    charge: 10_000_000 * 4095 / 50_000,
    mean_square: 410 * 410,
    pulses: 80,
    rise: 164,
    session_us: 3_000_000,
    rest_us: 300_000,
    silence_us: 100_000,
    readings_us: 200_000,
    rows_us: 50_000,
    drives_us: 400_000,
    angle_us: 30_000,
    tick_us: TICK,
};

/// The channel of the muscle's electrode.
pub const OF_ROWS: usize = 3;
const ELECTRODE: Electrode = Electrode { channel: OF_ROWS as u8, recovery: 2, ..host::ELECTRODE };

/// µA that recruit an activation, from the definition of the curve.
fn amplitude_ua(activation: f64) -> u32 {
    let half = |activation: f64| {
        let double = 2.0 * activation;
        let t = ELECTRODE.curve.slope * double / (1.0 - double + ELECTRODE.curve.slope * double);
        0.5 * t
    };
    let x = if activation <= 0.5 { half(activation) } else { 1.0 - half(1.0 - activation) };
    let rheobase =
        ELECTRODE.curve.threshold + x * (ELECTRODE.curve.saturation - ELECTRODE.curve.threshold);
    let width = f64::from(ELECTRODE.width_us) * 1e-6;
    // Of the curve in `f32`.
    (rheobase * (1.0 + ELECTRODE.curve.chronaxie / width) * 1e6 * 1.0001) as u32 + 1
}

/// Device, patient, and a host that knows what it has said.
pub struct World {
    server: Server<'static, Memory, Numbers>,
    device: Device<'static>,
    pulses: Pulses<'static, Converter, Pin>,
    electrodes: Shared,
    /// What its electrodes do to it.
    pub patient: Patient,
    /// The time, µs.
    pub now_us: u64,
    /// When the pulse timer runs out, and how long the step lasts that begins then.
    timer_us: u64,
    step_us: u32,
    receiver: Receiver,
    session: SessionNumber,
    sequence: u16,
    /// What waits for its answer.
    pending: Option<Request>,
    answered: bool,
    /// Rows that were sent, from this number on.
    rows: VecDeque<RowInputs>,
    first_row: u32,
    /// Number of the next row.
    pub next_row: u32,
    /// As the last report has it.
    pub state: State,
    /// The next tick ends late.
    pub late: bool,
    /// The path that was read last.
    pub path_um: i32,
    /// When that was read.
    path_read_us: u64,
    /// The newest angle since the last tick, and the last one that a tick took, with its time.
    angle: Option<AngleReading>,
    read: Option<(AngleReading, u64)>,
    /// A controller is loaded.
    pub is_controlled: bool,
    /// The joint's angle, µrad, and when it is read next: the host's own.
    pub angle_urad: i32,
    /// See `angle_urad`.
    pub next_angle_us: u64,
    /// How often each fault was read.
    pub seen: HashMap<Fault, u64>,
}

impl World {
    /// Greeted, with a muscle whose electrode rows stimulate.
    pub fn boot() -> Self {
        let mut world = Self::greeted(&[OF_ROWS]);
        let upload = Upload { mode: Mode::Fes, muscle: MUSCLE, electrode: Some(ELECTRODE) };
        world.ask(Request::Upload { place: 0, upload });
        world.ask(Request::Rest([Some(0.16), None]));
        world
    }

    fn greeted(row_channels: &'static [usize]) -> Self {
        let (stage, electrodes) = stage();
        let plans: &'static mut PlanQueue = Box::leak(Box::default());
        let permission: &'static Permission = Box::leak(Box::default());
        let link_queues: &'static mut LinkQueues = Box::leak(Box::default());
        let (give, take) = plans.split();
        let (tick_ends, link_ends) = link_queues.split(Box::leak(Box::default()));
        let controller = Controller::new(LIMITS, TICK as u32, Fault::Boot, SCALE, give, permission);
        let controller = controller.expect("valid limits");
        let deadline = Deadline::new(TICK as u32, 1);
        let mut world = Self {
            server: Server::new(
                Box::leak(Box::default()),
                link_ends,
                permission,
                Memory::new(),
                Numbers(1),
                TimeStep::MILLISECOND,
            ),
            device: Device::new(controller, tick_ends, deadline),
            pulses: Pulses::new(stage, take, permission, TICK as u32),
            electrodes,
            patient: Patient::new(BOUNDS, row_channels),
            now_us: 0,
            timer_us: 250,
            step_us: Pulses::<Converter, Pin>::FIRST_US,
            receiver: Receiver::new(),
            session: NO_SESSION,
            sequence: 0,
            pending: None,
            answered: false,
            rows: VecDeque::new(),
            first_row: 0,
            next_row: 0,
            state: State::Latched(Fault::Boot),
            late: false,
            path_um: 200_000,
            path_read_us: 0,
            angle: None,
            read: None,
            is_controlled: false,
            angle_urad: 1_000_000,
            next_angle_us: 0,
            seen: HashMap::new(),
        };
        world.tick();
        world.ask(Request::Hello { nonce: 1 });
        world
    }

    fn see(&mut self) {
        let electrodes = self.electrodes.borrow();
        if let Err(problem) = self.patient.sees(self.now_us, &electrodes) {
            panic!("{problem}, at {} us, {:?}", self.now_us, self.state);
        }
    }

    /// A tick, what the link has to say to it, and the pulse timer until the next.
    pub fn tick(&mut self) {
        let tick_us = self
            .now_us
            .next_multiple_of(TICK)
            .max(self.now_us + u64::from(self.now_us.is_multiple_of(TICK)) * TICK);
        while self.timer_us < tick_us {
            self.now_us = self.timer_us;
            self.electrodes.borrow_mut().words = 0;
            let lasts_us = self.step_us;
            self.step_us = self.pulses.timer();
            self.timer_us += u64::from(lasts_us);
            self.see();
        }
        self.now_us = tick_us;
        let was_armed = self.patient.is_armed();
        let armed = self.device.tick(0);
        let late = std::mem::take(&mut self.late);
        let off = !self.device.finish(100, late) || !armed;
        if off {
            self.electrodes.borrow_mut().words = 0;
            self.pulses.attend();
        }
        self.take_angle();
        self.patient.ticked(tick_us);
        self.server.poll();
        self.hear();
        if late {
            self.patient.ends("a late tick");
        }
        // What a device says of itself must be true as well.
        if off {
            self.patient.ends("a tick that says so");
        }
        if off && (was_armed || armed) {
            self.patient.forgets(tick_us);
        }
        self.see();
    }

    fn hear(&mut self) {
        while let Some(byte) = self.server.transmit() {
            let Some(Ok(frame)) = self.receiver.push(byte, NO_SESSION) else { continue };
            let message: Message<'_> = postcard::from_bytes(frame.content).expect("a message");
            match message {
                Message::Answer { answer, .. } => {
                    self.answered = true;
                    match answer {
                        Answer::Done => self.done(),
                        Answer::Info(info) => self.session = info.session,
                        Answer::Report(report) => self.state = report.state,
                        _ => (),
                    }
                }
                Message::Traces(traces) => {
                    for row in traces.iter().map(|traced| traced.row) {
                        while self.first_row < row {
                            self.rows.pop_front();
                            self.first_row += 1;
                        }
                        assert_eq!(self.first_row, row, "a row that was before");
                        self.first_row += 1;
                        let row = self.rows.pop_front().expect("a row that was sent");
                        self.stepped(row);
                    }
                }
                other => panic!("{other:?}"),
            }
        }
    }

    /// What was asked for was done, in this tick.
    fn done(&mut self) {
        let now_us = self.now_us;
        match self.pending.take() {
            Some(Request::Drive(stimuli)) => {
                self.patient.drives(now_us, &stimuli);
                if stimuli.iter().flatten().any(is_beyond) {
                    self.patient.ends("a demand beyond a limit");
                }
            }
            Some(Request::Readings(readings)) => {
                let (least, most) = LIMITS.supply_mv;
                // 1 m/s is a µm in a µs.
                let most_um = now_us - self.path_read_us;
                let jump = readings
                    .path_um
                    .is_none_or(|path| u64::from(path.abs_diff(self.path_um)) > most_um);
                if let Some(path_um) = readings.path_um {
                    (self.path_um, self.path_read_us) = (path_um, now_us);
                }
                self.patient.reads(now_us);
                if !(least..=most).contains(&readings.supply_mv) {
                    self.patient.ends("the supply");
                }
                if jump {
                    self.patient.ends("the sensor of the path");
                }
                let (least, most) = LIMITS.impedance_ohm;
                let off = readings.impedance_ohm.iter().flatten();
                if off.copied().all(|ohm| !(least..=most).contains(&ohm))
                    && readings.impedance_ohm[0].is_some()
                    && self.patient.is_driven()
                {
                    self.patient.ends("electrodes");
                }
            }
            Some(Request::Stop) => {
                self.patient.ends("a stop");
                self.patient.forgets(now_us);
            }
            Some(Request::Arm) => self.patient.arms(),
            Some(Request::Target(_)) => self.patient.steps(now_us, Some(controlled::AT_MOST)),
            Some(Request::Angle(reading)) => self.angle = Some(reading),
            Some(Request::Rest(_)) => {
                self.rows.clear();
                self.patient.steps(now_us, None);
                (self.first_row, self.next_row) = (0, 0);
            }
            Some(Request::Rows { rows, .. }) => {
                self.next_row += rows.len() as u32;
                self.rows.extend(rows.iter().map(|row| row[0]));
            }
            _ => (),
        }
    }

    fn stepped(&mut self, row: RowInputs) {
        let now_us = self.now_us;
        if !row.activation.is_finite() || !row.stimulation_frequency.is_finite() {
            self.patient.steps(now_us, None);
            return self.patient.ends("a row that is no number");
        }
        let activation = f64::from(row.activation.clamp(0.0, 1.0));
        let frequency_tenths_pps = (row.stimulation_frequency * 10.0) as u16;
        let stimulus = Stimulus {
            amplitude_ua: amplitude_ua(activation),
            width_us: ELECTRODE.width_us,
            gap_us: ELECTRODE.gap_us,
            frequency_tenths_pps,
            recovery: ELECTRODE.recovery,
        };
        let stimulates = row.activation > 0.0 && frequency_tenths_pps >= 10;
        self.patient.steps(now_us, stimulates.then_some(stimulus));
        if stimulates && frequency_tenths_pps > LIMITS.frequency_tenths_pps {
            self.patient.ends("a row's frequency");
        }
    }

    /// Sends a request, and waits for its answer.
    pub fn ask(&mut self, request: Request) {
        while !self.server.is_ready() {
            self.tick();
        }
        let hello = matches!(request, Request::Hello { .. });
        let session = if hello { NO_SESSION } else { self.session };
        let frame = encode(session, self.sequence, &request).expect("a frame");
        self.sequence = self.sequence.wrapping_add(1);
        self.pending = Some(request);
        self.answered = false;
        self.patient.hears(self.now_us);
        for byte in frame {
            self.server.receive(byte);
        }
        self.hear();
        for _ in 0..10 {
            if self.answered {
                self.pending = None;
                return;
            }
            self.tick();
        }
        panic!("no answer");
    }
}

/// Whether a demand is beyond a limit that is named by a field.
fn is_beyond(stimulus: &Stimulus) -> bool {
    let Stimulus { amplitude_ua, width_us, frequency_tenths_pps, .. } = *stimulus;
    let charge = u64::from(amplitude_ua) * u64::from(width_us);
    amplitude_ua > LIMITS.amplitude_ua
        || width_us > LIMITS.width_us
        || frequency_tenths_pps > LIMITS.frequency_tenths_pps
        || charge > u64::from(LIMITS.charge_nc) * 1000
}
