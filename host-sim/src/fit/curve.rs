//! The recruitment curve of an electrode, as it stands in a list of trials.

use serde::Deserialize;
use vm_nostd::RecruitmentCurveParams;

/// What the names of its parameters begin with.
pub const CURVE: &str = "recruitment_curve.";

const NAMES: [&str; 4] = ["threshold_ma", "saturation_ma", "chronaxie_us", "slope"];

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

/// The index of a parameter.
pub fn key(name: &str) -> Option<usize> {
    NAMES.iter().position(|known| *known == name)
}

/// All names, for a message.
pub fn names() -> String {
    NAMES.join(", ")
}

/// The values of a curve in the units of the file.
pub fn values(curve: &RecruitmentCurveParams) -> [f64; 4] {
    [curve.threshold * 1e3, curve.saturation * 1e3, curve.chronaxie * 1e6, curve.slope]
}

/// A curve from values in the units of the file.
pub fn of_values([threshold, saturation, chronaxie, slope]: [f64; 4]) -> RecruitmentCurveParams {
    RecruitmentCurveParams {
        threshold: threshold * 1e-3,
        saturation: saturation * 1e-3,
        chronaxie: chronaxie * 1e-6,
        slope,
    }
}
