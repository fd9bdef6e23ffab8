//! Supervision: limits, plausibility of inputs, and latched faults. One pass per tick, in integers,
//! without generics.
//!
//! Everything is off at boot. A fault latches until it is acknowledged by name
//! ([`Supervisor::acknowledge`]) and the stimulator is armed ([`Supervisor::arm`]) within ten
//! seconds, with the cause gone.

pub use crate::between::fault::Fault;
use crate::between::guarded::Guarded;
use crate::between::limits::{LimitError, Limits};
use crate::between::stimulus::{Scale, Stimulus};
pub use crate::config::CHANNELS;
pub use crate::hard_tick::angle_watch::AngleObserved;
use crate::hard_tick::angle_watch::AngleWatch;
use crate::hard_tick::dose::{charge_nc, mean_square};
use serde::{Deserialize, Serialize};

/// Observations of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Observed {
    /// The host was heard since the last tick.
    pub host_heard: bool,
    /// Impedance of every channel, Ω; none if not measured yet.
    pub impedance_ohm: [Option<u32>; CHANNELS],
    /// Supply, mV.
    pub supply_mv: u32,
    /// Path length, µm; none without a recent valid reading.
    pub path_um: Option<i32>,
    /// It is a new reading, even if its value is unchanged.
    pub path_is_new: bool,
    /// The joint's sensor, if a controller is loaded.
    pub angle: Option<AngleObserved>,
    /// The last tick began and finished in time.
    pub in_time: bool,
    /// Checksums of state and parameters are valid.
    pub memory_is_intact: bool,
    /// The output stage has answered.
    pub output_answers: bool,
}

/// Requested stimuli of a tick, with their age.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Requested {
    /// Stimulus of each channel.
    pub stimuli: [Option<Stimulus>; CHANNELS],
    /// Age of the stimulating row, µs; 0 without one.
    pub row_age_us: u64,
    /// Age of the drive in force, µs; 0 without one.
    pub drive_age_us: u64,
    /// Age of the target that the controller follows, µs; 0 without one.
    pub target_age_us: u64,
    /// Activation and frequency of the rows, or the controller's commands, are finite.
    pub is_finite: bool,
    /// The controller's estimate of the gain is in its range.
    pub gain_is_valid: bool,
}

impl Requested {
    /// No stimulus on any channel.
    pub const NOTHING: Self = Self {
        stimuli: [None; CHANNELS],
        row_age_us: 0,
        drive_age_us: 0,
        target_age_us: 0,
        is_finite: true,
        gain_is_valid: true,
    };

    /// Longest period of the pulse trains with current, µs; 0 without one.
    fn longest_period_us(&self) -> u32 {
        let trains = self.stimuli.iter().flatten().filter(|stimulus| stimulus.amplitude_ua > 0);
        trains.map(Stimulus::period_us).max().unwrap_or(0)
    }

    /// Whether current is requested.
    fn stimulates(&self) -> bool {
        self.stimuli.iter().flatten().any(|stimulus| stimulus.amplitude_ua > 0)
    }
}

/// State of arming.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// Off, until the fault is acknowledged.
    Latched(Fault),
    /// Off; the fault is acknowledged, and arming may follow.
    Acknowledged {
        /// Remaining time for arming, µs.
        left_us: u32,
        /// The fault that latches again after that.
        fault: Fault,
    },
    /// Armed: stimulation is allowed.
    Armed,
}

/// Why arming was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotArmed {
    /// Another fault is latched.
    OtherFault,
    /// No fault is acknowledged.
    NotAcknowledged,
    /// The cause is still present.
    StillThere(Fault),
}

/// Longest time from acknowledging to arming, µs.
const ARMING_US: u32 = 10_000_000;

/// Supervises stimulation. Times are µs in 64 bits and do not overflow.
#[derive(Clone, Debug)]
pub struct Supervisor {
    limits: Guarded<Limits>,
    tick_us: u32,
    state: State,
    /// Fault of the last tick's observations, if any.
    wrong: Option<Fault>,
    silence_us: u64,
    /// Time until the requested train's next pulse: the time between pulses of a train is no pause.
    train_us: u32,
    /// Stimulation since the last rest.
    session_us: u64,
    /// Pause of stimulation.
    rest_us: u64,
    /// Stimulation with a constant reading.
    stuck_us: u64,
    path_before: Option<i32>,
    /// Time since the last reading.
    path_age_us: u64,
    angle: AngleWatch,
}

