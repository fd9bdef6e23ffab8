//! Spreads of parameters among people, with their sources: `data/priors.csv`.

use serde::Deserialize;

const TABLE: &str = include_str!("../../data/priors.csv");

/// Basis of a spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Basis {
    /// Measured among people, or among motor units of people.
    People,
    /// Difference between published sets of coefficients.
    Presets,
    /// Not measured: an assumption, to be replaced.
    Assumed,
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// Name of a parameter, or its last part.
    pub key: String,
    /// Standard deviation over mean.
    pub relative_spread: f64,
    /// Basis.
    pub basis: Basis,
    /// Source, or the assumption.
    pub source: String,
}

/// All rows.
pub fn all() -> Vec<Spread> {
    csv::Reader::from_reader(TABLE.as_bytes())
        .deserialize()
        .map(|row| row.expect("an even row in the built-in table"))
        .collect()
}

/// The spread of a parameter: that of its whole name, otherwise that of its last part.
pub fn spread(name: &str) -> Option<Spread> {
    let last = name.rsplit_once('.').map_or(name, |(_, key)| key);
    let rows = all();
    let find = |key: &str| rows.iter().find(|row| row.key == key).cloned();
    find(name).or_else(|| find(last))
}

/// The published spread of a parameter over its mean; `None` if the spread is only assumed.
pub fn published(name: &str) -> Option<f64> {
    spread(name).filter(|row| row.basis != Basis::Assumed).map(|row| row.relative_spread)
}

/// Keys with a published spread, for error messages.
pub fn names() -> String {
    let rows = all().into_iter().filter(|row| row.basis != Basis::Assumed);
    rows.map(|row| row.key).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coefficients;
    use crate::fit::keys::Key;
    use crate::muscle_file::curve;

    #[test]
    fn every_row_has_a_known_parameter_and_a_source() {
        for row in all() {
            let key = &row.key;
            let fiber = format!("fiber[0].{key}");
            let known = [key, &fiber].iter().any(|name| Key::named(name).is_some())
                || key.strip_prefix(curve::CURVE).is_some_and(|key| curve::key(key).is_some());
            assert!(known, "{key}: no parameter");
            assert!((0.01..=1.0).contains(&row.relative_spread), "{key}");
            // A source with a year, or the word "assumed", is longer than this.
            assert!(row.source.len() > 20, "{key}: {}", row.source);
            let says = row.source.contains("assum");
            assert_eq!(says, row.basis == Basis::Assumed, "{key}: {}", row.source);
        }
    }

    #[test]
    fn spreads_between_presets_follow_from_the_presets() {
        let of =
            |set: &str, key: &str| coefficients::fiber_row(set).and_then(|r| r.get(key).copied());
        for row in all().into_iter().filter(|row| row.basis == Basis::Presets) {
            let between = |fiber: &str| {
                let sets = ["human-vm4", "feline-vm4"].map(|set| format!("{set}/{fiber}"));
                let [one, other] = sets.map(|set| of(&set, &row.key).expect("a coefficient"));
                // The standard deviation of two values is their difference over the root of two.
                ((one - other) / (one + other)).abs() * 2_f64.sqrt()
            };
            let widest = between("slow").max(between("fast"));
            assert!((widest - row.relative_spread).abs() < 5e-4, "{}: {widest}", row.key);
        }
    }

    #[test]
    fn an_assumption_is_not_published() {
        assert_eq!(published("fiber[1].f05_pps"), Some(0.333));
        assert!(spread("max_path_length_cm").is_some());
        assert_eq!(published("max_path_length_cm"), None);
        // beta of fatigue, not of the force-length relation.
        assert!(spread("fatigue.beta").is_some() && spread("fiber[0].beta").is_none());
    }
}
