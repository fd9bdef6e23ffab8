//! What a muscle is made of, in SI units and `f64`, and the limits of what can be built.

use crate::activation::ActivationParams;
use crate::contraction::largest_inertia;
use crate::domain::MAXIMUM_STIMULATION_FREQUENCY;
use crate::error::{Limit, ParameterError, within};
use crate::excitation::ExcitationParams;
use crate::force_length::ForceLengthParams;
use crate::force_velocity::ForceVelocityParams;
use crate::passive::{CompressionParams, ParallelParams};
use crate::sag::SagParams;
use crate::tendon::TendonParams;
use crate::time_step::TimeStep;
use crate::yielding::YieldParams;

/// Coefficients of a fibre type.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FiberType {
    /// Order of recruitment: super-slow 1, slow 2, fast 3; 1 to 255.
    pub rank: u8,
    /// Frequency of half-maximal force at optimal length f_0.5, pps; 0.5 to 200.
    #[doc(alias = "f05")]
    pub half_force_frequency: f64,
    /// Firing frequency at recruitment f_min, f0.5; 0 to 5.
    #[doc(alias = "fmin")]
    pub minimum_frequency: f64,
    /// Firing frequency at full activation f_max, f0.5; f_min to 10.
    #[doc(alias = "fmax")]
    pub maximum_frequency: f64,
    /// Force-length relation.
    pub force_length: ForceLengthParams,
    /// Force-velocity relation.
    pub force_velocity: ForceVelocityParams,
    /// Activation-frequency relation.
    pub activation: ActivationParams,
    /// Rise and fall of excitation.
    pub excitation: ExcitationParams,
    /// Time constant of effective length T_L, s, in the mode that has one; 5e-5 to 0.01.
    #[doc(alias = "TL")]
    pub effective_length_time: f64,
    /// Sag, of fast types.
    pub sag: Option<SagParams>,
    /// Yield, of slow types.
    pub yielding: Option<YieldParams>,
}

impl FiberType {
    fn validate(&self) -> Result<(), ParameterError> {
        within("rank", f64::from(self.rank), 1.0, 255.0)?;
        within("half_force_frequency", self.half_force_frequency, 0.5, 200.0)?;
        within("minimum_frequency", self.minimum_frequency, 0.0, 5.0)?;
        within("maximum_frequency", self.maximum_frequency, self.minimum_frequency, 10.0)?;
        self.force_length.validate()?;
        self.force_velocity.validate()?;
        self.activation.validate()?;
        self.excitation.validate()?;
        within("effective_length_time", self.effective_length_time, 5e-5, 0.01)?;
        self.sag.as_ref().map_or(Ok(()), SagParams::validate)?;
        self.yielding.as_ref().map_or(Ok(()), YieldParams::validate)
    }
}

/// A fibre type and its share of a muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FiberParams {
    /// Share of the physiological cross-sectional area; 0.001 to 1.
    pub fraction: f64,
    /// The type.
    pub fiber_type: FiberType,
}

/// Coefficients that all fibre types of a muscle share.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ElementParams {
    /// Tendon and aponeurosis.
    pub tendon: TendonParams,
    /// Parallel elastic element F_pe1.
    pub parallel: ParallelParams,
    /// Thick-filament compression F_pe2.
    pub compression: CompressionParams,
    /// Force per cross-sectional area, N/m²; 1e4 to 1e7.
    pub specific_tension: f64,
    /// Density of muscle, kg/m³; 500 to 2000.
    pub density: f64,
}

impl ElementParams {
    fn validate(&self) -> Result<(), ParameterError> {
        self.tendon.validate()?;
        self.parallel.validate()?;
        self.compression.validate()?;
        within("specific_tension", self.specific_tension, 1e4, 1e7)?;
        within("density", self.density, 500.0, 2000.0)
    }
}

/// A muscle of `N` fibre types.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// An array of any length has no implementation of serde's traits; those of the lengths in use do.
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "[FiberParams; N]: serde::Serialize",
        deserialize = "[FiberParams; N]: serde::Deserialize<'de>"
    ))
)]
pub struct MuscleParams<const N: usize> {
    /// Mass m, kg; 1e-5 to 20. It makes the cross section, and with it F0, and half of it moves.
    pub mass: f64,
    /// Optimal fascicle length L_ce0, m; 0.005 to 1.
    pub fascicle_length: f64,
    /// Optimal tendon length L_se0, m; 0.001 to 2.
    pub tendon_length: f64,
    /// Longest musculotendon path L_mt_max, m; such that
    /// [`MuscleParams::maximum_fascicle_length`] is 0.8 to 2.
    pub max_path_length: f64,
    /// Activation U_r at which all fibres are recruited in the natural modes; 0.01 to 1.
    #[doc(alias = "Ur")]
    pub recruitment_saturation: f64,
    /// What the fibre types share.
    pub elements: ElementParams,
    /// Fibre types in order of rank; their fractions add to 1.
    pub fibers: [FiberParams; N],
}

