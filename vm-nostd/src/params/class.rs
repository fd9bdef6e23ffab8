//! How accurate a muscle is computed: into how many substeps its ticks are divided.

/// How accurate a muscle is computed, and at what cost. Chosen when it is built.
///
/// What each class promises is in `host-sim/data/tolerances.csv` and held by `vm verify` and `vm
/// sweep`. The error that falls with the class is that of the mechanics: where a path or a
/// stimulation frequency steps, and where a slack tendon comes taut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Class {
    /// One substep a tick, unless the muscle rings too fast for that on a stiff tendon. For
    /// batteries: a few percent of F0 for some milliseconds after a jerk, as little as the other
    /// classes on smooth inputs.
    Economy,
    /// Substeps of 0.25 ms or less.
    #[default]
    Standard,
    /// Substeps of 0.1 ms or less. For regression.
    Fine,
}

/// What a class asks of the substeps.
pub(crate) struct Substeps {
    /// The longest, s, in a tick of 1 ms or more, and in a shorter one, of which less error is
    /// expected.
    pub(crate) longest: (f64, f64),
    /// The greatest w h √A, of a muscle that rings on its tendon at angular frequency w and with
    /// amplitude A in F0 where the path's speed jumps by 1 L_ce0/s. The error of a second-order
    /// step goes with its square.
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
