//! The list of trials of a protocol for `vm fit`, with its free parameters.

use super::bout::{Bout, Setting, Steps};
use crate::engine::mode_name;
use crate::fit::{Basis, Key, spread};
use crate::muscle_file::NamedMuscle;
use crate::muscle_file::curve::{self, CURVE};
use crate::reference::Mode;
use std::fmt::Write;

/// Folder of the force recordings, below the list's folder.
pub const RECORDED: &str = "recorded";
/// Offset of the path, m.
pub const OFFSET: &str = "path_offset_m";
/// Spread of the offset, m. Assumed: that of the tendon's length, with which a limb's path scales.
const OFFSET_SPREAD: f64 = 0.025;
/// Distance of the bounds from the mean, in spreads; the lower bound is at least a fifth of the
/// mean.
const FAR: f64 = 4.0;

/// A free parameter with its prior.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    /// Name.
    pub name: String,
    /// Mean, in the file's unit.
    pub mean: f64,
    /// Standard deviation, in the file's unit.
    pub spread: f64,
    /// Bounds.
    pub bounds: (f64, f64),
    /// Source of the spread.
    pub source: String,
}

const ALWAYS: [&str; 6] = [
    "max_isometric_force_n",
    "fascicle_length_cm",
    "tendon_length_cm",
    "max_path_length_cm",
    "excitation_time_factor",
    OFFSET,
];

/// Free parameters of a mode for a muscle.
pub fn free(named: &NamedMuscle, mode: Mode) -> Vec<Free> {
    let mut names: Vec<String> = ALWAYS.map(str::to_owned).to_vec();
    let types = named.muscle.fibers.len();
    names.extend((1..types).map(|index| format!("fiber[{}].fraction", index - 1)));
    if mode == Mode::Fes {
        names.extend((0..types).map(|index| format!("fiber[{index}].f05_pps")));
        if named.curve.is_some() {
            names.extend(curve::NAMES.map(|name| format!("{CURVE}{name}")));
        }
    } else if types > 1 {
        names.push("recruitment_saturation".to_owned());
    }
    if named.muscle.fatigue.is_some() {
        let keys = ["T_fat_s", "T_rec_s", "fit_min", "beta"];
        // Natural firing fatigues like 100 pps, where beta has no effect.
        let keys = if mode == Mode::Fes { &keys[..] } else { &keys[..3] };
        names.extend(keys.iter().map(|key| format!("fatigue.{key}")));
    }
    names.into_iter().filter_map(|name| one(named, name)).collect()
}

fn one(named: &NamedMuscle, name: String) -> Option<Free> {
    if name == OFFSET {
        let (mean, spread) = (0.0, OFFSET_SPREAD);
        let bounds = (-FAR * spread, FAR * spread);
        let source = "assumed: as much as that of the tendon's length".to_owned();
        return Some(Free { name, mean, spread, bounds, source });
    }
    let mean = match name.strip_prefix(CURVE) {
        Some(key) => curve::values(named.curve.as_ref()?)[curve::key(key)?],
        None => Key::named(&name)?.value(&named.muscle)?,
    };
    let row = spread(&name)?;
    let spread = row.relative_spread * mean;
    // Fractions are limited to 0..1.
    let whole = name.ends_with("fraction")
        || ["recruitment_saturation", "fatigue.fit_min", "fatigue.beta"].contains(&name.as_str());
    let greatest = if whole { 0.99 } else { f64::INFINITY };
    let least = if name.ends_with("slope") { 1.0 } else { 0.2 * mean };
    let bounds = ((mean - FAR * spread).max(least), (mean + FAR * spread).min(greatest));
    let source = match row.basis {
        Basis::Assumed => row.source,
        _ => format!("from {}", row.source),
    };
    Some(Free { name, mean, spread, bounds, source })
}

/// The text of the list.
pub fn list(named: &NamedMuscle, mode: Mode, bouts: &[Bout]) -> String {
    text(named, mode, bouts).expect("a string grows")
}

fn text(named: &NamedMuscle, mode: Mode, bouts: &[Bout]) -> Result<String, std::fmt::Error> {
    let setting = Setting::of(named, mode);
    let mut text = String::new();
    writeln!(text, "# Recordings of the protocol of vm protocol; force goes into {RECORDED}.")?;
    writeln!(text, "noise_pct_f0 = 1\ntime_step_ms = 2")?;
    for bout in bouts {
        let (name, file) = (bout.name, bout.file_name());
        writeln!(text, "\n[[trial]]\nname = \"{name}\"\nrole = \"{}\"", bout.role.name())?;
        writeln!(text, "mode = \"{}\"", mode_name(mode))?;
        let recorded = format!("file = \"{RECORDED}/{file}\", time = \"t_s\"");
        writeln!(text, "force = {{ {recorded}, value = \"force_n\" }}")?;
        let path = format!("file = \"{file}\", time = \"t_s\", value = \"path_length_m\"");
        writeln!(text, "length = {{ {path}, offset = \"{OFFSET}\" }}")?;
        match setting.full_ma {
            Some(full) => {
                let amplitude = bout.level.iter().map(|&(time, level)| (time, level * full));
                writeln!(text, "pulse_amplitude_ma = {}", steps(&amplitude.collect()))?;
                writeln!(text, "pulse_width_us = {}", steps(&bout.width_us))?;
            }
            None => writeln!(text, "activation = {}", steps(&bout.level))?,
        }
        if mode == Mode::Fes {
            writeln!(text, "stimulation_pps = {}", steps(&bout.pps))?;
        }
    }
    for free in free(named, mode) {
        let Free { name, mean, spread, bounds: (least, most), source } = free;
        writeln!(text, "\n# Spread: {source}\n[[free]]\nname = \"{name}\"")?;
        writeln!(text, "start = {mean}\nbounds = [{least}, {most}]")?;
        writeln!(text, "prior = {{ mean = {mean}, spread = {spread} }}")?;
    }
    Ok(text)
}

fn steps(steps: &Steps) -> String {
    let pairs: Vec<String> =
        steps.iter().map(|(time, value)| format!("[{time}, {value}]")).collect();
    format!("{{ steps = [{}] }}", pairs.join(", "))
}
