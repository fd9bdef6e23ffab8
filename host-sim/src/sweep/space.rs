//! Space of a sweep: a grid of values or a random sample.

use super::case::Case;
use super::keys::{KEYS, Key};
use crate::engine::mode_name;
use crate::reference::Mode;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::fmt;
use std::str::FromStr;

/// Values of a key on the command line: `key=value`, `key=from:to` or `key=value,value,...`.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// Index of the key.
    key: usize,
    values: Values,
}

#[derive(Clone, Debug, PartialEq)]
enum Values {
    Range(f64, f64),
    Listed(Vec<f64>),
}

/// Why a sweep was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpaceError {
    /// Not `key=...`.
    #[error("\"{0}\": must be key=value, key=from:to or key=value,value,... with a key of {keys}", keys = names())]
    Form(String),
    /// A value that is not a number or is out of range.
    #[error("{key} = {value}: must be a number from {least} to {most}")]
    Value {
        /// The key.
        key: &'static str,
        /// The refused value, as given.
        value: String,
        /// Least allowed value.
        least: f64,
        /// Greatest allowed value.
        most: f64,
    },
    /// A range whose end is below its start.
    #[error("{key} = {from}:{to}: the end is below the start")]
    Order {
        /// The key.
        key: &'static str,
        /// Start.
        from: f64,
        /// End.
        to: f64,
    },
    /// A key, or a mode, given twice.
    #[error("{0}: given twice")]
    Twice(String),
    /// A grid needs values.
    #[error(
        "{0}: a grid needs values, not a range: key=value,value,... (or a sample, with --random)"
    )]
    RangeInGrid(&'static str),
    /// Too many cases, or none.
    #[error("{0} cases: must be 1 to {most}", most = MOST_CASES)]
    Count(usize),
}

fn names() -> String {
    KEYS.map(|key| key.name).join(", ")
}

/// Memory limit: a row takes about a kilobyte.
pub const MOST_CASES: usize = 1_000_000;

impl FromStr for Variation {
    type Err = SpaceError;

    fn from_str(text: &str) -> Result<Self, SpaceError> {
        let form = || SpaceError::Form(text.to_owned());
        let (name, values) = text.split_once('=').ok_or_else(form)?;
        let index = KEYS.iter().position(|key| key.name == name).ok_or_else(form)?;
        let Key { name: key, limits: (least, most), .. } = KEYS[index];
        let number = |value: &str| {
            let refused = || SpaceError::Value { key, value: value.to_owned(), least, most };
            let number = value.trim().parse::<f64>().map_err(|_| refused())?;
            if (least..=most).contains(&number) { Ok(number) } else { Err(refused()) }
        };
        let values = match values.split_once(':') {
            Some((from, to)) => {
                let (from, to) = (number(from)?, number(to)?);
                if from > to {
                    return Err(SpaceError::Order { key, from, to });
                }
                Values::Range(from, to)
            }
            None => Values::Listed(values.split(',').map(number).collect::<Result<_, _>>()?),
        };
        Ok(Self { key: index, values })
    }
}

impl fmt::Display for Variation {
    /// As on the command line, with numbers unchanged.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = KEYS[self.key].name;
        match &self.values {
            Values::Range(from, to) => write!(f, "{name}={from}:{to}"),
            Values::Listed(listed) => {
                let listed: Vec<String> = listed.iter().map(f64::to_string).collect();
                write!(f, "{name}={}", listed.join(","))
            }
        }
    }
}

/// All cases of a sweep, by number.
#[derive(Clone, Debug)]
pub struct Space {
    modes: Vec<Mode>,
    /// Values of every key.
    values: [Values; KEYS.len()],
    /// Number of random cases and seed; none in a grid.
    random: Option<(usize, u64)>,
    count: usize,
}

impl Space {
    /// A grid of the given values, all else as in the paper; or random cases.
    pub fn new(
        variations: &[Variation],
        modes: Vec<Mode>,
        random: Option<(usize, u64)>,
    ) -> Result<Self, SpaceError> {
        if let Some(twice) = (1..modes.len()).find(|&index| modes[..index].contains(&modes[index]))
        {
            return Err(SpaceError::Twice(format!("--modes {}", mode_name(modes[twice]))));
        }
        let mut values = KEYS.map(|key| match random {
            Some(_) => Values::Range(key.range.0, key.range.1),
            None => Values::Listed(vec![key.nominal]),
        });
        let mut given = [false; KEYS.len()];
        for Variation { key, values: key_values } in variations {
            let name = KEYS[*key].name;
            if std::mem::replace(&mut given[*key], true) {
                return Err(SpaceError::Twice(name.to_owned()));
            }
            if random.is_none() && matches!(key_values, Values::Range(..)) {
                return Err(SpaceError::RangeInGrid(name));
            }
            values[*key] = key_values.clone();
        }
        let each = match random {
            Some((count, _)) => Some(count),
            None => values.iter().try_fold(1_usize, |count, values| match values {
                Values::Listed(listed) => count.checked_mul(listed.len()),
                Values::Range(..) => None,
            }),
        };
        let count = each.and_then(|each| each.checked_mul(modes.len())).unwrap_or(usize::MAX);
        if !(1..=MOST_CASES).contains(&count) {
            return Err(SpaceError::Count(count));
        }
        Ok(Self { modes, values, random, count })
    }

    /// Number of cases.
    pub fn count(&self) -> usize {
        self.count
    }

    /// A case by its number; it does not depend on the order of calls.
    pub fn case(&self, number: usize) -> Case {
        let mode = self.modes[number % self.modes.len()];
        let mut index = number / self.modes.len();
        let mut generator = self.random.map(|(_, seed)| {
            let mut generator = ChaCha8Rng::seed_from_u64(seed);
            generator.set_stream(index as u64);
            generator
        });
        let mut values = [0.0; KEYS.len()];
        for ((value, key_values), key) in values.iter_mut().zip(&self.values).zip(&KEYS) {
            *value = match (&mut generator, key_values) {
                (Some(generator), key_values) => {
                    // 53 bits in [0, 1).
                    let share = (generator.next_u64() >> 11) as f64 * 2_f64.powi(-53);
                    drawn(key_values, share, key.logarithmic)
                }
                (None, Values::Listed(listed)) => {
                    let value = listed[index % listed.len()];
                    index /= listed.len();
                    value
                }
                (None, Values::Range(from, _)) => *from,
            };
        }
        Case { mode, values }
    }
}

fn drawn(values: &Values, share: f64, logarithmic: bool) -> f64 {
    match values {
        Values::Listed(listed) => listed[(share * listed.len() as f64) as usize],
        Values::Range(from, to) if logarithmic => from * (to / from).powf(share),
        Values::Range(from, to) => from + share * (to - from),
    }
}
