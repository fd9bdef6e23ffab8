//! Accuracy classes: the number of substeps per tick.

/// Accuracy class of a muscle, a trade-off of accuracy and cycles.
///
/// The tolerances are in `host-sim/data/tolerances.csv` and checked by `vm verify` and `vm sweep`.
/// The class determines the truncation error of the mechanics, which occurs where path or
/// stimulation frequency step and where a slack tendon snaps taut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Class {
    /// One substep per tick, unless the muscle rings too fast for that on a stiff tendon. For low
    /// power: the error is a few percent of F0 for some milliseconds after a jerk, and that of the
    /// other classes on smooth inputs.
    Economy,
    /// Substeps of at most 0.25 ms.
    #[default]
    Standard,
    /// Substeps of at most 0.1 ms. For regression tests.
    Fine,
}

/// Limits of the substeps of a class.
pub(crate) struct Substeps {
    /// Longest substep, s, in ticks of at least 1 ms and in shorter ones, which have a tighter
    /// tolerance.
    pub(crate) longest: (f64, f64),
    /// Greatest w h √A for a substep h, with angular frequency w and amplitude A (F0) of the
    /// ringing after a jump of path velocity by 1 L_ce0/s. The error of a second-order step is
    /// proportional to its square.
    pub(crate) ringing: f64,
}

impl Class {
    pub(crate) fn substeps(self) -> Substeps {
        match self {
            Self::Economy => Substeps { longest: (f64::MAX, f64::MAX), ringing: f64::MAX },
            Self::Standard => Substeps { longest: (0.25e-3, 0.15e-3), ringing: 0.35 },
            Self::Fine => Substeps { longest: (0.1e-3, 0.1e-3), ringing: 0.15 },
        }
    }
}
