//! A charge-balanced biphasic pulse: the net charge is exactly 0 counts times µs.
//!
//! The stimulating phase is cathodic, `counts` for `width`. After the interphase gap, the recharge
//! phase is `recovery` times weaker and longer. Counts are a multiple of `recovery`, so that both
//! phases have exactly the same counts times µs.
//!
//! Channel and direction are switched in phases without current before, between and after the two.
//! Each phase with current begins and ends with one word to the converter, the first action of a
//! step, so that its duration does not depend on the time of words and switches.

use crate::between::stimulus::{SETTLE_US, Scale, Stimulus, StimulusError};

/// Direction of a current.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Cathodic: out of the tissue at the working electrode; stimulates.
    Cathodic,
    /// Anodic: into the tissue; recharges.
    Anodic,
}

/// A constant current for a duration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Phase {
    /// Of the current source; 0 in the gap.
    pub counts: u16,
    /// Direction.
    pub direction: Direction,
    /// µs.
    pub duration_us: u16,
}

/// A pulse: settling, stimulation, interphase gap (its last part reverses the bridge), recharge,
/// settling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulse {
    /// Phases in order.
    pub phases: [Phase; 6],
}

impl Pulse {
    /// The pulse of a stimulus: its amplitude, rounded down to a multiple of `recovery` counts.
    pub fn new(stimulus: &Stimulus, scale: &Scale) -> Result<Self, StimulusError> {
        stimulus.validate(scale)?;
        let Stimulus { amplitude_ua, width_us, gap_us, recovery, .. } = *stimulus;
        Ok(Self::of(scale.counts_of(amplitude_ua), width_us, gap_us, recovery))
    }

    /// A pulse of at most this many counts, of a validated shape.
    pub(crate) fn of(counts: u16, width_us: u16, gap_us: u16, recovery: u8) -> Self {
        let recovery = u16::from(recovery.max(1));
        let weak = counts / recovery;
        let phase = |counts, direction, duration_us| Phase { counts, direction, duration_us };
        Self {
            phases: [
                phase(0, Direction::Cathodic, SETTLE_US),
                phase(weak * recovery, Direction::Cathodic, width_us),
                // Validation has seen to it that there is as much, and more.
                phase(0, Direction::Cathodic, gap_us.saturating_sub(SETTLE_US)),
                phase(0, Direction::Anodic, SETTLE_US),
                phase(weak, Direction::Anodic, width_us.saturating_mul(recovery)),
                phase(0, Direction::Anodic, SETTLE_US),
            ],
        }
    }

    /// Counts of the stimulating phase.
    pub(crate) fn counts(&self) -> u16 {
        let [_, stimulating, ..] = self.phases;
        stimulating.counts
    }

    /// Net charge, counts times µs, anodic positive: 0.
    pub fn net_charge(&self) -> i64 {
        self.phases
            .iter()
            .map(|phase| {
                let charge = i64::from(phase.counts) * i64::from(phase.duration_us);
                if phase.direction == Direction::Cathodic { -charge } else { charge }
            })
            .sum()
    }
}
