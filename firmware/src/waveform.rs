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
        let recovery = u16::from(stimulus.recovery);
        // 64 bits: µA times counts may have 35.
        let wanted = u64::from(stimulus.amplitude_ua) * u64::from(scale.full_scale_counts)
            / u64::from(scale.full_scale_ua.max(1));
        // No more than full scale, which validation has seen to.
        let weak = wanted as u16 / recovery;
        let phase = |counts, direction, duration_us| Phase { counts, direction, duration_us };
        Ok(Self {
            phases: [
                phase(0, Direction::Cathodic, SETTLE_US),
                phase(weak * recovery, Direction::Cathodic, stimulus.width_us),
                // Validation has seen to it that there is as much, and more.
                phase(0, Direction::Cathodic, stimulus.gap_us.saturating_sub(SETTLE_US)),
                phase(0, Direction::Anodic, SETTLE_US),
                phase(weak, Direction::Anodic, stimulus.width_us * recovery),
                phase(0, Direction::Anodic, SETTLE_US),
            ],
        })
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
