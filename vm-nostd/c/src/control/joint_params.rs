//! Parameters of joints in C.

use crate::choice::choice;
use crate::derived::{admitted, derived_from};
use crate::outcome::told;
use crate::params::{VM_VERSION, VmMuscleParams};
use crate::pointer::{Place, borrow, read};
use crate::result::{Refusal, VmError, VmResult};
use model::control::{Action, AngleRange, JointMuscle, PathParams};
use model::{Limit, ParameterError};

/// Most angles of a joint.
pub const VM_JOINT_ANGLES: usize = 2;
/// Most muscles of a joint.
pub const VM_JOINT_MUSCLES: usize = 6;
/// Highest power of an angle in a path.
pub const VM_PATH_ORDER: usize = 6;

/// VmPath.action: the moment arm is positive, the path shortens towards greater angles.
pub const VM_ACTION_FLEXES: u32 = 0;
/// VmPath.action: the moment arm is negative, the path lengthens towards greater angles.
pub const VM_ACTION_EXTENDS: u32 = 1;
/// VmPath.action: the muscle does not cross the joint; its terms are 0.
pub const VM_ACTION_NONE: u32 = 2;
/// VmPath.action: the moment arm may change its sign.
pub const VM_ACTION_EITHER: u32 = 3;

/// Range of an angle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmAngleRange {
    /// Least angle, rad; -6.3 to 6.3.
    pub least_rad: f64,
    /// Greatest angle, rad; 0.01 more than the least, to 6.3.
    pub most_rad: f64,
}

/// Path of a muscle as a polynomial of one or two angles, with d = angle - reference_rad:
/// length_m + terms[j][0] d_j + terms[j][1] d_j^2 ... + product d_0 d_1. The moment arm is minus
/// its derivative by the angle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmPath {
    /// Path length at the reference angles, m; more than 0, to 4.
    pub length_m: f64,
    /// Reference angles, rad; -6.3 to 6.3.
    pub reference_rad: [f64; VM_JOINT_ANGLES],
    /// Of each angle the coefficients of d, d^2, ... d^6, m/rad^k; each -1 to 1.
    pub terms: [[f64; VM_PATH_ORDER]; VM_JOINT_ANGLES],
    /// Coefficient of d_0 d_1, m/rad^2; -1 to 1. Not read with one angle.
    pub product: f64,
    /// VM_ACTION_FLEXES (0), VM_ACTION_EXTENDS, VM_ACTION_NONE or VM_ACTION_EITHER, about each
    /// angle: refused if the moment arm says otherwise somewhere in the range.
    pub action: [u32; VM_JOINT_ANGLES],
}

/// A muscle of a joint; vm_joint_muscle fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmJointMuscle {
    /// Path.
    pub path: VmPath,
    /// Shortest and longest path that the muscle accepts, m.
    pub path_domain_m: [f64; 2],
    /// F0, N; more than 0, to 16,000.
    pub max_isometric_force_n: f64,
    /// L_ce0, m; 0.005 to 1.
    pub fascicle_length_m: f64,
}

/// One or two angles and the muscles about them.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmJointParams {
    /// VM_VERSION: the version of this header.
    pub version: u32,
    /// Number of angles; 1 or 2.
    pub angle_count: u32,
    /// Number of muscles; 1 to 6.
    pub muscle_count: u32,
    /// Ranges of the angles; only the first `angle_count` are read.
    pub ranges: [VmAngleRange; VM_JOINT_ANGLES],
    /// Muscles; only the first `muscle_count` are read.
    pub muscles: [VmJointMuscle; VM_JOINT_MUSCLES],
}

impl VmAngleRange {
    pub(crate) fn model(&self) -> AngleRange {
        AngleRange { least: self.least_rad, most: self.most_rad }
    }
}

impl From<AngleRange> for VmAngleRange {
    fn from(range: AngleRange) -> Self {
        Self { least_rad: range.least, most_rad: range.most }
    }
}

const ACTIONS: [(u32, Action); 4] = [
    (VM_ACTION_FLEXES, Action::Flexes),
    (VM_ACTION_EXTENDS, Action::Extends),
    (VM_ACTION_NONE, Action::None),
    (VM_ACTION_EITHER, Action::Either),
];

impl VmPath {
    /// For `J` angles, at most two.
    pub(crate) fn model<const J: usize>(&self) -> Result<PathParams<J>, ParameterError> {
        let mut path = PathParams {
            length: self.length_m,
            reference: [0.0; J],
            terms: [[0.0; VM_PATH_ORDER]; J],
            product: if J == VM_JOINT_ANGLES { self.product } else { 0.0 },
            action: [Action::Either; J],
        };
        path.reference.iter_mut().zip(self.reference_rad).for_each(|(to, from)| *to = from);
        path.terms.iter_mut().zip(self.terms).for_each(|(to, from)| *to = from);
        for (action, number) in path.action.iter_mut().zip(self.action) {
            *action = choice("action", number, &ACTIONS)?;
        }
        Ok(path)
    }
}

impl From<PathParams<1>> for VmPath {
    fn from(path: PathParams<1>) -> Self {
        let [action] = path.action;
        let known = ACTIONS.iter().find(|(_, known)| *known == action);
        let action = known.map_or(VM_ACTION_EITHER, |(number, _)| *number);
        Self {
            length_m: path.length,
            reference_rad: [path.reference[0], 0.0],
            terms: [path.terms[0], [0.0; VM_PATH_ORDER]],
            product: path.product,
            action: [action, VM_ACTION_NONE],
        }
    }
}

impl VmJointMuscle {
    pub(crate) fn model<const J: usize>(&self) -> Result<JointMuscle<J>, ParameterError> {
        let [shortest, longest] = self.path_domain_m;
        Ok(JointMuscle {
            path: self.path.model()?,
            path_domain: (shortest, longest),
            max_isometric_force: self.max_isometric_force_n,
            fascicle_length: self.fascicle_length_m,
        })
    }
}

/// Joint parameters of this version, with numbers of angles and muscles that there may be.
pub(crate) fn admitted_joint<'a>(
    params: *const VmJointParams,
) -> Result<&'a VmJointParams, Refusal> {
    let params = borrow(params)?;
    if params.version != VM_VERSION {
        return Err(VmResult::Version.into());
    }
    let counts = [
        ("angle_count", params.angle_count, VM_JOINT_ANGLES),
        ("muscle_count", params.muscle_count, VM_JOINT_MUSCLES),
    ];
    for (field, count, most) in counts {
        if !(1..=most as u32).contains(&count) {
            let limit = Limit::Within { least: 1.0, most: most as f64 };
            return Err(ParameterError { field, fiber: None, value: count.into(), limit }.into());
        }
    }
    Ok(params)
}

/// A muscle on a path, for a joint: F0, L_ce0 and path range are those of its parameters, which are
/// validated; the path is when a joint is built. `error` may be null.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_joint_muscle(
    params: *const VmMuscleParams,
    path: *const VmPath,
    muscle: *mut VmJointMuscle,
    error: *mut VmError,
) -> VmResult {
    let outcome = || -> Result<(), Refusal> {
        Place::optional(error)?;
        let place = Place::new(muscle)?;
        let path = read(path)?;
        let params = admitted(params)?;
        let derived = derived_from(params)?;
        place.put(VmJointMuscle {
            path,
            path_domain_m: derived.path_domain_m,
            max_isometric_force_n: derived.max_isometric_force_n,
            fascicle_length_m: params.fascicle_length_m,
        });
        Ok(())
    };
    told(outcome(), error)
}
