//! Muscle files (TOML): parsed, completed from the published sets, and validated.

pub mod curve;
mod fiber;
mod line;
mod refusal;
mod size;

use crate::coefficients;
use crate::engine::{Class, MOST_UNITS};
use crate::model_muscle;
use crate::reference::{Fatigue, Fiber, Muscle};
use curve::CurveTable;
use fiber::{FiberTable, fiber};
use line::line_of;
use refusal::{Refusal, override_by_name};
use serde::Deserialize;
use size::{ANY_MASS, Size};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use vm_nostd::RecruitmentCurveParams;

/// Why a muscle file was refused.
#[derive(Debug, thiserror::Error)]
pub enum MuscleFileError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// Neither a file nor a known muscle name.
    #[error("{}: no such file, and no muscle of that name in `vm muscles`", .0.display())]
    Unknown(PathBuf),
    /// Not TOML, an unknown or missing key, or a value of the wrong type.
    #[error("{}: {message}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line, key and reason.
        message: String,
    },
    /// A value out of range.
    #[error("{}{}: {key} = {value}: {limit}", path.display(), line.map_or(String::new(), |line| format!(", line {line}")))]
    Value {
        /// The file.
        path: PathBuf,
        /// Line of the key, counted from 1, if the file has it.
        line: Option<usize>,
        /// The key, with its table.
        key: String,
        /// The refused value, as in the file.
        value: String,
        /// Limit it broke.
        limit: String,
    },
}

/// The file as written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MuscleFile {
    name: String,
    mass_g: Option<f64>,
    max_isometric_force_n: Option<f64>,
    fascicle_length_cm: f64,
    tendon_length_cm: f64,
    max_path_length_cm: f64,
    #[serde(default = "default_recruitment_saturation")]
    recruitment_saturation: f64,
    #[serde(default = "default_coefficients")]
    coefficients: String,
    class: Option<String>,
    #[serde(default)]
    elements: BTreeMap<String, toml::Value>,
    #[serde(default)]
    fiber: Vec<FiberTable>,
    fatigue: Option<FatigueTable>,
    recruitment_curve: Option<CurveTable>,
}

/// Fatigue; without this table there is none.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)] // the paper's symbols
struct FatigueTable {
    T_fat_s: f64,
    T_rec_s: f64,
    fit_min: f64,
    beta: f64,
}

impl From<FatigueTable> for Fatigue {
    fn from(table: FatigueTable) -> Self {
        Self {
            T_fat: table.T_fat_s,
            T_rec: table.T_rec_s,
            fit_min: table.fit_min,
            beta: table.beta,
        }
    }
}

fn default_recruitment_saturation() -> f64 {
    0.8
}

fn default_coefficients() -> String {
    coefficients::DEFAULT_SET.to_owned()
}

/// A muscle and its name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMuscle {
    /// Name, from the file.
    pub name: String,
    /// The muscle, its fibre types in order of rank.
    pub muscle: Muscle,
    /// Accuracy class; standard if the file has none.
    pub class: Class,
    /// Recruitment curve, if the file has one.
    pub curve: Option<RecruitmentCurveParams>,
}

/// Reads and validates a muscle file.
pub fn read(path: &Path) -> Result<NamedMuscle, MuscleFileError> {
    let text = std::fs::read_to_string(path)
        .map_err(|source| MuscleFileError::Read { path: path.to_owned(), source })?;
    parse(&text, path)
}

/// Parses and validates the text of a muscle file; `path` is for the messages.
pub fn parse(text: &str, path: &Path) -> Result<NamedMuscle, MuscleFileError> {
    let file: MuscleFile = toml::from_str(text).map_err(|error| MuscleFileError::Parse {
        path: path.to_owned(),
        message: error.to_string().trim_end().to_owned(),
    })?;
    let refuse = |key: String, value: String, limit: String| MuscleFileError::Value {
        path: path.to_owned(),
        line: line_of(text, &key),
        key,
        value,
        limit,
    };
    let refused = |(key, value, limit): Refusal| refuse(key, value, limit);
    let class = file.class.as_deref().map_or(Ok(Class::default()), class).map_err(refused)?;
    let mut elements = coefficients::element_row(&file.coefficients).ok_or_else(|| {
        let sets: Vec<String> = coefficients::element_rows().into_iter().map(|(s, _)| s).collect();
        refuse(
            "coefficients".to_owned(),
            format!("\"{}\"", file.coefficients),
            format!("must be one of {}", sets.join(", ")),
        )
    })?;
    override_by_name(
        &mut elements,
        &file.elements,
        &coefficients::element_columns(),
        "elements have",
    )
    .map_err(|(key, value, limit)| refuse(format!("elements.{key}"), value, limit))?;
    let elements = coefficients::elements_of(&elements);
    let size = Size::of(file.mass_g, file.max_isometric_force_n).map_err(refused)?;
    let fibers: Vec<Fiber> = file
        .fiber
        .iter()
        .enumerate()
        .map(|(index, table)| {
            fiber(table).map_err(|(key, value, limit)| {
                refuse(format!("fiber[{index}].{key}"), value, limit)
            })
        })
        .collect::<Result<_, _>>()?;
    let mut order: Vec<usize> = (0..fibers.len()).collect();
    order.sort_by_key(|&index| fibers[index].fiber_type.rank);
    let mut muscle = Muscle {
        mass: ANY_MASS,
        L_ce0: file.fascicle_length_cm * 1e-2,
        L_se0: file.tendon_length_cm * 1e-2,
        L_mt_max: file.max_path_length_cm * 1e-2,
        U_r: file.recruitment_saturation,
        elements,
        fibers: order.iter().map(|&index| fibers[index].clone()).collect(),
        fatigue: file.fatigue.map(Fatigue::from),
    };
    let units: usize = muscle.fibers.iter().map(|fiber| fiber.units.len()).sum();
    if units > MOST_UNITS {
        let limit = format!("at most {MOST_UNITS} in a muscle, all types together");
        return Err(refuse("fiber.units".to_owned(), units.to_string(), limit));
    }
    let validate = |muscle: &Muscle| {
        model_muscle::validate(muscle).map_err(|refusal| {
            let key = match refusal.fiber {
                Some(index) => format!("fiber[{}].{}", order[index], refusal.key),
                None => refusal.key,
            };
            (key, refusal.value, refusal.limit)
        })
    };
    // A computed mass is refused only if its inputs are valid.
    if matches!(size, Size::Force(_)) {
        validate(&muscle).map_err(refused)?;
    }
    muscle.mass = size.mass(&muscle);
    validate(&muscle).map_err(|refusal| refused(size.refusal(refusal)))?;
    let curve = file.recruitment_curve.map(CurveTable::params);
    if let Some(refusal) = curve.as_ref().and_then(curve::refusal) {
        return Err(refused(refusal));
    }
    Ok(NamedMuscle { name: file.name, muscle, class, curve })
}

/// Looks up an accuracy class by name.
fn class(name: &str) -> Result<Class, Refusal> {
    Class::ALL.into_iter().find(|class| class.name() == name).ok_or_else(|| {
        let names = Class::ALL.map(Class::name).join(", ");
        ("class".to_owned(), format!("\"{name}\""), format!("must be one of {names}"))
    })
}
