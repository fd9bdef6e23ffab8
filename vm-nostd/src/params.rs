//! Parameters of a muscle, in SI units and `f64`, and their limits.

pub(crate) mod class;
pub(crate) mod limits;
pub(crate) mod presets;

use crate::equations::activation_frequency::ActivationParams;
use crate::equations::excitation::ExcitationParams;
use crate::equations::force_length::ForceLengthParams;
use crate::equations::force_velocity::ForceVelocityParams;
use crate::equations::passive::{CompressionParams, ParallelParams};
use crate::equations::sag::SagParams;
use crate::equations::tendon::TendonParams;
use crate::equations::yielding::YieldParams;
use crate::error::{Limit, ParameterError, within};
use crate::scalar::Arithmetic;
use crate::tick::time_step::TimeStep;
use class::Class;
use limits::{MAXIMUM_SPEED, MAXIMUM_STIMULATION_FREQUENCY};

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
    /// Time constant of effective length T_L, s; 5e-5 to 0.01. Only `EffectiveLengthMuscle` uses
    /// it.
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
    /// The fibre type.
    pub fiber_type: FiberType,
}

/// Coefficients shared by all fibre types of a muscle.
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
// serde implements its traits for arrays of certain lengths only.
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "[FiberParams; N]: serde::Serialize",
        deserialize = "[FiberParams; N]: serde::Deserialize<'de>"
    ))
)]
pub struct MuscleParams<const N: usize> {
    /// Mass m, kg; 1e-5 to 30. It gives the cross section and F0; half of it is the moving mass.
    pub mass: f64,
    /// Optimal fascicle length L_ce0, m; 0.005 to 1.
    pub fascicle_length: f64,
    /// Optimal tendon length L_se0, m; 0.0005 to 2.
    pub tendon_length: f64,
    /// Longest musculotendon path L_mt_max, m; such that
    /// [`MuscleParams::maximum_fascicle_length`] is 0.8 to 2. It scales the parallel elastic
    /// element; paths may be longer, see [`MuscleParams::path_domain`].
    pub max_path_length: f64,
    /// Activation U_r at which all fibres are recruited in the natural modes; 0.01 to 1.
    #[doc(alias = "Ur")]
    pub recruitment_saturation: f64,
    /// Accuracy class.
    #[cfg_attr(feature = "serde", serde(default))]
    pub class: Class,
    /// Coefficients shared by the fibre types.
    pub elements: ElementParams,
    /// Fibre types in order of rank; their fractions add to 1.
    pub fibers: [FiberParams; N],
}

/// Tolerance of the sum of fractions.
const FRACTION_SUM_TOLERANCE: f64 = 1e-6;
/// Range of L_max, L_ce0.
const MAXIMUM_FASCICLE_LENGTH: (f64, f64) = (0.8, 2.0);
/// Least range of the path domain, L_ce0.
const LEAST_PATH_RANGE: f64 = 0.1;
/// Widest range of fascicle lengths in which types are evaluated, L_ce0.
pub(crate) const FASCICLE_DOMAIN: (f64, f64) = (0.4, 1.8);
/// Margin for ringing of the longest fascicles, beyond those at rest on the longest path, L_ce0.
const RINGING_ROOM: f64 = 0.25;
/// Number of bisections that resolve a length to the last bits of `f64`.
const HALVINGS: usize = 60;
/// Largest F_pe2, F0. It is weighted by Af, which `f32` resolves to 4e-7.
const MOST_COMPRESSION: f64 = 1000.0;
/// Names of derived quantities that are refused.
const COMPRESSION: &str = "compression.strength: force at the shortest length, F0";
const SHORTEST_LENGTH: &str = "force_velocity.shortening: shortest length (L_ce0) without a pole";
/// Names of derived quantities that fixed point refuses.
const PARALLEL: &str = "parallel.stiffness: force of the longest fascicles, F0";
const PARALLEL_TOE: &str = "parallel.toe: longest fascicles beyond slack, toes";
const TOE_FORCE: &str = "tendon.toe: stiffness times toe, F0";
/// Force that a tendon must carry, F0. The path domain ends where the fascicles exceed it.
const LEAST_FORCE: f64 = 10.0;
const REACH: &str = "max_path_length: range of the path, L_ce0";
const LONGEST_LENGTH: &str = "activation.length_dependence: longest length (L_ce0) with n_f >= 0.2";
/// Fascicle lengths at which every type must be valid, L_ce0.
const LONGEST_LOWER_EDGE: f64 = 0.9;
const SHORTEST_UPPER_EDGE: f64 = 1.1;

