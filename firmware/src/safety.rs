//! Whether stimulation may go on: limits, inputs that must make sense, and faults that stay until somebody has
//! seen them. One pass per tick, in integers, without generics.
//!
//! Everything is off at boot. A fault latches: somebody has to name it ([`Supervisor::acknowledge`]), and then arm
//! ([`Supervisor::arm`]) within ten seconds and with the cause gone.
//!
//! What shaped the limits: IEC 60601-2-10:2012, for stimulators in physical medicine, allows into 500 Ω at most
//! 300 mJ per pulse and, up to 400 Hz, 50 mA r.m.s.; and asks for particular care above 2 mA r.m.s. per cm² of
//! electrode. This is no claim of conformity, which nobody can make for a module; and equipment with implanted
//! electrodes, as in intramuscular FES, is outside of that standard: its limits come from the charge per phase
//! that the electrode in question bears.

use crate::stimulus::Stimulus;
use serde::{Deserialize, Serialize};

/// Channels that are supervised together.
pub const CHANNELS: usize = 4;

/// What is allowed; everything else is a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Amplitude, µA.
    pub amplitude_ua: u32,
    /// Width of the phase that stimulates, µs.
    pub width_us: u16,
    /// Pulses in ten seconds.
    pub frequency_tenths_pps: u16,
    /// Charge of a phase, nC.
    pub charge_nc: u32,
    /// Root of the mean square of a channel's current, µA.
    pub rms_ua: u32,
    /// How much an amplitude may rise from pulse to pulse, µA. Faster demands are slowed down, and are no fault.
    pub rise_ua: u32,
    /// Stimulation since the last arming, ms.
    pub session_ms: u32,
    /// Longest silence of the host, ms.
    pub silence_ms: u32,
    /// For how long a path length that was read is one, ms.
    pub readings_ms: u32,
    /// Of each electrode that stimulates and was measured, Ω: below is a short, above an electrode that has come
    /// off. Measuring takes pulses, so that one that was not measured yet is let pass.
    pub impedance_ohm: (u32, u32),
    /// mV.
    pub supply_mv: (u32, u32),
    /// Path length of the muscle, µm.
    pub path_um: (i32, i32),
    /// How fast that may move, mm/s.
    pub path_speed_mm_s: u32,
    /// How long that may stay the same to the µm, ms of stimulation: a sensor has noise.
    pub stuck_ms: u32,
}

impl Limits {
    /// For surface electrodes of 25 cm² and adults: 20 mA r.m.s. are 0.8 mA/cm², and 40 µC at 100 mA no more than
    /// 4 mJ in 500 Ω, both phases.
    pub const SURFACE: Self = Self {
        amplitude_ua: 100_000,
        width_us: 500,
        frequency_tenths_pps: 1000,
        charge_nc: 40_000,
        rms_ua: 20_000,
        rise_ua: 2_000,
        session_ms: 30 * 60 * 1000,
        silence_ms: 100,
        readings_ms: 200,
        impedance_ohm: (100, 5_000),
        supply_mv: (3_000, 4_300),
        path_um: (50_000, 500_000),
        path_speed_mm_s: 1_000,
        stuck_ms: 2_000,
    };
}

/// What went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Fault {
    /// Nothing yet: this is how everything starts.
    Boot,
    /// An amplitude beyond its limit was asked for.
    Amplitude,
    /// A width.
    Width,
    /// A frequency.
    Frequency,
    /// A charge per phase.
    Charge,
    /// A mean square of current.
    RootMeanSquare,
    /// Stimulation has lasted as long as it may.
    Session,
    /// The host was silent for too long.
    Silence,
    /// An electrode is shorted.
    ElectrodeShort,
    /// An electrode has come off.
    ElectrodeOpen,
    /// The supply is out of its range.
    Supply,
    /// The sensor gives no number.
    SensorMissing,
    /// The sensor's number is out of its range.
    SensorRange,
    /// It jumped.
    SensorJump,
    /// It is stuck.
    SensorStuck,
    /// The tick before was late or did not finish.
    Deadline,
    /// The watchdog had to restart the controller.
    Watchdog,
    /// State or parameters are not what the last tick left.
    Checksum,
    /// The output stage did not answer.
    Output,
    /// A stimulus was asked for that the stimulator cannot do.
    Request,
    /// Somebody has stopped it, which is not a fault, and takes the same two steps to go on.
    Stopped,
}

