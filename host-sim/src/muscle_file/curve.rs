//! The recruitment curve in a muscle file or a list of trials.

use crate::model_muscle::in_file_unit;
use serde::Deserialize;
use vm_nostd::{Limit, RecruitmentCurveParams};

/// Prefix of the names of its parameters.
pub const CURVE: &str = "recruitment_curve.";

/// The keys of its table.
pub const NAMES: [&str; 4] = ["threshold_ma", "saturation_ma", "chronaxie_us", "slope"];
/// The file's units per SI unit.
const SCALES: [f64; 4] = [1e3, 1e3, 1e6, 1.0];

/// A recruitment curve in the units of the file.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurveTable {
    threshold_ma: f64,
    saturation_ma: f64,
    chronaxie_us: f64,
    slope: f64,
}

impl CurveTable {
    /// The curve in SI units.
    pub fn params(self) -> RecruitmentCurveParams {
        of_values([self.threshold_ma, self.saturation_ma, self.chronaxie_us, self.slope])
    }
}

/// Why a curve is refused: key, value and limit in the units of the file.
pub fn refusal(curve: &RecruitmentCurveParams) -> Option<(String, String, String)> {
    let error = curve.validate().err()?;
    let at = ["threshold", "saturation", "chronaxie", "slope"];
    let (name, scale) = at
        .iter()
        .position(|field| *field == error.field)
        .map_or((error.field, 1.0), |index| (NAMES[index], SCALES[index]));
    let limit = match error.limit {
        Limit::Within { least, most } => {
            Limit::Within { least: in_file_unit(least, scale), most: in_file_unit(most, scale) }
        }
        other => other,
    };
    let value = in_file_unit(error.value, scale).to_string();
    Some((format!("{CURVE}{name}"), value, limit.to_string()))
}

/// The index of a parameter.
pub fn key(name: &str) -> Option<usize> {
    NAMES.iter().position(|known| *known == name)
}

/// All names, for error messages.
pub fn names() -> String {
    NAMES.join(", ")
}

/// The values of a curve in the units of the file.
pub fn values(curve: &RecruitmentCurveParams) -> [f64; 4] {
    let values = [curve.threshold, curve.saturation, curve.chronaxie, curve.slope];
    std::array::from_fn(|index| values[index] * SCALES[index])
}

/// A curve from values in the units of the file.
pub fn of_values(values: [f64; 4]) -> RecruitmentCurveParams {
    let [threshold, saturation, chronaxie, slope] =
        std::array::from_fn(|index| values[index] / SCALES[index]);
    RecruitmentCurveParams { threshold, saturation, chronaxie, slope }
}
