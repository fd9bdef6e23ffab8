//! An oracle of the limits that watches the electrodes and hears what the host says, and knows
//! nothing else of the stimulator: neither its code nor its state. Limits are written out again,
//! and every time is its own. A session is told by pulses that were put out. That a tick says it is
//! off only makes it stricter: nothing may flow then.

mod channel;
mod session;

use self::channel::{Asked, Channel, Pulse, SECOND_US};
use self::session::{BEHIND_US, Session};
use crate::electrodes::{CHANNELS, Electrodes};
use firmware::Stimulus;

/// What the oracle holds pulses to, in units of the electrodes: counts of 50 mA by 4095, µs.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Of a pulse's stimulating phase.
    pub counts: u16,
    /// Of that phase.
    pub width_us: u64,
    /// Counts times µs of that phase.
    pub charge: u64,
    /// Square of counts, mean over a second.
    pub mean_square: u64,
    /// Pulses of a channel in a second.
    pub pulses: usize,
    /// Counts from one pulse of a channel to the next, at the same width.
    pub rise: u16,
    /// Of stimulation without a rest, and of a rest.
    pub session_us: u64,
    /// See `session_us`.
    pub rest_us: u64,
    /// Without a frame of the host's.
    pub silence_us: u64,
    /// Of the reading of the path.
    pub readings_us: u64,
    /// Of a row, or of a target.
    pub rows_us: u64,
    /// Of a drive.
    pub drives_us: u64,
    /// Of an angle.
    pub angle_us: u64,
    /// A tick.
    pub tick_us: u64,
}

const FOR_EVER: u64 = u64::MAX / 2;
/// A pulse that is cut short leaves its electrodes connected to each other for so long, up to a
/// step.
const DISCHARGE_US: u64 = 20_000 - 125;

/// A phase with current.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Flow {
    channel: usize,
    is_cathodic: bool,
    counts: u16,
}

/// Watches.
#[derive(Debug)]
pub struct Patient {
    bounds: Bounds,
    channels: [Channel; CHANNELS],
    now_us: u64,
    flow: Option<Flow>,
    flow_since_us: u64,
    /// Since when electrodes of a channel are connected to each other after a pulse that was cut
    /// short.
    discharges: Option<(usize, u64)>,
    /// The host has armed, and nothing has ended it since.
    armed: bool,
    /// What ended it last.
    ended_by: &'static str,
    /// Channels of what rows or a controller's targets ask for.
    row_channels: &'static [usize],
    /// Times of the last frame, drive, row and reading.
    heard_us: u64,
    drive_us: u64,
    row_us: u64,
    reading_us: u64,
    /// Of the last angle, if a controller needs them.
    angle_us: Option<u64>,
    session: Session,
    /// Pulses so far.
    pub pulses: u64,
}

impl Patient {
    /// Before anything.
    pub fn new(bounds: Bounds, row_channels: &'static [usize]) -> Self {
        Self {
            bounds,
            channels: Default::default(),
            now_us: 0,
            flow: None,
            flow_since_us: 0,
            discharges: None,
            armed: false,
            ended_by: "boot",
            row_channels,
            heard_us: 0,
            drive_us: 0,
            row_us: 0,
            reading_us: 0,
            angle_us: None,
            session: Session::default(),
            pulses: 0,
        }
    }

    /// What the electrodes are from now on.
    pub fn sees(&mut self, now_us: u64, electrodes: &Electrodes) -> Result<(), String> {
        if let Some(problem) = electrodes.problems.first() {
            return Err(problem.clone());
        }
        self.now_us = now_us;
        let on = electrodes.channels.iter().position(|connected| *connected);
        let directed = electrodes.cathodic || electrodes.anodic;
        if !self.armed && directed {
            return Err(format!("a way for a current after {}", self.ended_by));
        }
        let flow = match on {
            Some(channel) if electrodes.counts > 0 && directed => {
                Some(Flow { channel, is_cathodic: electrodes.cathodic, counts: electrodes.counts })
            }
            _ => None,
        };
        if flow != self.flow {
            let before = std::mem::replace(&mut self.flow, flow);
            let since_us = std::mem::replace(&mut self.flow_since_us, now_us);
            if let Some(before) = before {
                self.flowed(before, since_us, directed)?;
            }
            if let Some(flow) = flow {
                self.flows(flow)?;
            }
        }
        self.discharges(on, directed)
    }