impl Fault {
    /// May have been there for a tick only, and is not to be missed for that: arming looks at the last tick.
    fn is_of_a_moment(self) -> bool {
        matches!(self, Self::Checksum | Self::Deadline | Self::Output)
    }
}

/// What a tick sees.
#[derive(Clone, Copy, Debug)]
pub struct Observed {
    /// The host was heard of since the last tick.
    pub host_heard: bool,
    /// Ω of every channel; none where it was not measured yet.
    pub impedance_ohm: [Option<u32>; CHANNELS],
    /// mV.
    pub supply_mv: u32,
    /// Path length, µm; none if the sensor gave no number, or none lately.
    pub path_um: Option<i32>,
    /// The last tick began and finished in time.
    pub in_time: bool,
    /// State and parameters are what the last tick left.
    pub memory_is_intact: bool,
    /// The output stage has answered.
    pub output_answers: bool,
}

/// Where the two steps of arming are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// Off because of the fault, until somebody names it.
    Latched(Fault),
    /// Off; the fault has been named, and arming may follow within so many ms.
    Acknowledged {
        /// µs that are left.
        left_us: u32,
        /// The fault that comes back when they are over.
        fault: Fault,
    },
    /// Stimulation is allowed.
    Armed,
}

/// Why arming was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotArmed {
    /// No fault of that name is latched.
    OtherFault,
    /// The fault has to be acknowledged first.
    NotAcknowledged,
    /// The cause is still there.
    StillThere(Fault),
}

/// From acknowledging to arming, µs.
const ARMING_US: u32 = 10_000_000;

/// Supervises stimulation.
#[derive(Clone, Debug)]
pub struct Supervisor {
    limits: Limits,
    tick_us: u32,
    state: State,
    /// What was wrong with the inputs of the last tick, if anything.
    wrong: Option<Fault>,
    silence_us: u32,
    session_us: u32,
    stuck_us: u32,
    path_before: Option<i32>,
    /// How far each amplitude has risen, millionths of µA, and with which width.
    risen: [(u64, u16); CHANNELS],
}

/// Nothing on any channel.
const NEUTRAL: [Option<Stimulus>; CHANNELS] = [None; CHANNELS];

impl Supervisor {
    /// Off, as at every boot, and latched: with [`Fault::Boot`], or [`Fault::Watchdog`] if that is why it boots.
    /// For a tick of so many µs, 500 to 2,000.
    pub const fn new(limits: Limits, tick_us: u32, boot: Fault) -> Self {
        Self {
            limits,
            tick_us,
            state: State::Latched(boot),
            wrong: Some(boot),
            silence_us: 0,
            session_us: 0,
            stuck_us: 0,
            path_before: None,
            risen: [(0, 0); CHANNELS],
        }
    }

    /// What is allowed.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Where it is.
    pub fn state(&self) -> State {
        self.state
    }

    /// What was wrong with the inputs of the last tick, if anything.
    pub fn wrong(&self) -> Option<Fault> {
        self.wrong
    }

    /// First step: somebody has seen the fault, and says which.
    pub fn acknowledge(&mut self, seen: Fault) -> Result<(), NotArmed> {
        match self.state {
            State::Latched(fault) | State::Acknowledged { fault, .. } if fault == seen => {
                self.state = State::Acknowledged { left_us: ARMING_US, fault };
                Ok(())
            }
            _ => Err(NotArmed::OtherFault),
        }
    }

    /// Second step: stimulation may begin, from nothing, if the last tick saw nothing wrong.
    pub fn arm(&mut self) -> Result<(), NotArmed> {
        let State::Acknowledged { .. } = self.state else { return Err(NotArmed::NotAcknowledged) };
        if let Some(fault) = self.wrong {
            return Err(NotArmed::StillThere(fault));
        }
        self.state = State::Armed;
        self.session_us = 0;
        self.stuck_us = 0;
        self.risen = [(0, 0); CHANNELS];
        Ok(())
    }

