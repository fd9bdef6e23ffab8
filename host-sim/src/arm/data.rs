//! The arm of `host-sim/data/arm.toml`.

use super::skeleton::{Joints, Segment, Skeleton};
use crate::coefficients;
use crate::reference::{Muscle, UnitSizes};
use serde::Deserialize;
use vm_nostd::control::{Action, AngleRange, ORDER, PathParams};

const FILE: &str = include_str!("../../data/arm.toml");

/// Group of a muscle, which selects its activation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Group {
    /// Crosses the shoulder.
    Shoulder,
    /// Crosses the elbow.
    Elbow,
    /// Crosses both.
    Biarticular,
}

/// One of the arm's muscles.
#[derive(Clone, Debug)]
pub struct ArmMuscle {
    /// Name.
    pub name: String,
    /// Its group.
    pub group: Group,
    /// Its path.
    pub path: PathParams<2>,
    /// The muscle.
    pub muscle: Muscle,
}

/// Skeleton and muscles.
#[derive(Clone, Debug)]
pub struct Arm {
    /// Segments.
    pub skeleton: Skeleton,
    /// Least angles of the joints, rad. Nothing stops a joint beyond its range.
    pub least_angles: Joints,
    /// Greatest angles, rad.
    pub greatest_angles: Joints,
    /// Flexor and extensor of shoulder and of elbow, and of both.
    pub muscles: Vec<ArmMuscle>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    coefficients: String,
    recruitment_saturation: f64,
    reference_angles_deg: Joints,
    least_angles_deg: Joints,
    greatest_angles_deg: Joints,
    units: usize,
    upper_arm_length_cm: f64,
    fiber: Vec<FiberTable>,
    upper_arm: SegmentTable,
    forearm: SegmentTable,
    muscle: Vec<MuscleTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FiberTable {
    preset: String,
    fraction: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SegmentTable {
    mass_kg: f64,
    centre_cm: f64,
    inertia_kg_m2: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MuscleTable {
    name: String,
    group: Group,
    max_isometric_force_n: f64,
    fascicle_length_cm: f64,
    tendon_slack_length_cm: f64,
    path_cm: f64,
    per_rad_cm: Joints,
    per_rad2_cm: Joints,
}

fn metres(centimetres: Joints) -> Joints {
    centimetres.map(|length| length * 1e-2)
}

impl From<&SegmentTable> for Segment {
    fn from(table: &SegmentTable) -> Self {
        Self { mass: table.mass_kg, centre: table.centre_cm * 1e-2, inertia: table.inertia_kg_m2 }
    }
}

impl Arm {
    /// The arm of the data file.
    ///
    /// # Panics
    /// If the built-in file is malformed.
    pub fn built_in() -> Self {
        let file: File = toml::from_str(FILE).expect("a built-in arm");
        Self {
            skeleton: Skeleton {
                upper_arm: (&file.upper_arm).into(),
                forearm: (&file.forearm).into(),
                upper_arm_length: file.upper_arm_length_cm * 1e-2,
            },
            least_angles: file.least_angles_deg.map(f64::to_radians),
            greatest_angles: file.greatest_angles_deg.map(f64::to_radians),
            muscles: file.muscle.iter().map(|table| file.muscle_of(table)).collect(),
        }
    }
}

impl File {
    fn muscle_of(&self, table: &MuscleTable) -> ArmMuscle {
        let elements = coefficients::elements(&self.coefficients).expect("a published set");
        let (linear, quadratic) = (metres(table.per_rad_cm), metres(table.per_rad2_cm));
        let does = if table.name.ends_with("flexor") { Action::Flexes } else { Action::Extends };
        let path = PathParams {
            length: table.path_cm * 1e-2,
            reference: self.reference_angles_deg.map(f64::to_radians),
            terms: [0, 1].map(|joint| {
                let mut terms = [0.0; ORDER];
                (terms[0], terms[1]) = (linear[joint], quadratic[joint]);
                terms
            }),
            product: 0.0,
            action: match table.group {
                Group::Shoulder => [does, Action::None],
                Group::Elbow => [Action::None, does],
                Group::Biarticular => [does; 2],
            },
        };
        let ranges = [0, 1].map(|joint| {
            AngleRange::degrees(self.least_angles_deg[joint], self.greatest_angles_deg[joint])
        });
        let fascicle_length = table.fascicle_length_cm * 1e-2;
        let fibers = self.fiber.iter().map(|fiber| {
            let mut fiber = coefficients::fiber(&fiber.preset, fiber.fraction).expect("a preset");
            fiber.units = UnitSizes::Default.shares(fiber.fiber_type.rank, self.units);
            fiber
        });
        ArmMuscle {
            name: table.name.clone(),
            group: table.group,
            path,
            muscle: Muscle {
                // Path at which the force is greatest.
                mass: table.max_isometric_force_n * elements.density * fascicle_length
                    / elements.specific_tension,
                L_ce0: fascicle_length,
                // The tendon is slack at LrT of its optimal length.
                L_se0: table.tendon_slack_length_cm * 1e-2 / elements.LrT,
                L_mt_max: path.extremes(&ranges).1,
                U_r: self.recruitment_saturation,
                elements,
                fibers: fibers.collect(),
                fatigue: None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_muscle;

    #[test]
    fn muscles_are_valid_and_as_strong_as_published() {
        let arm = Arm::built_in();
        let forces = [838.0, 1207.0, 1422.0, 1549.0, 414.0, 603.0];
        assert_eq!(arm.muscles.len(), forces.len());
        for (muscle, force) in arm.muscles.iter().zip(forces) {
            assert_eq!(model_muscle::validate(&muscle.muscle), Ok(()), "{}", muscle.name);
            assert!((muscle.muscle.f0() - force).abs() < 1e-9, "{}", muscle.name);
        }
    }

    /// Nothing of a path is refused but its range: not every posture is within the muscle's domain.
    #[test]
    fn moment_arms_have_the_sign_of_their_group() {
        let arm = Arm::built_in();
        let ranges = [0, 1].map(|joint| AngleRange {
            least: arm.least_angles[joint],
            most: arm.greatest_angles[joint],
        });
        for ArmMuscle { name, path, .. } in &arm.muscles {
            assert_eq!(path.validate(&ranges, (-10.0, 10.0)), Ok(()), "{name}");
            let acts = path.action.iter().filter(|&&action| action != Action::None).count();
            assert_eq!(acts, if name.starts_with("biarticular") { 2 } else { 1 }, "{name}");
        }
    }

    /// The longest path against a search over all angles, the moment arms against finite
    /// differences.
    #[test]
    fn paths_and_moment_arms_are_consistent() {
        let arm = Arm::built_in();
        let steps = 200;
        for ArmMuscle { name, path, muscle, .. } in &arm.muscles {
            let mut longest = 0.0_f64;
            for step in 0..(steps + 1) * (steps + 1) {
                let share = [step / (steps + 1), step % (steps + 1)]
                    .map(|step| f64::from(step) / f64::from(steps));
                let angles = [0, 1].map(|joint| {
                    let (least, most) = (arm.least_angles[joint], arm.greatest_angles[joint]);
                    least + share[joint] * (most - least)
                });
                longest = longest.max(path.length_at(angles));
                let arms = path.moment_arms_at(angles);
                for joint in [0, 1] {
                    let beside = |by: f64| {
                        let mut angles = angles;
                        angles[joint] += by;
                        path.length_at(angles)
                    };
                    let slope = (beside(1e-4) - beside(-1e-4)) / 2e-4;
                    assert!((arms[joint] + slope).abs() < 1e-9, "{name}: {} m", arms[joint]);
                }
            }
            let excess = muscle.L_mt_max - longest;
            assert!((-1e-12..1e-6).contains(&excess), "{name}: {excess} m");
        }
    }
}
