//! Free parameters: place, bounds and prior.

use super::keys::{self, Key};
use crate::model_muscle;
use crate::reference::Muscle;
use serde::Deserialize;

/// Place of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// A number of the muscle.
    Muscle(Key),
    /// A value of the recruitment curve, by index.
    Curve(usize),
    /// An offset that signals of trials refer to.
    Offset,
}

/// Prior of a parameter: mean and standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prior {
    /// Mean, in the parameter's unit.
    pub mean: f64,
    /// Standard deviation, in the parameter's unit.
    pub spread: f64,
}

/// A free parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Key of the muscle file, or name of an offset.
    pub name: String,
    /// Place.
    pub place: Place,
    /// Start of the search.
    pub start: f64,
    /// Bounds.
    pub bounds: (f64, f64),
    /// Prior, if any.
    pub prior: Option<Prior>,
}

/// Starts are drawn within this factor of the given start, and within the bounds.
const DRAWN: f64 = 3.0;

impl Parameter {
    /// Range of starts: the bounds, but at most a factor of three from the start. A parameter with
    /// a confidence interval as wide as this counts as undetermined.
    pub fn range(&self) -> (f64, f64) {
        let (least, most) = self.bounds;
        let (a, b) = (self.start / DRAWN, self.start * DRAWN);
        if a == b { (least, most) } else { (least.max(a.min(b)), most.min(a.max(b))) }
    }

    /// Maps an unbounded number to a value between the bounds (logistic).
    pub fn bounded(&self, free: f64) -> f64 {
        let (least, most) = self.bounds;
        least + (most - least) / (1.0 + (-free).exp())
    }

    /// Inverse of [`Parameter::bounded`].
    pub fn unbounded(&self, value: f64) -> f64 {
        let (least, most) = self.bounds;
        let share = ((value - least) / (most - least)).clamp(1e-6, 1.0 - 1e-6);
        (share / (1.0 - share)).ln()
    }

    /// Whether a value is at one of the bounds, within the search's tolerance.
    pub fn is_at_bound(&self, value: f64) -> bool {
        let (least, most) = self.bounds;
        (value - least).min(most - value) < 1e-4 * (most - least)
    }
}

/// The muscle with its parameters set. F0 is set last; with `keep_force` it keeps its value unless
/// it is a parameter itself.
pub fn applied(
    start: &Muscle,
    parameters: &[Parameter],
    values: &[f64],
    keep_force: bool,
) -> Muscle {
    let mut muscle = start.clone();
    let mut force = keep_force.then(|| start.f0());
    for (parameter, &value) in parameters.iter().zip(values) {
        match &parameter.place {
            Place::Muscle(Key::Force) => force = Some(value),
            Place::Muscle(key) => key.set(&mut muscle, value),
            Place::Curve(_) | Place::Offset => {}
        }
    }
    if let Some(force) = force {
        keys::set_force(&mut muscle, force);
    }
    muscle
}

/// Range of valid values of a key around the muscle's value, with all other numbers unchanged.
pub fn admitted(muscle: &Muscle, key: &Key) -> Option<(f64, f64)> {
    let start = key.value(muscle)?;
    let valid = |value: f64| {
        let mut other = muscle.clone();
        key.set(&mut other, value);
        model_muscle::validate(&other).is_ok()
    };
    let edge = |direction: f64| {
        let (mut inside, mut step) = (start, 0.1 * start.abs().max(1e-3));
        for _ in 0..40 {
            if !valid(inside + direction * step) {
                break;
            }
            inside += direction * step;
            step *= 2.0;
        }
        let mut outside = inside + direction * step;
        while (outside - inside).abs() > 1e-6 * inside.abs().max(1e-6) {
            let middle = 0.5 * (inside + outside);
            if valid(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    };
    valid(start).then(|| (edge(-1.0), edge(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::paper_muscle;

    fn key(name: &str) -> Key {
        Key::named(name).expect("a key")
    }

    #[test]
    fn default_bounds_are_the_builders_limits() {
        let muscle = paper_muscle();
        // MuscleParams: f0.5 is 0.5 to 200 pps.
        let (least, most) = admitted(&muscle, &key("fiber[0].f05_pps")).expect("a range");
        assert!((least - 0.5).abs() < 1e-3 && (most - 200.0).abs() < 1e-3, "{least} {most}");
        let (least, most) = admitted(&muscle, &key("recruitment_saturation")).expect("a range");
        assert!((least - 0.01).abs() < 1e-4 && (most - 1.0).abs() < 1e-4, "{least} {most}");
        assert_eq!(admitted(&muscle, &key("fatigue.beta")), None);
    }

    #[test]
    fn a_parameter_stays_within_its_bounds() {
        let parameter = Parameter {
            name: "fascicle_length_cm".to_owned(),
            place: Place::Muscle(key("fascicle_length_cm")),
            start: 11.0,
            bounds: (5.0, 20.0),
            prior: None,
        };
        for value in [5.1, 11.0, 19.9] {
            assert!((parameter.bounded(parameter.unbounded(value)) - value).abs() < 1e-9);
        }
        assert!(parameter.bounded(-700.0) >= 5.0 && parameter.bounded(700.0) <= 20.0);
        assert!(parameter.is_at_bound(5.001) && !parameter.is_at_bound(5.1));
        assert_eq!(parameter.range(), (5.0, 20.0));
    }

    #[test]
    fn f0_is_set_last_and_kept_on_request() {
        let muscle = paper_muscle();
        let parameter = |name: &str, start| Parameter {
            name: name.to_owned(),
            place: Place::Muscle(key(name)),
            start,
            bounds: (1.0, 1000.0),
            prior: None,
        };
        let both =
            [parameter("max_isometric_force_n", 266.0), parameter("fascicle_length_cm", 11.0)];
        let fitted = applied(&muscle, &both, &[300.0, 8.0], false);
        assert!((fitted.f0() - 300.0).abs() < 1e-9 && fitted.L_ce0 == 0.08);
        let length = &both[1..];
        assert!((applied(&muscle, length, &[8.0], true).f0() - muscle.f0()).abs() < 1e-9);
        let lighter = applied(&muscle, length, &[5.5], false);
        assert!((lighter.f0() - 2.0 * muscle.f0()).abs() < 1e-9, "mass is kept");
    }
}