    /// One tick: what of the request may be put out until the next one.
    pub fn tick(
        &mut self,
        observed: &Observed,
        requested: &[Option<Stimulus>; CHANNELS],
    ) -> [Option<Stimulus>; CHANNELS] {
        let stimulates = requested.iter().flatten().any(|stimulus| stimulus.amplitude_ua > 0);
        self.wrong = self.wrong_with(observed, requested, stimulates);
        match (self.state, self.wrong) {
            (State::Armed, None) => {
                let demand = self.wrong_request(requested);
                if let Some(fault) = demand {
                    return self.latch(fault);
                }
                let stimulated_us = if stimulates { self.tick_us } else { 0 };
                self.session_us = self.session_us.saturating_add(stimulated_us);
                self.slowed(requested)
            }
            (State::Armed, Some(fault)) => self.latch(fault),
            (State::Acknowledged { fault, .. }, Some(other))
                if other != fault && other.is_of_a_moment() =>
            {
                self.latch(other)
            }
            (State::Acknowledged { left_us: 0, fault }, _) => self.latch(fault),
            (State::Acknowledged { left_us, fault }, _) => {
                let left_us = left_us.saturating_sub(self.tick_us);
                self.state = State::Acknowledged { left_us, fault };
                NEUTRAL
            }
            (State::Latched(_), _) => NEUTRAL,
        }
    }

    /// Latches a fault that somebody else has found, unless one is latched already.
    pub fn fail(&mut self, fault: Fault) {
        if !matches!(self.state, State::Latched(_)) {
            self.latch(fault);
        }
    }

    fn latch(&mut self, fault: Fault) -> [Option<Stimulus>; CHANNELS] {
        self.state = State::Latched(fault);
        NEUTRAL
    }

    /// What is wrong with what a tick sees; what is worst first.
    fn wrong_with(
        &mut self,
        observed: &Observed,
        requested: &[Option<Stimulus>; CHANNELS],
        stimulates: bool,
    ) -> Option<Fault> {
        let limits = self.limits;
        count(&mut self.silence_us, !observed.host_heard, self.tick_us);
        let sensor = self.wrong_sensor(observed.path_um, stimulates);
        let faults = [
            (!observed.memory_is_intact).then_some(Fault::Checksum),
            (!observed.output_answers).then_some(Fault::Output),
            (!observed.in_time).then_some(Fault::Deadline),
            outside(observed.supply_mv, limits.supply_mv).map(|_| Fault::Supply),
            wrong_electrode(observed, requested, limits.impedance_ohm),
            sensor,
            (self.silence_us / 1000 > limits.silence_ms).then_some(Fault::Silence),
        ];
        faults.into_iter().flatten().next()
    }

    fn wrong_sensor(&mut self, path_um: Option<i32>, stimulates: bool) -> Option<Fault> {
        let Some(path) = path_um else { return Some(Fault::SensorMissing) };
        // The first number there is moves from nowhere.
        let moved = self.path_before.map_or(1, |before| path.abs_diff(before));
        self.path_before = Some(path);
        let (least, most) = self.limits.path_um;
        // Pauses of stimulation do not count, and do not make a sensor work.
        if moved > 0 || stimulates {
            count(&mut self.stuck_us, moved == 0, self.tick_us);
        }
        // mm/s times µs are thousandths of µm.
        let most_moved = u64::from(self.limits.path_speed_mm_s) * u64::from(self.tick_us) / 1000;
        if !(least..=most).contains(&path) {
            Some(Fault::SensorRange)
        } else if u64::from(moved) > most_moved {
            Some(Fault::SensorJump)
        } else if self.stuck_us / 1000 > self.limits.stuck_ms {
            Some(Fault::SensorStuck)
        } else {
            None
        }
    }