    /// A phase begins.
    fn flows(&mut self, flow: Flow) -> Result<(), String> {
        let Flow { channel, is_cathodic, counts } = flow;
        if !is_cathodic {
            return Ok(());
        }
        let (bounds, now_us) = (self.bounds, self.now_us);
        // What no longer counts is forgotten.
        let one = &mut self.channels[channel];
        while one.pulses.front().is_some_and(|pulse| pulse.begun_us + 2 * SECOND_US < now_us) {
            one.pulses.pop_front();
        }
        while one.asked.front().is_some_and(|asked| asked.until_us + BEHIND_US < now_us) {
            one.asked.pop_front();
        }
        if one.charge != 0 {
            return Err(format!("{} left on channel {channel}", one.charge));
        }
        if counts > bounds.counts {
            return Err(format!("{counts} counts"));
        }
        let period_us = one.asked.iter().map(Asked::period_us).min();
        let Some(period_us) = period_us else {
            return Err(format!("a pulse on channel {channel} that nobody asks for"));
        };
        if let Some(before) = one.pulses.back()
            && now_us - before.begun_us < period_us.min(one.period_us) / 2
        {
            return Err(format!("pulses {} us apart", now_us - before.begun_us));
        }
        one.period_us = period_us;
        let in_a_second =
            one.pulses.iter().filter(|pulse| pulse.begun_us + SECOND_US > now_us).count() + 1;
        if in_a_second > bounds.pulses + 1 {
            return Err(format!("{in_a_second} pulses in a second"));
        }
        let oldest_us = if self.is_of_rows(channel) {
            self.row_us + bounds.rows_us
        } else {
            self.drive_us + bounds.drives_us
        };
        if now_us > oldest_us + 2 * bounds.tick_us {
            return Err("a pulse that outlives what it was asked by".to_owned());
        }
        let longest_us = self.longest_asked_us(now_us);
        self.session.pulse(now_us, longest_us, bounds.rest_us);
        // The tick that sees that it is over, and a pulse that waits for others.
        if self.session.us > bounds.session_us + bounds.tick_us + BEHIND_US {
            return Err(format!("a session of {} us", self.session.us));
        }
        Ok(())
    }

    /// The longest period of the trains with current that are asked for, and not too old; none
    /// without any.
    fn longest_asked_us(&self, now_us: u64) -> Option<u64> {
        let rows = now_us <= self.row_us + self.bounds.rows_us;
        let drives = now_us <= self.drive_us + self.bounds.drives_us;
        let young = |channel| if self.is_of_rows(channel) { rows } else { drives };
        let channels = self.channels.iter().enumerate().filter(|(index, _)| young(*index));
        let asked = channels.filter_map(|(_, channel)| channel.asked.back());
        let trains = asked.filter(|asked| asked.asks_at(now_us));
        trains.map(Asked::period_us).max()
    }

    /// A phase has ended, as it was to if a way for a current is left.
    fn flowed(&mut self, flow: Flow, since_us: u64, whole: bool) -> Result<(), String> {
        let Flow { channel, is_cathodic, counts } = flow;
        let (bounds, width_us) = (self.bounds, self.now_us - since_us);
        let charge = u64::from(counts) * width_us;
        let one = &mut self.channels[channel];
        one.heats(self.now_us, u64::from(counts) * charge, bounds.mean_square)?;
        if !is_cathodic {
            one.charge += charge as i64;
            if one.charge > 0 {
                return Err(format!("{} too much taken back", one.charge));
            }
            return Ok(());
        }
        one.charge -= charge as i64;
        self.pulses += 1;
        if width_us > bounds.width_us {
            return Err(format!("{width_us} us wide"));
        }
        if charge > bounds.charge {
            return Err(format!("{charge} counts times us in a phase"));
        }
        // A pulse that was cut short was not that wide.
        let fits = |asked: &Asked| {
            let ua = u64::from(asked.stimulus.amplitude_ua);
            let most = ua * 4095 / 50_000;
            let wide = u64::from(asked.stimulus.width_us);
            u64::from(counts) <= most && (width_us == wide || !whole && width_us < wide)
        };
        if !one.asked.iter().any(fits) {
            let asked = &one.asked;
            return Err(format!("{counts} counts for {width_us} us, asked for {asked:?}"));
        }
        let pulse = Pulse { begun_us: since_us, counts, width_us };
        let from = one.last.map_or(0.0, |last| {
            let wider = (last.width_us as f64 / width_us as f64).min(1.0);
            f64::from(last.counts) * wider
        });
        if whole && f64::from(counts) > from + f64::from(bounds.rise) {
            return Err(format!("{counts} counts of {width_us} us after {:?}", one.last));
        }
        one.last = Some(pulse).filter(|_| whole);
        one.pulses.push_back(pulse);
        Ok(())
    }

