//! A session, told by the pulses that were put out.

/// For how long after something else was asked for, a pulse of before may still begin: the longest
/// pulse of another channel, a step, and a tick.
pub(super) const BEHIND_US: u64 = 12_000;

/// The time between one pulse and the next counts while something asks for pulses all the while.
#[derive(Debug, Default)]
pub(super) struct Session {
    /// So far, and the longest there was.
    pub us: u64,
    pub longest_us: u64,
    /// When the last pulse of any channel began; none before the first.
    last_us: Option<u64>,
    /// The longest period that was asked for then.
    period_us: u64,
    /// Since then something has always asked for pulses, and nothing was armed anew.
    pub goes_on: bool,
}

impl Session {
    /// A pulse begins, while trains are asked for of which this is the longest period, if any.
    pub fn pulse(&mut self, now_us: u64, period_us: Option<u64>, rest_us: u64) {
        if let Some(last_us) = self.last_us {
            let gap_us = now_us - last_us;
            // The next pulse of a train was due a period after the last: only then does a rest
            // begin.
            if gap_us + BEHIND_US >= self.period_us + rest_us {
                self.us = 0;
            } else if self.goes_on {
                self.us += gap_us;
                self.longest_us = self.longest_us.max(self.us);
            }
        }
        self.last_us = Some(now_us);
        self.period_us = period_us.unwrap_or(0);
        self.goes_on = period_us.is_some();
    }
}
