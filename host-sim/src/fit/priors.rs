//! Spreads of parameters among people: `data/priors.csv`, which says where each is from, or that it
//! is assumed.

use serde::Deserialize;

const TABLE: &str = include_str!("../../data/priors.csv");

/// What a spread was taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Basis {
    /// Measured among people, or among motor units of people.
    People,
    /// Between published sets of coefficients: how far their authors are apart.
    Presets,
    /// Nobody's measurement: an assumption, to be replaced.
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
    /// What it was taken from.
    pub basis: Basis,
    /// Where it is from, or what is assumed.
    pub source: String,
}

/// All rows.
pub fn all() -> Vec<Spread> {
    csv::Reader::from_reader(TABLE.as_bytes())
        .deserialize()
        .map(|row| row.expect("an even row in the built-in table"))
        .collect()
}

/// The spread of a parameter: of its whole name or, where the table has none, of its last part.
pub fn spread(name: &str) -> Option<Spread> {
    let last = name.rsplit_once('.').map_or(name, |(_, key)| key);
    let rows = all();
    let find = |key: &str| rows.iter().find(|row| row.key == key).cloned();
    find(name).or_else(|| find(last))
}

/// The published spread of a parameter, as a share of its mean; none where there is only an
/// assumption.
pub fn published(name: &str) -> Option<f64> {
    spread(name).filter(|row| row.basis != Basis::Assumed).map(|row| row.relative_spread)
}

/// All that have a published one, for a message.
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
    fn every_row_is_of_a_parameter_and_says_where_it_is_from() {
        for row in all() {
            let key = &row.key;
            let fiber = format!("fiber[0].{key}");
            let known = [key, &fiber].iter().any(|name| Key::named(name).is_some())
                || key.strip_prefix(curve::CURVE).is_some_and(|key| curve::key(key).is_some());
            assert!(known, "{key}: no parameter");
            assert!((0.01..=1.0).contains(&row.relative_spread), "{key}");
            // A year, or the word: neither fits into less.
            assert!(row.source.len() > 20, "{key}: {}", row.source);
            let says = row.source.contains("assum");
            assert_eq!(says, row.basis == Basis::Assumed, "{key}: {}", row.source);
        }
    }

    #[test]
    fn spreads_between_presets_are_those_of_the_table() {
        let of =
            |set: &str, key: &str| coefficients::fiber_row(set).and_then(|r| r.get(key).copied());
        for row in all().into_iter().filter(|row| row.basis == Basis::Presets) {
            let between = |fiber: &str| {
                let sets = ["human-vm4", "feline-vm4"].map(|set| format!("{set}/{fiber}"));
                let [one, other] = sets.map(|set| of(&set, &row.key).expect("a coefficient"));
                // Of two values, standard deviation is difference over the root of two.
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
        // Of fatigue, not that of the force-length relation.
        assert!(spread("fatigue.beta").is_some() && spread("fiber[0].beta").is_none());
    }
}
