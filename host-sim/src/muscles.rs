//! Human muscles by name: published morphometry, and the assumptions that complete it.
//!
//! Sources: gait2392 (Delp et al., IEEE Trans. Biomed. Eng. 37 (1990) 757-767; Yamaguchi & Zajac
//! 1989; Anderson & Pandy 1999) and arm26 (after Holzbaur, Murray & Delp, Ann. Biomed. Eng. 33
//! (2005) 829-840), both CC BY 3.0 of the OpenSim project. Slow fractions: Edgerton, Smith &
//! Simpson, Histochem. J. 7 (1975) 259-266.

use crate::coefficients;
use crate::muscle_file::{self, MuscleFileError, NamedMuscle};
use crate::reference::{Muscle, Pennation};
use serde::Deserialize;
use std::path::Path;

const TABLE: &str = include_str!("../data/human_muscles.csv");

/// Coefficient set of all of them.
pub const SET: &str = "human-vm4";

/// U_r of all of them: the authors' default value.
const RECRUITMENT_SATURATION: f64 = 0.8;

/// Assumptions for all muscles of the table.
pub const ASSUMPTIONS: [&str; 5] = [
    "L_se0 is the slack length of the source over LrT (0.964): the tendon's length at F0",
    "L_mt_max: passive fascicles reach max_fascicle_length_l0; 1.4 is a guess (1.3 to 1.5)",
    "a slow fraction marked `guess` has no source; the rest is fast",
    "mass follows from F0, specific tension and density; some sources scale F0 up from anatomy",
    "fascicles pull in line with the tendon (no pennation)",
];

/// A row of `data/human_muscles.csv`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HumanMuscle {
    /// Name for `--muscle`.
    #[serde(rename = "muscle")]
    pub name: String,
    /// F0 along the fascicles, N.
    pub max_isometric_force_n: f64,
    /// L_ce0, cm.
    pub fascicle_length_cm: f64,
    /// Slack length of the tendon, cm.
    pub tendon_slack_length_cm: f64,
    /// Angle between fascicles and tendon at optimal length, degrees.
    pub pennation_deg: f64,
    /// Model the morphometry is taken from.
    pub source: String,
    /// Its licence.
    pub licence: String,
    /// Share of slow fibres in the cross section.
    pub slow_fraction: f64,
    /// Source of that share, or `guess`.
    pub slow_source: String,
    /// Assumed L_max, L_ce0.
    pub max_fascicle_length_l0: f64,
}

impl HumanMuscle {
    /// The muscle, in line with its tendon.
    pub fn muscle(&self) -> Muscle {
        let elements = coefficients::elements(SET).expect("a published set");
        let fiber = |name: &str, fraction| {
            coefficients::fiber(&format!("{SET}/{name}"), fraction).expect("a published type")
        };
        let fascicle = self.fascicle_length_cm * 1e-2;
        let mut muscle = Muscle {
            mass: self.max_isometric_force_n * elements.density * fascicle
                / elements.specific_tension,
            L_ce0: fascicle,
            L_se0: self.tendon_slack_length_cm * 1e-2 / elements.LrT,
            L_mt_max: 0.0,
            U_r: RECRUITMENT_SATURATION,
            elements,
            fibers: vec![
                fiber("slow", self.slow_fraction),
                fiber("fast", 1.0 - self.slow_fraction),
            ],
            fatigue: None,
        };
        // L_max is linear in L_mt_max.
        let at_no_path = muscle.maximum_fascicle_length();
        muscle.L_mt_max = (self.max_fascicle_length_l0 - at_no_path) * fascicle;
        muscle
    }

    /// The muscle as a file.
    pub fn file(&self) -> String {
        let muscle = self.muscle();
        let fiber = |name: &str, fraction: f64| {
            format!("\n[[fiber]]\npreset = \"{SET}/{name}\"\nfraction = {fraction}\n")
        };
        format!(
            "name = \"{}\"\nmax_isometric_force_n = {}\nfascicle_length_cm = {}\n\
             tendon_length_cm = {}\nmax_path_length_cm = {}\n\
             recruitment_saturation = {RECRUITMENT_SATURATION}\ncoefficients = \"{SET}\"\n{}{}",
            self.name,
            self.max_isometric_force_n,
            self.fascicle_length_cm,
            muscle.L_se0 * 1e2,
            muscle.L_mt_max * 1e2,
            fiber("slow", muscle.fibers[0].fraction),
            fiber("fast", muscle.fibers[1].fraction),
        )
    }

    /// Error of steady force at full activation without pennation.
    pub fn pennation_error(&self) -> PennationError {
        let muscle = self.muscle();
        let pennation = Pennation::new(self.pennation_deg.to_radians());
        let cosine = pennation.cosine(1.0);
        let shift = muscle.L_ce0 * (1.0 - cosine);
        let mut error = PennationError { uncorrected: 0.0, corrected: 0.0 };
        for percent in 70..=130 {
            let length = f64::from(percent) * 1e-2;
            let path = muscle.L_se0 + length * muscle.L_ce0 * pennation.cosine(length);
            let pennate = pennation.isometric_force(&muscle, path);
            let in_line = |path| Pennation::new(0.0).isometric_force(&muscle, path);
            let worse = |worst: f64, force: f64| worst.max(100.0 * (force - pennate).abs());
            error.uncorrected = worse(error.uncorrected, in_line(path));
            error.corrected = worse(error.corrected, cosine * in_line(path + shift));
        }
        error
    }
}