    /// What is left of a pulse that was cut short flows off, unless the next pulse comes.
    fn discharges(&mut self, on: Option<usize>, directed: bool) -> Result<(), String> {
        let uneven = self.channels.iter().position(|channel| channel.charge != 0);
        let ended = self.flow.is_none() && !directed;
        match (self.discharges, uneven) {
            (None, Some(channel)) if ended => self.discharges = Some((channel, self.now_us)),
            (Some((channel, since_us)), _) => {
                if self.now_us >= since_us + DISCHARGE_US || directed {
                    self.channels[channel].charge = 0;
                    self.discharges = None;
                } else if on != Some(channel) {
                    return Err(format!("discharged for {} us", self.now_us - since_us));
                }
            }
            _ => (),
        }
        Ok(())
    }

    /// A tick has passed: what has become too old by it ends everything.
    pub fn ticked(&mut self, now_us: u64) {
        let bounds = self.bounds;
        let tick_us = bounds.tick_us;
        self.session.goes_on &= self.longest_asked_us(now_us).is_some();
        if now_us > self.heard_us + bounds.silence_us + 2 * tick_us {
            self.ends("a silence");
        }
        if now_us > self.reading_us + bounds.readings_us + 2 * tick_us {
            self.ends("old readings");
        }
        if self.angle_us.is_some_and(|us| now_us > us + bounds.angle_us + 2 * tick_us) {
            self.ends("old angles");
        }
    }

    /// A frame was acted upon.
    pub fn hears(&mut self, now_us: u64) {
        self.heard_us = now_us;
    }

    /// Readings with which nothing is wrong.
    pub fn reads(&mut self, now_us: u64) {
        self.reading_us = now_us;
    }

    /// An angle with which nothing is wrong; from then on they have to come.
    pub fn reads_angle(&mut self, now_us: u64) {
        self.angle_us = Some(now_us);
    }

    fn is_of_rows(&self, channel: usize) -> bool {
        self.row_channels.contains(&channel)
    }

    /// A drive was done in the tick that begins now.
    pub fn drives(&mut self, now_us: u64, stimuli: &[Option<Stimulus>; CHANNELS]) {
        self.drive_us = now_us;
        for (channel, stimulus) in stimuli.iter().enumerate() {
            if !self.is_of_rows(channel) {
                self.asks(now_us, channel, *stimulus);
            }
        }
        self.session.goes_on &= self.longest_asked_us(now_us).is_some();
    }

    /// A row had its tick.
    pub fn steps(&mut self, now_us: u64, stimulus: Option<Stimulus>) {
        self.row_us = now_us;
        for &channel in self.row_channels {
            self.asks(now_us, channel, stimulus);
        }
        self.session.goes_on &= self.longest_asked_us(now_us).is_some();
    }

    fn asks(&mut self, now_us: u64, channel: usize, stimulus: Option<Stimulus>) {
        let Channel { asked, period_us: period, .. } = &mut self.channels[channel];
        if let Some(last) = asked.back_mut()
            && last.until_us > now_us
        {
            if Some(last.stimulus) == stimulus {
                return;
            }
            last.until_us = now_us;
        }
        while asked.front().is_some_and(|asked| asked.until_us + BEHIND_US < now_us) {
            asked.pop_front();
        }
        if let Some(stimulus) = stimulus {
            let new = Asked { stimulus, until_us: FOR_EVER };
            *period = new.period_us().min(*period);
            asked.push_back(new);
        }
    }

    /// The host has armed.
    pub fn arms(&mut self) {
        self.armed = true;
        self.session.goes_on = false;
        for channel in &mut self.channels {
            channel.asked.retain(|asked| asked.until_us == FOR_EVER);
        }
    }

    /// The longest session so far, by its pulses.
    pub fn longest_session_us(&self) -> u64 {
        self.session.longest_us
    }

    /// Whether it is.
    pub fn is_armed(&self) -> bool {
        self.armed
    }

    /// From now on, no current until the host arms.
    pub fn ends(&mut self, cause: &'static str) {
        if self.armed {
            self.ended_by = cause;
        }
        self.armed = false;
        self.channels.iter_mut().for_each(|channel| channel.last = None);
    }

    /// Whatever is put out from now on is not what was asked for so far.
    pub fn forgets(&mut self, now_us: u64) {
        for channel in &mut self.channels {
            for asked in &mut channel.asked {
                asked.until_us = asked.until_us.min(now_us);
            }
        }
        self.session.goes_on = false;
    }

    /// Whether a drive asks for current.
    pub fn is_driven(&self) -> bool {
        let driven = |(index, channel): (usize, &Channel)| {
            !self.is_of_rows(index)
                && channel.asked.back().is_some_and(|last| last.asks_at(self.now_us))
        };
        self.armed && self.channels.iter().enumerate().any(driven)
    }
}
