//! A free parameter in the list of trials.

use crate::fit::error::{FitError, Refuse};
use crate::fit::keys::Key;
use crate::fit::parameters::{Parameter, Place, Prior, admitted};
use crate::fit::priors;
use crate::muscle_file::curve::{self, CURVE};
use crate::reference::Muscle;
use serde::Deserialize;
use vm_nostd::RecruitmentCurveParams;

/// `[[free]]` in the list of trials.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FreeTable {
    name: String,
    start: Option<f64>,
    bounds: Option<(f64, f64)>,
    prior: Option<PriorKey>,
}

#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "must be \"published\" or { mean = ..., spread = ... }")]
enum PriorKey {
    Named(String),
    Given(Prior),
}

impl FreeTable {
    /// The parameter, with missing values taken from the muscle or the recruitment curve.
    pub fn parameter(
        &self,
        muscle: &Muscle,
        curve: Option<&RecruitmentCurveParams>,
        refuse: Refuse<'_>,
    ) -> Result<Parameter, FitError> {
        let name = &self.name;
        let refuse = |problem: String| refuse(format!("[[free]] {name}: {problem}"));
        let missing = |what: &str| refuse(format!("{what} = (missing): give it"));
        let (place, start, builder) = if let Some(key) = Key::named(name) {
            let part = || refuse("the muscle has no such part".to_owned());
            let value = key.value(muscle).ok_or_else(part)?;
            let bounds = admitted(muscle, &key);
            (Place::Muscle(key), Some(value), bounds)
        } else if let Some(rest) = name.strip_prefix(CURVE) {
            let index = curve::key(rest)
                .ok_or_else(|| refuse(format!("a recruitment curve has {}", curve::names())))?;
            let curve = curve.ok_or_else(|| missing("[recruitment_curve]"))?;
            (Place::Curve(index), Some(curve::values(curve)[index]), None)
        } else {
            (Place::Offset, None, None)
        };
        let start = self.start.or(start).ok_or_else(|| missing("start"))?;
        let bounds = self.bounds.or(builder).ok_or_else(|| missing("bounds"))?;
        if !(bounds.0 < start && start < bounds.1 && (bounds.1 - bounds.0).is_finite()) {
            let (least, most) = bounds;
            return Err(refuse(format!(
                "start = {start}: must be within its bounds {least} and {most}"
            )));
        }
        let prior = match &self.prior {
            None => None,
            Some(PriorKey::Given(prior)) => Some(*prior),
            Some(PriorKey::Named(word)) if word == "published" => {
                let spread = priors::published(name).ok_or_else(|| {
                    refuse(format!("no published spread; there is one of {}", priors::names()))
                })?;
                Some(Prior { mean: start, spread: spread * start.abs() })
            }
            Some(PriorKey::Named(word)) => {
                let limit = "must be \"published\" or { mean = ..., spread = ... }";
                return Err(refuse(format!("prior = \"{word}\": {limit}")));
            }
        };
        if let Some(prior) = prior
            && !(prior.spread > 0.0 && prior.mean.is_finite() && prior.spread.is_finite())
        {
            return Err(refuse(format!("prior.spread = {}: must be more than 0", prior.spread)));
        }
        Ok(Parameter { name: name.clone(), place, start, bounds, prior })
    }
}
