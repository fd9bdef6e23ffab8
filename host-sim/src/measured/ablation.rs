//! Fits the model without a feature.

use super::{Fitted, Found, LeftOut};
use crate::engine::Arithmetic;
use crate::fit::{Fit, FitError, Parameter, Place, Search, applied, fit};

impl Found {
    /// Fits the model without a feature: one start from the solution `whole` of the complete
    /// model, or from the definition's where the ablated muscle cannot be built there.
    ///
    /// A parameter that the recordings do not determine without the feature keeps its value in
    /// the complete model, and is named beside the fit.
    pub(super) fn without(&self, out: LeftOut, whole: &Fit) -> Result<Fitted, FitError> {
        let mut held: Vec<String> = Vec::new();
        let mut from_whole = true;
        loop {
            match self.attempt(out, whole, from_whole, &held) {
                Err(FitError::Start { .. }) if from_whole => from_whole = false,
                Err(FitError::Undetermined(names))
                    if names.iter().all(|name| self.is_of_the_muscle(name)) =>
                {
                    held.extend(names);
                }
                end => return end.map(|fit| (fit, held)),
            }
        }
    }

    fn attempt(
        &self,
        out: LeftOut,
        whole: &Fit,
        from_whole: bool,
        held: &[String],
    ) -> Result<Fit, FitError> {
        let fitted = |parameter: &Parameter| {
            let mut estimates = whole.estimates.iter();
            estimates.find(|estimate| estimate.name == parameter.name)
        };
        let (kept, values): (Vec<Parameter>, Vec<f64>) = self
            .trials
            .parameters
            .iter()
            .filter(|parameter| held.contains(&parameter.name))
            .filter_map(|parameter| Some((parameter.clone(), fitted(parameter)?.value)))
            .unzip();
        let mut start = self.start.named.clone();
        start.muscle = applied(&start.muscle, &kept, &values, self.start.keep_force);
        out.out_of(&mut start.muscle);
        let mut trials = self.trials.clone();
        trials.keep(|parameter| !out.concerns(&parameter.name) && !held.contains(&parameter.name));
        if from_whole {
            let inside = whole.estimates.iter().filter(|estimate| !estimate.at_bound);
            trials.start_at(inside.map(|estimate| (estimate.name.as_str(), estimate.value)));
        }
        // The seed has no effect with one start.
        let search = Search { starts: 1, seed: 0 };
        // Fixed point need not accept an ablated muscle.
        fit(&start, self.start.keep_force, trials, &search, &[Arithmetic::F32])
    }

    fn is_of_the_muscle(&self, name: &str) -> bool {
        let mut parameters = self.trials.parameters.iter();
        parameters.any(|p| p.name == name && matches!(p.place, Place::Muscle(_)))
    }
}