impl<const N: usize> MuscleParams<N> {
    /// Maximal isometric force F0, N: specific tension times cross-sectional area.
    pub fn max_isometric_force(&self) -> f64 {
        self.elements.specific_tension * self.mass / (self.elements.density * self.fascicle_length)
    }

    /// Fascicle length L_max, in L_ce0, of the passive muscle on its longest path.
    #[doc(alias = "Lmax")]
    pub fn maximum_fascicle_length(&self) -> f64 {
        let tendon = self.elements.tendon.length_at(self.elements.parallel.force(1.0));
        (self.max_path_length - tendon * self.tendon_length) / self.fascicle_length
    }

    /// Validity range of fascicle lengths, in L_ce0: for every type FV has no pole and n_f is at
    /// least 0.2.
    pub fn fascicle_domain(&self) -> (f64, f64) {
        let (least, most) = FASCICLE_DOMAIN;
        self.fibers.iter().fold((least, most), |(least, most), fiber| {
            let t = &fiber.fiber_type;
            (t.force_velocity.shortest_length(least), t.activation.longest_length(most))
        })
    }

    /// V_max of the slowest type, L_ce0/s, negative: FV of that type is 0 beyond it.
    pub fn shortening_velocity(&self) -> f64 {
        let velocities = self.fibers.iter().map(|f| f.fiber_type.force_velocity.maximum_velocity);
        velocities.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Path lengths, in m, that are accepted; others are clipped and flagged.
    ///
    /// On the shortest path the tendon is slack with the fascicles at the lower end of
    /// [`fascicle_domain`](Self::fascicle_domain) (FV's pole). On the longest path the fascicles
    /// are at its upper end (n_f = 0.2) and pull with F0 plus their passive force: on a longer path
    /// no activation keeps them inside. The longest path is limited to a passive force of 9 F0,
    /// which every arithmetic can represent, and is at least `max_path_length`. In fixed point it
    /// may be shorter: [`Muscle::path_length_range`](crate::Muscle::path_length_range).
    pub fn path_domain(&self) -> (f64, f64) {
        let tendon = &self.elements.tendon;
        let shortest = self.fascicle_domain().0 * self.fascicle_length
            + tendon.slack_length * self.tendon_length;
        let parallel = &self.elements.parallel;
        let maximum = self.maximum_fascicle_length();
        let most_passive = parallel.length_at(LEAST_FORCE - 1.0) * maximum;
        let fascicles = Arithmetic::min(self.fascicle_domain().1, most_passive);
        let force = parallel.force(fascicles / maximum) + 1.0;
        let longest =
            fascicles * self.fascicle_length + tendon.length_at(force) * self.tendon_length;
        (shortest, Arithmetic::max(longest, self.max_path_length))
    }

    /// Midpoint between the shortest path and `max_path_length`, m.
    pub fn middle_path(&self) -> f64 {
        0.5 * (self.path_domain().0 + self.max_path_length)
    }

    /// Path domain (m) in an arithmetic with paths up to `longest_path` (m) and lengths up to
    /// `largest` (L_ce0).
    pub(crate) fn path_domain_within(&self, longest_path: f64, largest: f64) -> (f64, f64) {
        let (shortest, longest) = self.path_domain();
        let most = Arithmetic::min(longest_path, shortest + largest * self.fascicle_length);
        (shortest, Arithmetic::min(longest, most))
    }

    /// Longest fascicles on paths up to `longest` (m), in L_ce0: at rest plus the margin for
    /// ringing, but leaving room for the tendon.
    pub(crate) fn longest_fascicles(&self, longest: f64) -> f64 {
        let parallel = &self.elements.parallel;
        let maximum = self.maximum_fascicle_length();
        let none_left = longest / self.fascicle_length;
        let (mut least, mut most) = (0.0, none_left);
        for _ in 0..HALVINGS {
            let length = 0.5 * (least + most);
            let tendon = (longest - length * self.fascicle_length) / self.tendon_length;
            if self.elements.tendon.force(tendon) > parallel.force(length / maximum) {
                least = length;
            } else {
                most = length;
            }
        }
        Arithmetic::min(most + RINGING_ROOM, none_left)
    }

    /// Validates the parameters; the error has field, value and limit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("mass", self.mass, 1e-5, 30.0)?;
        within("fascicle_length", self.fascicle_length, 5e-3, 1.0)?;
        within("tendon_length", self.tendon_length, 5e-4, 2.0)?;
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
        let compression = self.elements.compression.force(shortest);
        within(COMPRESSION, compression, -MOST_COMPRESSION, 0.0)?;
        self.each_fiber(|t| t.force_velocity.validate_monotone(shortest, longest))?;

        let path_at = |maximum: f64| {
            self.max_path_length + (maximum - self.maximum_fascicle_length()) * self.fascicle_length
        };
        let (least, most) = MAXIMUM_FASCICLE_LENGTH;
        let room = LEAST_PATH_RANGE * self.fascicle_length;
        let (least, most) = (path_at(least).max(self.path_domain().0 + room), path_at(most));
        within("max_path_length", self.max_path_length, least, most)
    }

