//! Ablations: features left out of the model to measure their benefit on real muscle.

use crate::reference::Muscle;

/// An ablation, or the full model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOut {
    /// The full model.
    Nothing,
    /// Without yield.
    Yield,
    /// n_f is nf0 at all lengths.
    ActivationLength,
    /// FV at all lengths as at L_ce0.
    VelocityLength,
}

impl LeftOut {
    /// All versions, the full model first.
    pub const ALL: [Self; 4] =
        [Self::Nothing, Self::Yield, Self::ActivationLength, Self::VelocityLength];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Yield => "yield",
            Self::ActivationLength => "length dependence of Af",
            Self::VelocityLength => "length dependence of FV",
        }
    }

    /// Removes the feature from a muscle.
    pub(super) fn out_of(self, muscle: &mut Muscle) {
        for fiber in &mut muscle.fibers {
            let t = &mut fiber.fiber_type;
            match self {
                Self::Nothing => {}
                Self::Yield => t.yielding = None,
                Self::ActivationLength => t.nf1 = 0.0,
                Self::VelocityLength => {
                    (t.cV0, t.cV1) = (t.cV0 + t.cV1, 0.0);
                    (t.aV0, t.aV1, t.aV2) = (t.aV0 + t.aV1 + t.aV2, 0.0, 0.0);
                }
            }
        }
    }

    /// Whether a free parameter belongs to the left-out feature.
    pub(super) fn concerns(self, name: &str) -> bool {
        let keys: &[&str] = match self {
            Self::Nothing => &[],
            Self::Yield => &["cY", "VY", "TY_ms"],
            Self::ActivationLength => &["nf1"],
            Self::VelocityLength => &["cV1", "aV1", "aV2"],
        };
        name.rsplit_once('.').is_some_and(|(_, key)| keys.contains(&key))
    }
}
