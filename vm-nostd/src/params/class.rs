//! Accuracy classes: the number of parts of a tick, and of substeps of its mechanics.

use crate::scalar::MOST_PARTS;
use crate::tick::time_step::TimeStep;

/// Accuracy class of a muscle, a trade-off of accuracy and cycles.
///
/// The tolerances are in `host-sim/data/tolerances.csv` and checked by `vm verify` and `vm sweep`.
/// The class determines the truncation error: that of the mechanics occurs where path or
/// stimulation frequency step and where a slack tendon snaps taut, that of the filaments on fast
/// paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Class {
    /// One substep per tick, unless the muscle rings too fast or too much for that on a stiff
    /// tendon. For low power: the error is a few percent of F0 for some milliseconds after a jerk,
    /// and some tenths of a percent otherwise.
    Economy,
    /// Substeps of at most 0.25 ms.
    #[default]
    Standard,
    /// Substeps of at most 0.063 ms, and all else once in 0.25 ms: a longer tick is taken in equal
    /// parts. For comparisons.
    Fine,
}

/// Limits of the substeps of a class.
pub(crate) struct Substeps {
    /// Longest substep, s.
    pub(crate) longest: f64,
    /// Greatest w h √A for a substep h, with angular frequency w and amplitude A (F0) of the
    /// ringing after a jump of path velocity by 1 L_ce0/s. The error of a second-order step is
    /// proportional to its square.
    pub(crate) ringing: f64,
    /// Greatest A with one substep, F0. The error of a substep as long as the ringing's period is
    /// in proportion to A, whatever w. The paper's muscle has 0.056 F0.
    pub(crate) single: f64,
}

/// Ticks at least this long have a looser limit, s: 1 ms less a rounding tolerance.
const COARSE_TICK: f64 = 0.999e-3;
/// Longest part of a tick in the fine class, s: 0.25 ms and a rounding tolerance.
const LONGEST_PART: f64 = 0.251e-3;

impl Class {
    /// Number of equal parts in which a tick is taken.
    pub(crate) fn parts(self, step: TimeStep) -> u8 {
        match self {
            Self::Economy | Self::Standard => 1,
            Self::Fine => (1..MOST_PARTS)
                .find(|&parts| step.part(parts).seconds() <= LONGEST_PART)
                .unwrap_or(MOST_PARTS),
        }
    }

    pub(crate) fn substeps(self, step: TimeStep) -> Substeps {
        match self {
            Self::Economy => Substeps { longest: f64::MAX, ringing: f64::MAX, single: 0.06 },
            Self::Standard => {
                let longest = if step.seconds() >= COARSE_TICK { 0.25e-3 } else { 0.15e-3 };
                Substeps { longest, ringing: 0.35, single: f64::MAX }
            }
            Self::Fine => Substeps { longest: 0.063e-3, ringing: 0.15, single: f64::MAX },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fine_ticks_are_taken_in_parts_of_at_most_a_quarter_of_a_millisecond() {
        let ticks = [0.1, 0.5, 0.51, 0.6, 1.0, 1.1, 1.5, 1.6, 2.0];
        let parts = |class: Class| {
            ticks.map(|tick| class.parts(TimeStep::from_seconds(tick * 1e-3).unwrap()))
        };
        assert_eq!(parts(Class::Fine), [1, 2, 3, 3, 4, 5, 6, 7, 8]);
        assert_eq!(parts(Class::Standard), [1; 9]);
        assert_eq!(parts(Class::Economy), [1; 9]);
    }
}
