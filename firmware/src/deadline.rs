//! Whether ticks begin and end in time, by the timer that calls for them.

/// Judges each tick by its timer's counts since it was due.
#[derive(Clone, Debug)]
pub struct Deadline {
    counts_per_us: u32,
    latest_start: u32,
    longest: u32,
    late: u32,
    in_time: bool,
}

/// A tick must begin within this share of the time between two of them.
const LATEST_START: u32 = 10;

impl Deadline {
    /// For ticks so many µs apart, and a timer of so many counts in a µs.
    pub const fn new(tick_us: u32, counts_per_us: u32) -> Self {
        let latest_start = tick_us * counts_per_us / LATEST_START;
        Self { counts_per_us, latest_start, longest: 0, late: 0, in_time: true }
    }

    /// A tick begins, so many counts after it was due.
    pub fn begin(&mut self, since_due: u32) {
        self.in_time = since_due <= self.latest_start;
    }

    /// It ends, so many counts after it was due, or after the next one was. False if it was late.
    pub fn end(&mut self, since_due: u32, next_is_due: bool) -> bool {
        self.in_time &= !next_is_due;
        self.late = self.late.saturating_add(u32::from(!self.in_time));
        self.longest = self.longest.max(if next_is_due { u32::MAX } else { since_due });
        self.in_time
    }

    /// The longest from when a tick was due to its end, µs; [`u32::MAX`] once one was not done when the next was
    /// due.
    pub fn longest_us(&self) -> u32 {
        match self.longest {
            u32::MAX => u32::MAX,
            counts => counts.div_ceil(self.counts_per_us.max(1)),
        }
    }

    /// Ticks that were late.
    pub fn late(&self) -> u32 {
        self.late
    }
}
