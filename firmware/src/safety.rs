//! Whether stimulation may go on: limits, inputs that must make sense, and faults that stay until somebody has
//! seen them. One pass per tick, in integers, without generics.
//!
//! Everything is off at boot. A fault latches: somebody has to name it ([`Supervisor::acknowledge`]), and then arm
//! ([`Supervisor::arm`]) within ten seconds and with the cause gone.

pub use crate::fault::Fault;
use crate::guarded::Guarded;
use crate::limits::LimitError;
use crate::limits::Limits;
use crate::stimulus::{Scale, Stimulus};
use serde::{Deserialize, Serialize};

/// Channels that are supervised together.
pub const CHANNELS: usize = 4;

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
    /// It was read since the last tick, also where it says the same as before.
    pub path_is_new: bool,
    /// The last tick began and finished in time.
    pub in_time: bool,
    /// State and parameters are what the last tick left.
    pub memory_is_intact: bool,
    /// The output stage has answered.
    pub output_answers: bool,
}

/// What a tick is asked to put out, and how old that is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Requested {
    /// Of each channel.
    pub stimuli: [Option<Stimulus>; CHANNELS],
    /// Age of the row that a stimulus comes from, µs; 0 if none does.
    pub row_age_us: u64,
    /// Age of the drive that a stimulus comes from, µs; 0 if none does.
    pub drive_age_us: u64,
    /// Activation and frequency of the rows are finite numbers.
    pub is_finite: bool,
}

impl Requested {
    /// Nothing on any channel.
    pub const NOTHING: Self =
        Self { stimuli: [None; CHANNELS], row_age_us: 0, drive_age_us: 0, is_finite: true };

    /// Of the pulse trains with current, µs; 0 without any.
    fn longest_period_us(&self) -> u32 {
        let trains = self.stimuli.iter().flatten().filter(|stimulus| stimulus.amplitude_ua > 0);
        trains.map(Stimulus::period_us).max().unwrap_or(0)
    }

    /// Whether current is asked for.
    fn stimulates(&self) -> bool {
        self.stimuli.iter().flatten().any(|stimulus| stimulus.amplitude_ua > 0)
    }
}

/// Where the two steps of arming are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// Off because of the fault, until somebody names it.
    Latched(Fault),
    /// Off; the fault has been named, and arming may follow.
    Acknowledged {
        /// Time that is left for arming, µs.
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

/// Supervises stimulation. Times are µs in 64 bits: they do not end.
#[derive(Clone, Debug)]
pub struct Supervisor {
    limits: Guarded<Limits>,
    tick_us: u32,
    state: State,
    /// What was wrong with the inputs of the last tick, if anything.
    wrong: Option<Fault>,
    silence_us: u64,
    /// Until the pulse after the last that was asked for would be due: pauses within a pulse train are no pauses.
    train_us: u32,
    /// Of stimulation since the last rest.
    session_us: u64,
    /// Without stimulation.
    rest_us: u64,
    /// Of stimulation while the reading stayed the same.
    stuck_us: u64,
    path_before: Option<i32>,
    /// Since that was read.
    path_age_us: u64,
}

impl Supervisor {
    /// Off, as at every boot, and latched: with [`Fault::Boot`], or [`Fault::Watchdog`] if that is why it boots.
    /// For a tick of so many µs and a current source of that scale; see [`Limits::validate`] for what is refused.
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
        })
    }

    /// What is allowed; none once memory has lost a bit of it.
    pub fn limits(&self) -> Option<&Limits> {
        self.limits.get()
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

    /// Second step: stimulation may begin, from nothing, if the last tick saw nothing wrong and the session is not
    /// over. What was put out before still counts.
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

    /// One tick: whether what is requested may be put out until the next one, all of it, or nothing.
    pub fn tick(&mut self, observed: &Observed, requested: &Requested) -> bool {
        let stimulates = requested.stimulates() || self.train_us > 0;
        // A limit that memory has lost allows nothing.
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
                if other != fault && other.is_of_a_moment() =>
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
        self.count_session(limits.as_ref(), is_armed && stimulates);
        let asked_us = if is_armed { requested.longest_period_us() } else { 0 };
        self.train_us = self.train_us.saturating_sub(self.tick_us).max(asked_us);
        is_armed
    }

    /// A session goes on through pauses, stops and faults; only a rest ends it.
    fn count_session(&mut self, limits: Option<&Limits>, stimulates: bool) {
        let tick_us = u64::from(self.tick_us);
        if stimulates {
            self.session_us = self.session_us.saturating_add(tick_us);
        }
        count(&mut self.rest_us, !stimulates, self.tick_us);
        if limits.is_some_and(|limits| self.rest_us >= micros(limits.rest_ms)) {
            self.session_us = 0;
        }
    }

    fn is_session_over(&self, limits: &Limits) -> bool {
        self.session_us >= micros(limits.session_ms)
    }

    /// Latches a fault that somebody else has found, unless one is latched already.
    pub fn fail(&mut self, fault: Fault) {
        if !matches!(self.state, State::Latched(_)) {
            self.state = State::Latched(fault);
        }
    }

    /// What is wrong with what a tick sees; what is worst first.
    fn wrong_with(
        &mut self,
        limits: &Limits,
        observed: &Observed,
        requested: &Requested,
        stimulates: bool,
    ) -> Option<Fault> {
        count(&mut self.silence_us, !observed.host_heard, self.tick_us);
        let sensor = self.wrong_sensor(limits, observed, stimulates);
        let faults = [
            (!observed.memory_is_intact).then_some(Fault::Checksum),
            (!observed.output_answers).then_some(Fault::Output),
            (!observed.in_time).then_some(Fault::Deadline),
            outside(observed.supply_mv, limits.supply_mv).map(|_| Fault::Supply),
            wrong_electrode(observed, &requested.stimuli, limits.impedance_ohm),
            sensor,
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
        // The first number there is moves from nowhere.
        let moved = self.path_before.map_or(1, |before| path.abs_diff(before));
        self.path_before = Some(path);
        // mm/s times µs are nm. A µm is the least that a reading can tell.
        let most_moved =
            u64::from(limits.path_speed_mm_s).saturating_mul(self.path_age_us).max(1000);
        if observed.path_is_new || moved > 0 {
            self.path_age_us = 0;
        }
        let (least, most) = limits.path_um;
        // Pauses of stimulation do not count, and do not make a sensor work.
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

    /// What is wrong with a request, with its age, and with how long requests have gone on.
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

/// Exact for every limit.
fn micros(limit_ms: u32) -> u64 {
    u64::from(limit_ms) * 1000
}

/// Counts µs as long as something goes on.
fn count(total_us: &mut u64, goes_on: bool, tick_us: u32) {
    *total_us = if goes_on { total_us.saturating_add(tick_us.into()) } else { 0 };
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

#[cfg(test)]
mod tests;
