//! Writes the fitted muscle as a muscle file: the starting file with the fitted numbers replaced.

use super::keys::{EXCITATION_TIMES, FORCE, Key};
use super::outcome::Fit;
use super::trials::Role;
use crate::muscle_file::curve;
use crate::reference::Muscle;
use std::fmt::Write;
use toml::{Table, Value};

/// The text of the fitted muscle's file. Comments at the top state the sources (`origin`), the
/// parameters with their uncertainty and the errors.
pub fn fitted_file(start: &Table, fit: &Fit, origin: &str) -> String {
    let mut table = start.clone();
    for estimate in &fit.estimates {
        put(&mut table, &estimate.name, estimate.value, &fit.muscle);
    }
    // The whole curve, because its values belong together.
    if let Some(values) = fit.curve {
        let numbers = curve::NAMES.iter().zip(values);
        let curve = numbers.map(|(name, value)| ((*name).to_owned(), Value::Float(value)));
        table.insert("recruitment_curve".to_owned(), Value::Table(curve.collect()));
    }
    let body = toml::to_string(&table).expect("tables of numbers and texts");
    comments(fit, origin).expect("a string grows") + &body
}

fn comments(fit: &Fit, origin: &str) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    for line in origin.lines() {
        writeln!(text, "# {line}")?;
    }
    for estimate in &fit.estimates {
        let known = match estimate.interval() {
            _ if estimate.at_bound => "at its bound".to_owned(),
            Some(_) if estimate.at_prior => "left at its prior".to_owned(),
            Some((least, most)) => format!("95 % interval {} to {}", digits(least), digits(most)),
            None => "no interval".to_owned(),
        };
        writeln!(text, "# {} = {}: {known}", estimate.name, digits(estimate.value))?;
    }
    for pair in &fit.pairs {
        let [one, other] = &pair.names;
        writeln!(text, "# {one} and {other} trade off: correlation {:.3}", pair.correlation)?;
    }
    for trial in &fit.trials {
        writeln!(
            text,
            "# {}, {}: mean absolute error {:.2} % of F0, rms {:.2} %, mean {:+.2} %",
            trial.name,
            if trial.role == Role::Fit { "fitted" } else { "predicted" },
            trial.mae_pct_f0,
            trial.rms_pct_f0,
            trial.bias_pct_f0,
        )?;
    }
    writeln!(
        text,
        "# Residuals are {:.2} times the stated noise of {} N.",
        fit.noise_ratio,
        digits(fit.noise)
    )?;
    if fit.is_below_noise() {
        writeln!(text, "# They are far below it: the intervals are those of the stated noise.")?;
    }
    for confirmed in &fit.confirmed {
        let (max, rms) = confirmed.difference;
        let name = confirmed.arithmetic.name();
        writeln!(text, "# In {name} it differs by {max:.3} % of F0 at most, {rms:.4} % rms.")?;
    }
    Ok(text)
}

/// Six significant digits: more than any recording determines.
fn digits(value: f64) -> String {
    format!("{value:.5e}").parse::<f64>().unwrap_or(value).to_string()
}

/// Sets a fitted number in the file; parameters that are not numbers of the muscle are skipped.
fn put(table: &mut Table, name: &str, value: f64, muscle: &Muscle) {
    let Some(key) = Key::named(name) else { return };
    match key {
        Key::Force => {
            table.remove("mass_g");
            table.insert(FORCE.to_owned(), Value::Float(value));
        }
        Key::Muscle(_) => {
            table.insert(name.to_owned(), Value::Float(value));
        }
        Key::Element(_) | Key::Fatigue(_) => {
            if let Some((part, key)) = name.split_once('.') {
                let part = table.entry(part).or_insert_with(|| Value::Table(Table::new()));
                if let Some(part) = part.as_table_mut() {
                    part.insert(key.to_owned(), Value::Float(value));
                }
            }
        }
        Key::Fiber(index, _) => {
            if let (Some(fiber), Some((_, key))) = (fiber(table, index), name.rsplit_once('.')) {
                fiber.insert(key.to_owned(), Value::Float(value));
            }
        }
        Key::Fraction(_) => every_fiber(table, muscle, &["fraction"]),
        Key::ExcitationTimes => every_fiber(table, muscle, EXCITATION_TIMES),
    }
}

/// Sets numbers of all fibre types of the muscle.
fn every_fiber(table: &mut Table, muscle: &Muscle, names: &[&str]) {
    for index in 0..muscle.fibers.len() {
        for name in names {
            let key = Key::named(&format!("fiber[{index}].{name}"));
            let value = key.and_then(|key| key.value(muscle));
            if let (Some(fiber), Some(value)) = (fiber(table, index), value) {
                fiber.insert((*name).to_owned(), Value::Float(value));
            }
        }
    }
}

fn fiber(table: &mut Table, index: usize) -> Option<&mut Table> {
    table.get_mut("fiber")?.as_array_mut()?.get_mut(index)?.as_table_mut()
}
