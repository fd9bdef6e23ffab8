//! Muscles about one or two joints: angles to path lengths, forces to torques.
//!
//! τ_j = Σ_i F_i r_ij over the muscles i, with the moment arms r of [`path`](super::path).

use super::path::{Axis, Path, Placed};
use super::path_params::{AngleRange, PathParams, count};
use crate::checksum::Checksum;
use crate::error::{ParameterError, within};
use crate::params::MuscleParams;
use crate::scalar::Scalar;
use crate::summed::{Summed, summed};
use core::fmt;

bitflags::bitflags! {
    /// What was wrong with a joint's angles.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct JointStatus: u8 {
        /// An angle was outside its range and was clipped.
        const ANGLE_CLIPPED = 1 << 0;
        /// An angle was not a number and was taken in the middle of its range, or infinite and was
        /// clipped.
        const ANGLE_NOT_FINITE = 1 << 1;
    }
}

/// A muscle of a joint: its path, and what the joint has to know of the muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMuscle<const J: usize> {
    /// Path as a function of the joints' angles.
    pub path: PathParams<J>,
    /// Shortest and longest path that the muscle accepts, m.
    pub path_domain: (f64, f64),
    /// F0, N; more than 0, to 16,000.
    pub max_isometric_force: f64,
    /// L_ce0, m; 0.005 to 1.
    pub fascicle_length: f64,
}

impl<const J: usize> JointMuscle<J> {
    /// A muscle on a path.
    pub fn new<const N: usize>(muscle: &MuscleParams<N>, path: PathParams<J>) -> Self {
        Self {
            path,
            path_domain: muscle.path_domain(),
            max_isometric_force: muscle.max_isometric_force(),
            fascicle_length: muscle.fascicle_length,
        }
    }
}

/// A joint was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointError {
    /// Index of the muscle; `None` for the joint's own parameters.
    pub muscle: Option<usize>,
    /// Field, value and limit.
    pub error: ParameterError,
}

impl fmt::Display for JointError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.muscle {
            Some(muscle) => write!(f, "muscles[{muscle}].{}", self.error),
            None => self.error.fmt(f),
        }
    }
}

impl core::error::Error for JointError {}

summed! {
    /// `M` muscles about `J` joints (1 or 2).
    ///
    /// ```
    /// use vm_nostd::control::{ANKLE, Joint, JointStatus};
    /// let muscles = ANKLE.muscles.map(|muscle| muscle.on_joint());
    /// let ankle = Joint::<f32, 1, 2>::build(&[ANKLE.range], &muscles)?;
    /// let posture = ankle.posture([0.0]); // rad
    /// assert_eq!(posture.status, JointStatus::empty());
    /// // Tibialis anterior at half of F0, soleus slack: 905 N × 0.5 × about 4 cm.
    /// let [torque] = ankle.torques(&posture, &[0.5, 0.0]);
    /// assert!((15.0..20.0).contains(&torque), "{torque} N m");
    /// # Ok::<(), vm_nostd::control::JointError>(())
    /// ```
    #[derive(Clone, Copy, Debug)]
    pub struct Joint<S: Scalar, const J: usize, const M: usize> {
        axes: [Axis<S>; J],
        muscles: [Acting<S, J>; M],
        unit: S::Factor,
    }
}

summed! {
    #[derive(Clone, Copy, Debug)]
    struct Acting<S: Scalar, const J: usize> {
        path: Path<S, J>,
        /// F0 in torque units per m.
        force: S::Factor,
        /// F0/L_ce0 in torque units per m².
        force_per_length: S::Factor,
    }
}

impl<S: Scalar, const M: usize> Joint<S, 1, M> {
    /// Forces (F0) with which each muscle alone makes a torque of its own (units of 1,024 N m); 0
    /// for a torque of the other direction.
    pub(super) fn forces_for(&self, posture: &Posture<S, 1, M>, torques: &[S; M]) -> [S; M] {
        // By iterators, as all below: an index would leave a bounds check, and with it a panic.
        let mut forces = *torques;
        for ((force, acting), placed) in forces.iter_mut().zip(&self.muscles).zip(&posture.muscles)
        {
            let [arm] = placed.moment_arms;
            let per_force = arm.scaled(&acting.force);
            let acts = (per_force > S::ZERO) == (*force > S::ZERO);
            let alone = force.abs().ratio(per_force.abs().max(S::LEAST));
            *force = if acts { alone } else { S::ZERO };
        }
        forces
    }
}

/// The muscles in a posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posture<S: Scalar, const J: usize, const M: usize> {
    /// Path and moment arms of each muscle.
    pub muscles: [Placed<S, J>; M],
    /// What was wrong with the angles.
    pub status: JointStatus,
}

/// Torques are summed in this unit, N m: in fixed point its ULP is 6e-5 N m.
pub(super) const TORQUE_UNIT: f64 = 1024.0;
/// Most muscles of a joint.
const MOST_MUSCLES: usize = 64;