    /// What is wrong with a request, and with how long requests have gone on.
    fn wrong_request(&self, requested: &[Option<Stimulus>; CHANNELS]) -> Option<Fault> {
        let limits = &self.limits;
        if self.session_us / 1000 >= limits.session_ms {
            return Some(Fault::Session);
        }
        requested.iter().flatten().find_map(|stimulus| {
            let Stimulus { amplitude_ua, width_us, frequency_tenths_pps, .. } = *stimulus;
            if amplitude_ua > limits.amplitude_ua {
                Some(Fault::Amplitude)
            } else if width_us > limits.width_us {
                Some(Fault::Width)
            } else if frequency_tenths_pps > limits.frequency_tenths_pps {
                Some(Fault::Frequency)
            } else if charge_nc(stimulus) > u64::from(limits.charge_nc) {
                Some(Fault::Charge)
            } else if mean_square(stimulus) > u64::from(limits.rms_ua).pow(2) {
                Some(Fault::RootMeanSquare)
            } else {
                None
            }
        })
    }

    /// The request, with amplitudes that have risen as far as they may.
    fn slowed(&mut self, requested: &[Option<Stimulus>; CHANNELS]) -> [Option<Stimulus>; CHANNELS] {
        let mut allowed = *requested;
        for (stimulus, (risen, width_us)) in allowed.iter_mut().zip(&mut self.risen) {
            let Some(stimulus) = stimulus else {
                *risen = 0;
                continue;
            };
            // Charge stimulates: a pulse that becomes wider becomes weaker first.
            let wider = stimulus.width_us.max(1);
            if wider > *width_us {
                *risen = *risen * u64::from(*width_us) / u64::from(wider);
            }
            *width_us = wider;
            // In a tick of t µs there are f t/10^7 pulses, f being in tenths.
            let rise = u64::from(self.limits.rise_ua)
                * u64::from(stimulus.frequency_tenths_pps)
                * u64::from(self.tick_us);
            *risen = (*risen + rise / 10).min(u64::from(stimulus.amplitude_ua) * 1_000_000);
            // No more than the amplitude, which has 32 bits.
            stimulus.amplitude_ua = (*risen / 1_000_000) as u32;
        }
        allowed
    }
}

/// Counts µs as long as something goes on: half an hour and more fit.
fn count(total_us: &mut u32, goes_on: bool, tick_us: u32) {
    *total_us = if goes_on { total_us.saturating_add(tick_us) } else { 0 };
}

/// Below or above a range: false or true.
fn outside(value: u32, (least, most): (u32, u32)) -> Option<bool> {
    if value < least {
        Some(false)
    } else if value > most {
        Some(true)
    } else {
        None
    }
}

/// The first electrode that stimulates and does not look like one.
fn wrong_electrode(
    observed: &Observed,
    requested: &[Option<Stimulus>; CHANNELS],
    range: (u32, u32),
) -> Option<Fault> {
    observed.impedance_ohm.iter().zip(requested).find_map(|(impedance, stimulus)| {
        stimulus.filter(|stimulus| stimulus.amplitude_ua > 0)?;
        let above = outside((*impedance)?, range)?;
        Some(if above { Fault::ElectrodeOpen } else { Fault::ElectrodeShort })
    })
}

/// Charge of a phase, nC, rounded up: µA times µs are thousandths of it.
fn charge_nc(stimulus: &Stimulus) -> u64 {
    (u64::from(stimulus.amplitude_ua) * u64::from(stimulus.width_us)).div_ceil(1000)
}

/// Mean square of a channel's current, µA²: A² w (1 + 1/k) f, for the phase that takes the charge back is k times
/// weaker and longer. Saturated, and amplitudes beyond 1 A taken as that: no limit is there.
fn mean_square(stimulus: &Stimulus) -> u64 {
    let amplitude = u64::from(stimulus.amplitude_ua.min(1_000_000));
    let recovery = u64::from(stimulus.recovery.max(1));
    let on_us = u64::from(stimulus.width_us) * (recovery + 1);
    let frequency = u64::from(stimulus.frequency_tenths_pps);
    // 10^12 times 2^24 fits; 10^7 is µs in a second, and tenths of a pulse.
    (amplitude * amplitude * on_us / 10_000).saturating_mul(frequency) / recovery / 1_000
}