impl Supervisor {
    /// Off and latched with [`Fault::Boot`], or [`Fault::Watchdog`] after a restart by the
    /// watchdog, for a tick time in µs and a current source. For errors see [`Limits::validate`].
    pub fn new(
        limits: Limits,
        tick_us: u32,
        scale: &Scale,
        boot: Fault,
    ) -> Result<Self, LimitError> {
        limits.validate(tick_us, scale)?;
        Ok(Self {
            limits: Guarded::new(limits),
            tick_us,
            state: State::Latched(boot),
            wrong: Some(boot),
            silence_us: 0,
            train_us: 0,
            session_us: 0,
            rest_us: 0,
            stuck_us: 0,
            path_before: None,
            path_age_us: 0,
            angle: AngleWatch::default(),
        })
    }

    /// Limits; none if their checksum failed.
    pub fn limits(&self) -> Option<&Limits> {
        self.limits.get()
    }

    /// State of arming.
    pub fn state(&self) -> State {
        self.state
    }

    /// Fault of the last tick's observations, if any.
    pub fn wrong(&self) -> Option<Fault> {
        self.wrong
    }

    /// First step of arming: acknowledges the latched fault by name.
    pub fn acknowledge(&mut self, seen: Fault) -> Result<(), NotArmed> {
        match self.state {
            State::Latched(fault) | State::Acknowledged { fault, .. } if fault == seen => {
                self.state = State::Acknowledged { left_us: ARMING_US, fault };
                Ok(())
            }
            _ => Err(NotArmed::OtherFault),
        }
    }

    /// Second step of arming: allowed if the last tick had no fault and the session is not over.
    /// Earlier output still counts.
    pub fn arm(&mut self) -> Result<(), NotArmed> {
        let State::Acknowledged { .. } = self.state else { return Err(NotArmed::NotAcknowledged) };
        if let Some(fault) = self.wrong {
            return Err(NotArmed::StillThere(fault));
        }
        let Some(limits) = self.limits.get() else {
            return Err(NotArmed::StillThere(Fault::Checksum));
        };
        if self.is_session_over(limits) {
            return Err(NotArmed::StillThere(Fault::Session));
        }
        self.state = State::Armed;
        Ok(())
    }

    /// One tick: whether all requested stimuli may be put out until the next tick.
    pub fn tick(&mut self, observed: &Observed, requested: &Requested) -> bool {
        let stimulates = requested.stimulates() || self.train_us > 0;
        // A limit whose checksum fails allows nothing.
        let limits = self.limits.get().copied();
        self.wrong = match &limits {
            Some(limits) => self.wrong_with(limits, observed, requested, stimulates),
            None => Some(Fault::Checksum),
        };
        match (self.state, self.wrong) {
            (State::Armed, None) => {
                if let Some(limits) = &limits
                    && let Some(fault) = self.wrong_request(limits, requested)
                {
                    self.state = State::Latched(fault);
                }
            }
            (State::Armed, Some(fault)) => self.state = State::Latched(fault),
            (State::Acknowledged { fault, .. }, Some(other))
                if other != fault && other.is_transient() =>
            {
                self.state = State::Latched(other);
            }
            (State::Acknowledged { left_us: 0, fault }, _) => self.state = State::Latched(fault),
            (State::Acknowledged { left_us, fault }, _) => {
                let left_us = left_us.saturating_sub(self.tick_us);
                self.state = State::Acknowledged { left_us, fault };
            }
            (State::Latched(_), _) => (),
        }
        let is_armed = self.state == State::Armed;
        let goes_on = is_armed && stimulates;
        let rests = !(is_armed && requested.stimulates()) && self.train_us == 0;
        self.count_session(limits.as_ref(), goes_on, rests);
        let asked_us = if is_armed { requested.longest_period_us() } else { 0 };
        self.train_us = self.train_us.saturating_sub(self.tick_us).max(asked_us);
        is_armed
    }

    /// A session continues through pauses, stops and faults; only a rest ends it. A rest begins
    /// where the next pulse would have come.
    fn count_session(&mut self, limits: Option<&Limits>, goes_on: bool, rests: bool) {
        if goes_on {
            self.session_us = self.session_us.saturating_add(self.tick_us.into());
        }
        count(&mut self.rest_us, rests, self.tick_us);
        if limits.is_some_and(|limits| self.rest_us >= micros(limits.rest_ms)) {
            self.session_us = 0;
        }
    }

