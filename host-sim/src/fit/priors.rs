//! Spreads of parameters among people, as published: `data/priors.csv`, which says where each is
//! from.

use serde::Deserialize;

const TABLE: &str = include_str!("../../data/priors.csv");

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    /// Last part of a parameter's name.
    key: String,
    /// Standard deviation over mean.
    relative_spread: f64,
    /// Where it is from.
    source: String,
}

fn rows() -> Vec<Row> {
    csv::Reader::from_reader(TABLE.as_bytes())
        .deserialize()
        .map(|row| row.expect("an even row in the built-in table"))
        .filter(|row: &Row| !row.source.is_empty())
        .collect()
}

/// The published spread of a parameter, as a share of its mean.
pub fn published(name: &str) -> Option<f64> {
    let key = name.rsplit_once('.').map_or(name, |(_, key)| key);
    rows().into_iter().find(|row| row.key == key).map(|row| row.relative_spread)
}

/// All that have one, for a message.
pub fn names() -> String {
    rows().iter().map(|row| row.key.clone()).collect::<Vec<_>>().join(", ")
}