/// The fractions of all types add to 1 within this.
const FRACTION_SUM_TOLERANCE: f64 = 1e-6;
/// L_max that a muscle may have, L_ce0.
const MAXIMUM_FASCICLE_LENGTH: (f64, f64) = (0.8, 2.0);
/// A path must have at least this range, L_ce0.
const LEAST_PATH_RANGE: f64 = 0.1;
/// Fascicle lengths outside of which no type is evaluated, L_ce0.
pub(crate) const FASCICLE_DOMAIN: (f64, f64) = (0.4, 1.8);
/// Fields that are refused for what follows from them.
const SHORTEST_LENGTH: &str = "force_velocity.shortening: shortest length (L_ce0) without a pole";
/// Fields that fixed point refuses for what follows from them.
const INERTIA: &str = "fascicle_length: inertia in a substep, F0 s/L_ce0";
const COMPRESSION: &str = "compression.strength: force at the shortest length, F0";
const TOE_FORCE: &str = "tendon.toe: stiffness times toe, F0";
/// The force that a tendon must be able to carry, F0.
const LEAST_FORCE: f64 = 10.0;
const REACH: &str = "max_path_length: range of the path, L_ce0";
const LONGEST_LENGTH: &str = "activation.length_dependence: longest length (L_ce0) with n_f >= 0.2";
/// A type must be usable at least between these fascicle lengths, L_ce0.
const LONGEST_LOWER_EDGE: f64 = 0.9;
const SHORTEST_UPPER_EDGE: f64 = 1.1;

impl<const N: usize> MuscleParams<N> {
    /// Maximal isometric force F0, N: specific tension times cross-sectional area.
    pub fn max_isometric_force(&self) -> f64 {
        self.elements.specific_tension * self.mass / (self.elements.density * self.fascicle_length)
    }

    /// Length L_max of the fascicles, in L_ce0, when the passive muscle is on its longest path.
    #[doc(alias = "Lmax")]
    pub fn maximum_fascicle_length(&self) -> f64 {
        let tendon = self.elements.tendon.length_at(self.elements.parallel.force(1.0));
        (self.max_path_length - tendon * self.tendon_length) / self.fascicle_length
    }

    /// Fascicle lengths, in L_ce0, between which the model's equations hold for every type:
    /// the force-velocity relation has no pole and n_f is not near 0.
    pub fn fascicle_domain(&self) -> (f64, f64) {
        let (least, most) = FASCICLE_DOMAIN;
        self.fibers.iter().fold((least, most), |(least, most), fiber| {
            let t = &fiber.fiber_type;
            (t.force_velocity.shortest_length(least), t.activation.longest_length(most))
        })
    }

    /// The velocity of unloaded shortening of the slowest type, L_ce0/s, negative: faster than
    /// this the force-velocity relation of that type is 0.
    pub fn shortening_velocity(&self) -> f64 {
        let velocities = self.fibers.iter().map(|f| f.fiber_type.force_velocity.maximum_velocity);
        velocities.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Path lengths, in m, that are taken as they are; others are saturated and flagged.
    /// The shortest is where the tendon is slack with the fascicles at their shortest.
    pub fn path_domain(&self) -> (f64, f64) {
        let shortest = self.fascicle_domain().0 * self.fascicle_length
            + self.elements.tendon.slack_length * self.tendon_length;
        (shortest, self.max_path_length)
    }

    /// Whether a muscle can be built from these parameters; the error names the field, its
    /// value and the limit it broke.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("mass", self.mass, 1e-5, 20.0)?;
        within("fascicle_length", self.fascicle_length, 5e-3, 1.0)?;
        within("tendon_length", self.tendon_length, 1e-3, 2.0)?;
        within("recruitment_saturation", self.recruitment_saturation, 0.01, 1.0)?;
        self.elements.validate()?;
        self.validate_fibers()?;

        self.each_fiber(|t| {
            let (least, most) = FASCICLE_DOMAIN;
            let shortest = t.force_velocity.shortest_length(least);
            within(SHORTEST_LENGTH, shortest, least, LONGEST_LOWER_EDGE)?;
            let longest = t.activation.longest_length(most);
            within(LONGEST_LENGTH, longest, SHORTEST_UPPER_EDGE, most)
        })?;
        let (shortest, longest) = self.fascicle_domain();
        self.each_fiber(|t| t.force_velocity.validate_monotone(shortest, longest))?;

        let path_at = |maximum: f64| {
            self.max_path_length + (maximum - self.maximum_fascicle_length()) * self.fascicle_length
        };
        let (least, most) = MAXIMUM_FASCICLE_LENGTH;
        let room = LEAST_PATH_RANGE * self.fascicle_length;
        let (least, most) = (path_at(least).max(self.path_domain().0 + room), path_at(most));
        within("max_path_length", self.max_path_length, least, most)
    }