impl<S: Scalar, const J: usize, const M: usize> Joint<S, J, M> {
    /// Builds the joints, or refuses with the muscle's index, the field, its value and the limit.
    pub fn build(
        ranges: &[AngleRange; J],
        muscles: &[JointMuscle<J>; M],
    ) -> Result<Self, JointError> {
        let of_joint = |error| JointError { muscle: None, error };
        count("joints", J, 2).map_err(of_joint)?;
        count("muscles", M, MOST_MUSCLES).map_err(of_joint)?;
        ranges.iter().try_for_each(AngleRange::validate).map_err(of_joint)?;
        for (index, muscle) in muscles.iter().enumerate() {
            let of_muscle = |error| JointError { muscle: Some(index), error };
            let force = muscle.max_isometric_force;
            within("max_isometric_force", force, f64::MIN_POSITIVE, 16e3).map_err(of_muscle)?;
            let length = muscle.fascicle_length;
            within("fascicle_length", length, 5e-3, 1.0).map_err(of_muscle)?;
            muscle.path.validate(ranges, muscle.path_domain).map_err(of_muscle)?;
        }
        Ok(Self {
            axes: ranges.each_ref().map(Axis::new),
            muscles: muscles.map(|muscle| Acting {
                path: Path::new(&muscle.path, ranges),
                force: S::factor(muscle.max_isometric_force / TORQUE_UNIT),
                force_per_length: S::factor(
                    muscle.max_isometric_force / (muscle.fascicle_length * TORQUE_UNIT),
                ),
            }),
            unit: S::quantity_factor(TORQUE_UNIT),
        })
    }

    /// Paths and moment arms at angles (rad), which are clipped to their ranges.
    pub fn posture(&self, angles: [S; J]) -> Posture<S, J, M> {
        let mut status = JointStatus::empty();
        let mut shares = angles;
        for (share, axis) in shares.iter_mut().zip(&self.axes) {
            let angle = *share;
            let is_number = angle.partial_cmp(&angle).is_some();
            if !angle.is_finite() {
                status |= JointStatus::ANGLE_NOT_FINITE;
            }
            if is_number && !(angle >= axis.least && angle <= axis.most) {
                status |= JointStatus::ANGLE_CLIPPED;
            }
            *share = if is_number { axis.share(angle) } else { S::ZERO };
        }
        Posture { muscles: self.muscles.each_ref().map(|muscle| muscle.path.at(&shares)), status }
    }

    /// Torque about each joint, N m, of tendon forces relative to F0; flexion is positive.
    pub fn torques(
        &self,
        posture: &Posture<S, J, M>,
        relative_forces: &[S; M],
    ) -> [S::Quantity; J] {
        self.torque_numbers(posture, relative_forces).map(|torque| self.quantity(torque))
    }

    /// Torques in units of 1,024 N m.
    pub(super) fn torque_numbers(&self, posture: &Posture<S, J, M>, forces: &[S; M]) -> [S; J] {
        let mut sums = [S::ZERO; J];
        for ((acting, placed), &force) in self.muscles.iter().zip(&posture.muscles).zip(forces) {
            for (sum, &arm) in sums.iter_mut().zip(&placed.moment_arms) {
                *sum = *sum + (force * arm).scaled(&acting.force);
            }
        }
        sums
    }

    /// A torque or stiffness in N m, or N m/rad, from units of 1,024.
    pub(super) fn quantity(&self, number: S) -> S::Quantity {
        number.to_quantity(&self.unit)
    }

    /// Stiffness about each joint, N m/rad, from the tendon forces relative to F0 and the muscles'
    /// stiffness ([`Muscle::stiffness`](crate::Muscle::stiffness), F0/L_ce0):
    /// K_j = Σ_i (k_i r_ij² - F_i dr_ij/dq_j). Negative if the posture is unstable.
    pub fn stiffnesses(
        &self,
        posture: &Posture<S, J, M>,
        relative_forces: &[S; M],
        relative_stiffnesses: &[S; M],
    ) -> [S::Quantity; J] {
        let numbers = self.stiffness_numbers(posture, relative_forces, relative_stiffnesses);
        numbers.map(|stiffness| self.quantity(stiffness))
    }

    /// Stiffnesses in units of 1,024 N m/rad.
    pub(super) fn stiffness_numbers(
        &self,
        posture: &Posture<S, J, M>,
        forces: &[S; M],
        stiffnesses: &[S; M],
    ) -> [S; J] {
        let mut sums = [S::ZERO; J];
        let pulls = forces.iter().zip(stiffnesses);
        for ((acting, placed), (&force, &stiffness)) in
            self.muscles.iter().zip(&posture.muscles).zip(pulls)
        {
            let arms = placed.moment_arms.iter().zip(&placed.arm_slopes);
            for (sum, (&arm, &slope)) in sums.iter_mut().zip(arms) {
                let elastic = stiffness * arm * arm;
                let geometric = force * slope;
                *sum = *sum + elastic.scaled(&acting.force_per_length)
                    - geometric.scaled(&acting.force);
            }
        }
        sums
    }

    /// Checksum of all coefficients.
    pub fn checksum(&self) -> u32 {
        let mut checksum = Checksum::EMPTY;
        self.sum(&mut checksum);
        checksum.value()
    }
}