    fn is_session_over(&self, limits: &Limits) -> bool {
        self.session_us >= micros(limits.session_ms)
    }

    /// Latches a fault, unless one is latched already.
    pub fn fail(&mut self, fault: Fault) {
        if !matches!(self.state, State::Latched(_)) {
            self.state = State::Latched(fault);
        }
    }

    /// First fault of a tick's observations, most severe first.
    fn wrong_with(
        &mut self,
        limits: &Limits,
        observed: &Observed,
        requested: &Requested,
        stimulates: bool,
    ) -> Option<Fault> {
        count(&mut self.silence_us, !observed.host_heard, self.tick_us);
        let sensor = self.wrong_sensor(limits, observed, stimulates);
        let angle = self.angle.wrong(limits, self.tick_us, observed.angle.as_ref(), stimulates);
        let faults = [
            (!observed.memory_is_intact).then_some(Fault::Checksum),
            (!observed.output_answers).then_some(Fault::Output),
            (!observed.in_time).then_some(Fault::Deadline),
            outside(observed.supply_mv, limits.supply_mv).map(|_| Fault::Supply),
            wrong_electrode(observed, &requested.stimuli, limits.impedance_ohm),
            sensor,
            angle,
            (self.silence_us > micros(limits.silence_ms)).then_some(Fault::Silence),
        ];
        faults.into_iter().flatten().next()
    }

    fn wrong_sensor(
        &mut self,
        limits: &Limits,
        observed: &Observed,
        stimulates: bool,
    ) -> Option<Fault> {
        self.path_age_us = self.path_age_us.saturating_add(self.tick_us.into());
        let Some(path) = observed.path_um else { return Some(Fault::SensorMissing) };
        // The first reading has no speed.
        let moved = self.path_before.map_or(1, |before| path.abs_diff(before));
        self.path_before = Some(path);
        // mm/s times µs is nm. A reading resolves 1 µm.
        let most_moved =
            u64::from(limits.path_speed_mm_s).saturating_mul(self.path_age_us).max(1000);
        if observed.path_is_new || moved > 0 {
            self.path_age_us = 0;
        }
        let (least, most) = limits.path_um;
        // Pauses of stimulation neither count nor reset it.
        if moved > 0 || stimulates {
            count(&mut self.stuck_us, moved == 0, self.tick_us);
        }
        if !(least..=most).contains(&path) {
            Some(Fault::SensorRange)
        } else if u64::from(moved) * 1000 > most_moved {
            Some(Fault::SensorJump)
        } else if self.stuck_us > micros(limits.stuck_ms) {
            Some(Fault::SensorStuck)
        } else {
            None
        }
    }

    /// First fault of a request, of its age, and of the session.
    fn wrong_request(&self, limits: &Limits, requested: &Requested) -> Option<Fault> {
        if self.is_session_over(limits) {
            return Some(Fault::Session);
        }
        if requested.row_age_us > micros(limits.rows_ms) {
            return Some(Fault::StaleRow);
        }
        if requested.drive_age_us > micros(limits.drives_ms) {
            return Some(Fault::StaleDrive);
        }
        if requested.target_age_us > micros(limits.targets_ms) {
            return Some(Fault::StaleTarget);
        }
        if !requested.gain_is_valid {
            return Some(Fault::Gain);
        }
        if !requested.is_finite {
            return Some(Fault::Request);
        }
        requested.stimuli.iter().flatten().find_map(|stimulus| {
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
}

/// ms to µs, exact for every limit.
fn micros(limit_ms: u32) -> u64 {
    u64::from(limit_ms) * 1000
}

/// Adds µs while a condition holds; else 0.
fn count(total_us: &mut u64, goes_on: bool, tick_us: u32) {
    *total_us = if goes_on { total_us.saturating_add(tick_us.into()) } else { 0 };
}

/// Outside a range: below is false, above true.
fn outside(value: u32, (least, most): (u32, u32)) -> Option<bool> {
    if value < least {
        Some(false)
    } else if value > most {
        Some(true)
    } else {
        None
    }
}

/// First stimulating electrode with an impedance out of range.
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

#[cfg(test)]
mod tests;
