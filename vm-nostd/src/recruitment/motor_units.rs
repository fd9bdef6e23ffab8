//! How the cross section of each fibre type is divided among its motor units.

use crate::error::{Limit, ParameterError, within};
use crate::params::MuscleParams;
use heapless::Vec;

/// A rule for the sizes of a type's units, in order of recruitment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UnitSizes<'a> {
    /// So many units, the j-th in proportion to the type's rank + j.
    Default(usize),
    /// So many units, all alike.
    Equal(usize),
    /// So many units, each larger than the one before by a share of it, -0.5 to 1.
    Geometric(usize, f64),
    /// These sizes relative to each other, each 1e-12 to 1e12.
    Listed(&'a [f64]),
}

const COUNT: &str = "units: their number";
const TOO_MANY: &str = "units: the number of all types together";
const GROWTH: &str = "units: geometric growth";
const SIZE: &str = "units: a listed size";
const SMALLEST: &str = "units: share of the smallest in its type";
/// The smallest unit's share of its type's cross section.
const LEAST_SHARE: f64 = 1e-9;
const TYPES: &str = "units: the number of types they were made for";
const SHARE: &str = "units: the fraction of the type they were made for";
/// What the units of a type may differ from its fraction by.
const SHARE_TOLERANCE: f64 = 1e-9;

impl UnitSizes<'_> {
    fn count(&self) -> usize {
        match *self {
            Self::Default(count) | Self::Equal(count) | Self::Geometric(count, _) => count,
            Self::Listed(sizes) => sizes.len(),
        }
    }

    /// The size of unit `index` of a type of a rank, given that of the unit before.
    fn relative(&self, index: usize, rank: u8, before: f64) -> f64 {
        match *self {
            Self::Default(_) => f64::from(rank) + (index + 1) as f64,
            Self::Equal(_) => 1.0,
            Self::Geometric(..) if index == 0 => 1.0,
            Self::Geometric(_, growth) => before * (1.0 + growth),
            // None is asked for beyond the last.
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
    /// Its share of the muscle's cross section.
    pub(super) share: f64,
}

/// The motor units of a muscle, at most `UNITS`, in order of recruitment.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorUnits<const UNITS: usize> {
    units: Vec<MotorUnit, UNITS>,
}

impl<const UNITS: usize> MotorUnits<UNITS> {
    /// The units that divide the types of a muscle by a rule for each type. Refused where a type
    /// has none, where all together are more than `UNITS`, where a size is out of its range, and
    /// where a unit has less than 1e-9 of its type.
    pub fn new<const N: usize>(
        params: &MuscleParams<N>,
        sizes: [UnitSizes<'_>; N],
    ) -> Result<Self, ParameterError> {
        let mut units = Vec::new();
        for (fiber, (sizes, type_params)) in sizes.iter().zip(&params.fibers).enumerate() {
            let of_type = |error: ParameterError| ParameterError { fiber: Some(fiber), ..error };
            sizes.validate(UNITS).map_err(of_type)?;
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
                within(SMALLEST, unit.share / sum, LEAST_SHARE, 1.0).map_err(of_type)?;
                unit.share *= type_params.fraction / sum;
            }
        }
        Ok(Self { units })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.units.len()
    }

    /// Refuses a muscle whose types are not those that the units were made for.
    pub(super) fn validate<const N: usize>(
        &self,
        params: &MuscleParams<N>,
    ) -> Result<(), ParameterError> {
        let last = self.units.last().map_or(0.0, |unit| (unit.fiber + 1) as f64);
        within(TYPES, last, N as f64, N as f64)?;
        for (fiber, type_params) in params.fibers.iter().enumerate() {
            let of_type = self.units.iter().filter(|unit| unit.fiber == fiber);
            let share: f64 = of_type.map(|unit| unit.share).sum();
            let fraction = type_params.fraction;
            within(SHARE, share, fraction - SHARE_TOLERANCE, fraction + SHARE_TOLERANCE)
                .map_err(|error| ParameterError { fiber: Some(fiber), ..error })?;
        }
        Ok(())
    }

    /// That there are none.
    pub(super) fn none(&self) -> ParameterError {
        let limit = Limit::Within { least: 1.0, most: UNITS as f64 };
        ParameterError { field: COUNT, fiber: None, value: 0.0, limit }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &MotorUnit> {
        self.units.iter()
    }
}
