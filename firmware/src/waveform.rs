//! A biphasic pulse whose charge is nothing, to the last count.
//!
//! The phase that stimulates is cathodic, `counts` for `width`; after the gap, the other takes the charge back,
//! `recovery` times weaker and as many times longer. Counts are a whole multiple of `recovery`, so that the
//! weaker phase has a whole number of them, and both phases have the same counts times µs.
//!
//! Switches take time, and so does a converter: before, between and after the two are phases without current in
//! which channel and direction are switched. Each phase with current then begins and ends with one word to the
//! converter, as the first thing a step does, and lasts as long as it should, however long words and switches take.

use crate::stimulus::{SETTLE_US, Scale, Stimulus, StimulusError};

/// Where a current flows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Out of the tissue at the working electrode: it stimulates.
    Cathodic,
    /// Into the tissue: it takes the charge back.
    Anodic,
}

/// A current that is held for a while.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Phase {
    /// Of the current source; 0 in the gap.
    pub counts: u16,
    /// Where it flows.
    pub direction: Direction,
    /// µs.
    pub duration_us: u16,
}

/// A pulse: settling, stimulation, gap, turning of the bridge (the gap's last part), recovery, settling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulse {
    /// In their order.
    pub phases: [Phase; 6],
}

impl Pulse {
    /// The pulse of a stimulus: at most its amplitude, and less by under `recovery` counts.
    pub fn new(stimulus: &Stimulus, scale: &Scale) -> Result<Self, StimulusError> {
        stimulus.validate(scale)?;
        let Stimulus { amplitude_ua, width_us, gap_us, recovery, .. } = *stimulus;
        Ok(Self::of(scale.counts_of(amplitude_ua), width_us, gap_us, recovery))
    }

    /// The pulse of at most so many counts, of a shape that was validated.
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

    /// Counts of the phase that stimulates.
    pub(crate) fn counts(&self) -> u16 {
        let [_, stimulating, ..] = self.phases;
        stimulating.counts
    }

    /// Net charge, counts times µs, anodic counted up: 0.
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