    /// Checks that coefficients and intermediate forces are representable: fixed point ends at 128,
    /// and sums of two coefficients must fit.
    pub(crate) fn validate_magnitudes(
        &self,
        step: TimeStep,
        largest: f64,
        longest_path: f64,
    ) -> Result<(), ParameterError> {
        let (shortest, longest) = self.fascicle_domain();
        let tendon = &self.elements.tendon;
        let stiffness = tendon.stiffness * self.fascicle_length / self.tendon_length;
        within("tendon.stiffness: F0/L_ce0", stiffness, 0.0, 100.0 * largest)?;
        // The tendon must carry this force at its greatest representable extension.
        let toe_force = tendon.stiffness * tendon.toe;
        within(TOE_FORCE, toe_force, LEAST_FORCE / (2.0 * largest), f64::MAX)?;
        let reach = (self.max_path_length - self.path_domain().0) / self.fascicle_length;
        within(REACH, reach, 0.0, largest)?;
        // The state's range of lengths ends here, whatever the path.
        let (_, longest_path) = self.path_domain_within(longest_path, largest);
        let parallel = &self.elements.parallel;
        let stretch = self.longest_fascicles(longest_path) / self.maximum_fascicle_length();
        within(PARALLEL, parallel.force(stretch), 0.0, largest)?;
        let toes = (stretch - parallel.slack_length) / parallel.toe;
        within(PARALLEL_TOE, toes, f64::MIN, 2.0 * largest)?;
        // The mechanics extrapolate it linearly by half a tick at the greatest speed. No sum with
        // it may saturate up to there. It is added to a few F0 at most: the sum stays negative and
        // is clamped to 0.
        let compression = self.elements.compression.force(shortest);
        let steepness = self.elements.compression.steepness;
        let extrapolated = 1.0 - 0.5 * steepness * MAXIMUM_SPEED * step.seconds();
        within(COMPRESSION, compression, -2.0 * largest / extrapolated, 0.0)?;
        self.each_fiber(|t| {
            let frequency = MAXIMUM_STIMULATION_FREQUENCY / t.half_force_frequency;
            // It is not added to anything, so it may be as large as the sum of two coefficients.
            within("half_force_frequency: 500 pps, f0.5", frequency, 0.0, 2.0 * largest)?;
            t.activation.validate_magnitudes(shortest, largest)?;
            t.force_velocity.validate_magnitudes(shortest, longest, largest)
        })
    }

    /// Validates every type; the error has the type's index.
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
