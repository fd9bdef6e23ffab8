//! A joint of one angle with a flexor and an extensor, as controllers take it.

use crate::errors::refused;
use crate::joint::Joint;
use host_sim::model_muscle;
use host_sim::reference::Muscle as Parameters;
use pyo3::PyResult;
use vm_nostd::control::{AngleRange, PathParams};
use vm_nostd::{MuscleParams, TimeStep};

/// A flexor and an extensor of a joint.
pub struct Antagonists<'a> {
    /// Range of the angle.
    pub range: AngleRange,
    /// Paths of both.
    pub paths: [PathParams<1>; 2],
    muscles: [&'a Parameters; 2],
    /// Fibre types of each.
    pub types: usize,
}

impl<'a> Antagonists<'a> {
    /// Those of a joint; refused if it has more joints or muscles, or muscles of other types.
    pub fn of(joint: &'a Joint) -> PyResult<Self> {
        let ([range], [flexor, extensor]) = (joint.ranges.as_slice(), joint.muscles.as_slice())
        else {
            let found = format!("{} joints, {} muscles", joint.ranges.len(), joint.muscles.len());
            return Err(refused("joint", &found, "must be one joint, a flexor and an extensor"));
        };
        let muscles = [flexor, extensor].map(|muscle| muscle.get().parameters());
        let [types, others] = muscles.map(|muscle| muscle.fibers.len());
        if types != others {
            let found = format!("{types} and {others} fibre types");
            return Err(refused("joint", &found, "both muscles must have as many"));
        }
        let paths = [joint.paths[0].about()?, joint.paths[1].about()?];
        Ok(Self { range: *range, paths, muscles, types })
    }

    /// The muscles' parameters, of `N` fibre types each.
    pub fn params<const N: usize>(&self) -> [MuscleParams<N>; 2] {
        self.muscles.map(model_muscle::params)
    }
}

/// A time step.
pub fn time_step(seconds: f64) -> PyResult<TimeStep> {
    TimeStep::from_seconds(seconds).map_err(crate::errors::parameter)
}

/// Saved words as those of an arithmetic.
pub fn words<B: TryFrom<u64>>(words: &[u64]) -> Result<Vec<B>, String> {
    let words: Result<Vec<B>, _> = words.iter().map(|&word| B::try_from(word)).collect();
    words.map_err(|_| "a word is too large for the arithmetic".to_owned())
}