    /// Whether coefficients, and forces on the way, fit in the arithmetic: in fixed point a number
    /// ends at 128, and sums of two coefficients have to fit.
    pub(crate) fn validate_magnitudes(
        &self,
        step: TimeStep,
        largest: f64,
    ) -> Result<(), ParameterError> {
        let (shortest, longest) = self.fascicle_domain();
        within(INERTIA, largest_inertia(self, step), 0.0, largest)?;
        let tendon = &self.elements.tendon;
        let stiffness = tendon.stiffness * self.fascicle_length / self.tendon_length;
        within("tendon.stiffness: F0/L_ce0", stiffness, 0.0, 100.0 * largest)?;
        // So many widths of the toe can be told; less force than this would not do.
        let toe_force = tendon.stiffness * tendon.toe;
        within(TOE_FORCE, toe_force, LEAST_FORCE / (2.0 * largest), f64::MAX)?;
        // A path reaches this far where no tendon is left.
        let reach = self.max_path_length / self.fascicle_length;
        within(REACH, reach - self.path_domain().0 / self.fascicle_length, 0.0, largest)?;
        let parallel = self.elements.parallel.force(reach / self.maximum_fascicle_length());
        within("parallel.stiffness: force on the longest path, F0", parallel, 0.0, largest)?;
        let compression = self.elements.compression.force(shortest);
        within(COMPRESSION, compression, -largest / 4.0, 0.0)?;
        self.each_fiber(|t| {
            let frequency = MAXIMUM_STIMULATION_FREQUENCY / t.half_force_frequency;
            // Added to nothing, it may be as large as two coefficients.
            within("half_force_frequency: 500 pps, f0.5", frequency, 0.0, 2.0 * largest)?;
            t.activation.validate_magnitudes(shortest, largest)?;
            t.force_velocity.validate_magnitudes(shortest, longest, largest)
        })
    }

    /// Checks every type; the error says which.
    fn each_fiber(
        &self,
        check: impl Fn(&FiberType) -> Result<(), ParameterError>,
    ) -> Result<(), ParameterError> {
        for (index, fiber) in self.fibers.iter().enumerate() {
            check(&fiber.fiber_type)
                .map_err(|error| ParameterError { fiber: Some(index), ..error })?;
        }
        Ok(())
    }

    fn validate_fibers(&self) -> Result<(), ParameterError> {
        let mut sum = 0.0;
        let mut rank_before = 0;
        for (index, fiber) in self.fibers.iter().enumerate() {
            let located = |error| ParameterError { fiber: Some(index), ..error };
            within("fraction", fiber.fraction, 1e-3, 1.0).map_err(located)?;
            fiber.fiber_type.validate().map_err(located)?;
            let rank = fiber.fiber_type.rank;
            if rank < rank_before {
                let limit = Limit::NotBefore { rank: f64::from(rank_before) };
                let value = f64::from(rank);
                return Err(located(ParameterError { field: "rank", fiber: None, value, limit }));
            }
            rank_before = rank;
            sum += fiber.fraction;
        }
        if N == 0 {
            let limit = Limit::AtLeastOneType;
            return Err(ParameterError { field: "fibers", fiber: None, value: 0.0, limit });
        }
        if (sum - 1.0).abs() > FRACTION_SUM_TOLERANCE {
            let limit = Limit::SumIsOne { within: FRACTION_SUM_TOLERANCE };
            return Err(ParameterError { field: "fraction", fiber: None, value: sum, limit });
        }
        Ok(())
    }
}
