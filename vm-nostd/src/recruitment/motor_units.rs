//! Division of the fibre types' cross sections among motor units.

use crate::error::{Limit, ParameterError, within};
use crate::params::MuscleParams;
use heapless::Vec;

/// A rule for the sizes of the units of a type, in order of recruitment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UnitSizes<'a> {
    /// The authors' rule for a number of units: the size of unit j is proportional to rank of the
    /// type + j.
    Default(usize),
    /// A number of units of equal size.
    Equal(usize),
    /// A number of units and their growth, -0.5 to 1: the size of each is that of the previous
    /// times 1 + growth.
    Geometric(usize, f64),
    /// Relative sizes, each 1e-12 to 1e12.
    Listed(&'a [f64]),
}

const COUNT: &str = "units: count";
const TOO_MANY: &str = "units: total count";
const GROWTH: &str = "units: geometric growth";
const SIZE: &str = "units: listed size";
const SMALLEST: &str = "units: smallest share of a type";
/// Lower limit of the cross section of a unit, as a share of its type.
const LEAST_SHARE: f64 = 1e-9;
const TYPES: &str = "units: number of types";
const SHARE: &str = "units: fraction of the type";
/// Tolerance between the sum of a type's units and its fraction.
const SHARE_TOLERANCE: f64 = 1e-9;

impl UnitSizes<'_> {
    fn count(&self) -> usize {
        match *self {
            Self::Default(count) | Self::Equal(count) | Self::Geometric(count, _) => count,
            Self::Listed(sizes) => sizes.len(),
        }
    }

    /// Relative size of unit `index` of a type of a rank; `before` is that of the previous unit.
    fn relative(&self, index: usize, rank: u8, before: f64) -> f64 {
        match *self {
            Self::Default(_) => f64::from(rank) + (index + 1) as f64,
            Self::Equal(_) => 1.0,
            Self::Geometric(..) if index == 0 => 1.0,
            Self::Geometric(_, growth) => before * (1.0 + growth),
            // `index` is in range: `count` is the number of sizes.
            Self::Listed(sizes) => sizes.get(index).copied().unwrap_or(before),
        }
    }

    fn validate(&self, most: usize) -> Result<(), ParameterError> {
        within(COUNT, self.count() as f64, 1.0, most as f64)?;
        match self {
            Self::Geometric(_, growth) => within(GROWTH, *growth, -0.5, 1.0),
            Self::Listed(sizes) => {
                sizes.iter().try_for_each(|size| within(SIZE, *size, 1e-12, 1e12))
            }
            _ => Ok(()),
        }
    }
}

/// A motor unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MotorUnit {
    /// Index of its fibre type.
    pub(super) fiber: usize,
    /// Cross section, as a share of the muscle.
    pub(super) share: f64,
}

/// The motor units of a muscle, at most `UNITS`, in order of recruitment.
///
/// ```
/// use vm_nostd::paper_table_1::{ELEMENTS, FAST, SLOW};
/// use vm_nostd::{
///     Class, DiscreteMuscle, FiberParams, Input, MotorUnits, MuscleParams, TimeStep, UnitSizes,
/// };
///
/// # let fibers = [
/// #     FiberParams { fraction: 0.6, fiber_type: SLOW },
/// #     FiberParams { fraction: 0.4, fiber_type: FAST },
/// # ];
/// # let params = MuscleParams {
/// #     mass: 97.5e-3, fascicle_length: 0.11, tendon_length: 0.02, max_path_length: 0.184,
/// #     recruitment_saturation: 0.8, class: Class::Standard, elements: ELEMENTS, fibers,
/// # };
/// // 30 slow units of the authors' sizes, and 20 fast units, each 5 % larger than the previous.
/// let sizes = [UnitSizes::Default(30), UnitSizes::Geometric(20, 0.05)];
/// let units = MotorUnits::<50>::new(&params, sizes)?;
/// let step = TimeStep::MILLISECOND;
/// let muscle = DiscreteMuscle::<f32, 2, 50>::build_with_units(&params, &units, step)?;
/// let mut state = muscle.rest(0.16)?;
/// let input = Input { activation: 0.3, path_length: 0.16, stimulation_frequency: 0.0 };
/// muscle.step(&mut state, input);
/// # Ok::<(), vm_nostd::ParameterError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MotorUnits<const UNITS: usize> {
    units: Vec<MotorUnit, UNITS>,
}

impl<const UNITS: usize> MotorUnits<UNITS> {
    /// Divides each type of a muscle into units by its rule. Returns an error if a type has no
    /// units, if there are more than `UNITS` in total, if a size is out of range, or if a unit is
    /// smaller than 1e-9 of its type.
    pub fn new<const N: usize>(
        params: &MuscleParams<N>,
        sizes: [UnitSizes<'_>; N],
    ) -> Result<Self, ParameterError> {
        let mut units = Vec::new();
        for (fiber, (sizes, type_params)) in sizes.iter().zip(&params.fibers).enumerate() {
            let in_type = |error: ParameterError| ParameterError { fiber: Some(fiber), ..error };
            sizes.validate(UNITS).map_err(in_type)?;
            let rank = type_params.fiber_type.rank;
            let first = units.len();
            let (mut size, mut sum) = (0.0, 0.0);
            for index in 0..sizes.count() {
                size = sizes.relative(index, rank, size);
                sum += size;
                units.push(MotorUnit { fiber, share: size }).map_err(|_| ParameterError {
                    field: TOO_MANY,
                    fiber: None,
                    value: (first + sizes.count()) as f64,
                    limit: Limit::Within { least: N as f64, most: UNITS as f64 },
                })?;
            }
            for unit in units.iter_mut().skip(first) {
                within(SMALLEST, unit.share / sum, LEAST_SHARE, 1.0).map_err(in_type)?;
                unit.share *= type_params.fraction / sum;
            }
        }
        Ok(Self { units })
    }

    /// Number of units.
    pub fn count(&self) -> usize {
        self.units.len()
    }

    /// Refuses a muscle whose types do not match the units.
    pub(super) fn validate<const N: usize>(
        &self,
        params: &MuscleParams<N>,
    ) -> Result<(), ParameterError> {
        let last = self.units.last().map_or(0.0, |unit| (unit.fiber + 1) as f64);
        within(TYPES, last, N as f64, N as f64)?;
        for (fiber, type_params) in params.fibers.iter().enumerate() {
            let units = self.units.iter().filter(|unit| unit.fiber == fiber);
            let share: f64 = units.map(|unit| unit.share).sum();
            let fraction = type_params.fraction;
            within(SHARE, share, fraction - SHARE_TOLERANCE, fraction + SHARE_TOLERANCE)
                .map_err(|error| ParameterError { fiber: Some(fiber), ..error })?;
        }
        Ok(())
    }

    /// The error for missing units.
    pub(super) fn none(&self) -> ParameterError {
        let limit = Limit::Within { least: 1.0, most: UNITS as f64 };
        ParameterError { field: COUNT, fiber: None, value: 0.0, limit }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &MotorUnit> {
        self.units.iter()
    }
}
