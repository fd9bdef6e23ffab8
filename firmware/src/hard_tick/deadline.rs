//! Deadlines of ticks, by the timer that triggers them.

/// Checks each tick by its timer's counts since it was due.
#[derive(Clone, Debug)]
pub struct Deadline {
    counts_per_us: u32,
    latest_start: u32,
    longest: u32,
    late: u32,
    in_time: bool,
}

/// A tick must begin within this fraction of the tick time.
const LATEST_START: u32 = 10;

impl Deadline {
    /// For a tick time (µs) and a timer's counts per µs.
    pub const fn new(tick_us: u32, counts_per_us: u32) -> Self {
        let latest_start = tick_us * counts_per_us / LATEST_START;
        Self { counts_per_us, latest_start, longest: 0, late: 0, in_time: true }
    }

    /// A tick begins this many counts after it was due.
    pub fn begin(&mut self, since_due: u32) {
        self.in_time = since_due <= self.latest_start;
    }

    /// It ends this many counts after it was due, or after the next one was due. False if it was
    /// late.
    pub fn end(&mut self, since_due: u32, next_is_due: bool) -> bool {
        self.in_time &= !next_is_due;
        self.late = self.late.saturating_add(u32::from(!self.in_time));
        self.longest = self.longest.max(if next_is_due { u32::MAX } else { since_due });
        self.in_time
    }

    /// Longest time from a tick's due time to its end, µs; [`u32::MAX`] after a tick that overran
    /// the next.
    pub fn longest_us(&self) -> u32 {
        match self.longest {
            u32::MAX => u32::MAX,
            counts => counts.div_ceil(self.counts_per_us.max(1)),
        }
    }

    /// Number of late ticks.
    pub fn late(&self) -> u32 {
        self.late
    }
}

#[cfg(test)]
mod tests {
    use super::Deadline;

    #[test]
    fn a_tick_is_late_if_it_begins_after_a_tenth_or_ends_after_the_next() {
        // 8 counts per µs, 1 ms.
        let mut deadline = Deadline::new(1_000, 8);
        assert_eq!((deadline.longest_us(), deadline.late()), (0, 0));
        for (begins, ends, next_is_due, in_time, longest_us, late) in [
            (0, 800, false, true, 100, 0),
            (800, 1_601, false, true, 201, 0),
            (801, 900, false, false, 201, 1),
            (0, 7_999, false, true, 1_000, 1),
            (0, 10, true, false, u32::MAX, 2),
            (0, 800, false, true, u32::MAX, 2),
        ] {
            deadline.begin(begins);
            assert_eq!(deadline.end(ends, next_is_due), in_time, "{begins} to {ends}");
            assert_eq!((deadline.longest_us(), deadline.late()), (longest_us, late));
        }
    }
}