/// Largest error of the steady force at full activation, % of F0, over fascicles of 0.7 to 1.3
/// L_ce0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PennationError {
    /// On the same path with the same F0.
    pub uncorrected: f64,
    /// With F0 times the cosine of the angle, and the path longer by the missing projection of the
    /// fascicles at L_ce0, as a fit of force and path would find.
    pub corrected: f64,
}

/// All named muscles, in table order.
pub fn all() -> Vec<HumanMuscle> {
    csv::Reader::from_reader(TABLE.as_bytes())
        .deserialize()
        .map(|row| row.expect("an even row in the built-in table"))
        .collect()
}

/// Text of a muscle file or, if there is no such file, of the muscle of that name in the table.
pub fn text(path: &Path) -> Result<String, MuscleFileError> {
    let human = all().into_iter().find(|human| path == Path::new(&human.name));
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(text),
        Err(_) if !path.exists() => match human {
            Some(human) => Ok(human.file()),
            None => Err(MuscleFileError::Unknown(path.to_owned())),
        },
        Err(source) => Err(MuscleFileError::Read { path: path.to_owned(), source }),
    }
}

/// A muscle from its file or, if there is no such file, by its name in the table.
pub fn find(path: &Path) -> Result<NamedMuscle, MuscleFileError> {
    muscle_file::parse(&text(path)?, path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{self, Arithmetic};
    use crate::metrics::{ForceError, forces};
    use crate::reference::{Input, Mode};
    use crate::trace::InputTrace;

    #[test]
    fn muscles_agree_with_their_rows() {
        let all = all();
        assert_eq!(all.len(), 20);
        for human in &all {
            let muscle = human.muscle();
            let name = &human.name;
            assert!((muscle.f0() / human.max_isometric_force_n - 1.0).abs() < 1e-12, "{name}");
            let longest = muscle.maximum_fascicle_length();
            assert!((longest - human.max_fascicle_length_l0).abs() < 1e-12, "{name}: {longest}");
            let slack = muscle.L_se0 * muscle.elements.LrT * 100.0;
            assert!((slack - human.tendon_slack_length_cm).abs() < 1e-12, "{name}: {slack}");
            assert_eq!(human.licence, "CC BY 3.0", "{name}");
            let file = muscle_file::parse(&human.file(), Path::new(name)).expect("a muscle").muscle;
            for (one, other) in [
                (file.mass, muscle.mass),
                (file.L_se0, muscle.L_se0),
                (file.maximum_fascicle_length(), longest),
            ] {
                assert!((one / other - 1.0).abs() < 1e-9, "{name}: {one} {other}");
            }
            assert_eq!(file.fibers, muscle.fibers, "{name}");
        }
    }

    /// A second from rest to full activation on a path at which the fascicles are near L_ce0.
    fn second(muscle: &Muscle) -> InputTrace {
        let input = |tick: usize| Input {
            activation: if tick < 100 { 0.0 } else { 1.0 },
            path_length: (muscle.L_ce0 + muscle.L_se0).min(muscle.L_mt_max),
            stimulation_frequency: 40.0,
        };
        InputTrace { start: 0.0, time_step: 1e-3, inputs: (0..=1000).map(input).collect() }
    }

    fn builds(arithmetic: Arithmetic, most: f64) {
        for human in all() {
            let (name, muscle) = (&human.name, human.muscle());
            let run = |arithmetic| {
                let rows = engine::run(&muscle, Mode::Fes, arithmetic, &second(&muscle));
                rows.unwrap_or_else(|error| panic!("{name} in {}: {error}", arithmetic.name()))
            };
            let rows = run(arithmetic);
            let flags = rows.iter().fold(vm_nostd::Status::empty(), |all, row| all | row.1);
            assert_eq!(engine::status_names(flags), "ok", "{name}");
            let found = forces(rows.iter().map(|row| &row.0));
            let expected = forces(run(Arithmetic::Reference).iter().map(|row| &row.0));
            assert!(expected[1000] > 0.7 * muscle.f0(), "{name}: {} N", expected[1000]);
            let error = ForceError::between(&found, &expected, muscle.f0());
            assert!(error.max < most, "{name}: {} % of F0", error.max);
        }
    }

    #[test]
    fn every_muscle_builds_in_f32_and_follows_the_reference() {
        builds(Arithmetic::F32, 0.1);
    }

    #[test]
    fn every_muscle_builds_in_fixed_point_and_follows_the_reference() {
        builds(Arithmetic::Fixed, 0.1);
    }

    #[test]
    fn the_error_without_pennation_grows_with_the_angle() {
        let cost = |name: &str| {
            let human = all().into_iter().find(|human| human.name == name).expect("a muscle");
            human.pennation_error()
        };
        let brachialis = cost("brachialis");
        assert_eq!(brachialis, PennationError { uncorrected: 0.0, corrected: 0.0 });
        let (lateral, soleus) = (cost("gastrocnemius_lateral"), cost("soleus"));
        assert!(lateral.uncorrected < soleus.uncorrected, "{lateral:?} {soleus:?}");
        assert!(soleus.corrected < soleus.uncorrected, "{soleus:?}");
        // At L_ce0 the tendon carries F0 cos 25 degrees: 9.4 % of F0 less.
        assert!((9.0..40.0).contains(&soleus.uncorrected), "{soleus:?}");
    }
}
