//! Motor units.

// The header has them whatever the features.
#![cfg_attr(not(feature = "units"), allow(dead_code))]

/// Most motor units of a muscle.
pub const VM_MAX_UNITS: usize = 64;

/// Rule for the sizes of units: in proportion to the type's rank plus the unit's index.
pub const VM_UNITS_DEFAULT: u32 = 0;
/// Rule: all alike.
pub const VM_UNITS_EQUAL: u32 = 1;
/// Rule: each larger than the one before, by `growth` of it.
pub const VM_UNITS_GEOMETRIC: u32 = 2;
/// Rule: `sizes`, relative to each other.
pub const VM_UNITS_LISTED: u32 = 3;

/// Motor units of a fibre type.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmUnitSizes {
    /// VM_UNITS_DEFAULT (0), VM_UNITS_EQUAL, VM_UNITS_GEOMETRIC or VM_UNITS_LISTED.
    pub rule: u32,
    /// Number of units; at least 1, and at most 64 of all types together.
    pub count: u32,
    /// Growth of VM_UNITS_GEOMETRIC; -0.5 to 1.
    pub growth: f64,
    /// `count` sizes of VM_UNITS_LISTED, 1e-12 to 1e12; else ignored.
    pub sizes: *const f64,
}

/// Motor units of a muscle, by fibre type.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmUnits {
    /// Of each type; only the first `fiber_count` are read.
    pub fibers: [VmUnitSizes; crate::params::VM_MAX_FIBERS],
}

/// Motor units of a muscle. Missing ones are a null pointer.
#[cfg(feature = "units")]
pub fn motor_units<const N: usize>(
    params: &model::MuscleParams<N>,
    units: Option<&VmUnits>,
) -> Result<model::MotorUnits<VM_MAX_UNITS>, crate::result::Refusal> {
    use crate::result::VmResult;
    use model::{Limit, ParameterError, UnitSizes};

    let units = units.ok_or(VmResult::NullPointer)?;
    let mut sizes = [UnitSizes::Default(1); N];
    for (fiber, (place, given)) in sizes.iter_mut().zip(&units.fibers).enumerate() {
        let count = given.count as usize;
        *place = match given.rule {
            VM_UNITS_DEFAULT => UnitSizes::Default(count),
            VM_UNITS_EQUAL => UnitSizes::Equal(count),
            VM_UNITS_GEOMETRIC => UnitSizes::Geometric(count, given.growth),
            VM_UNITS_LISTED => UnitSizes::Listed(crate::pointer::slice(given.sizes, count)?),
            other => {
                let limit = Limit::Within { least: 0.0, most: 3.0 };
                let value = other.into();
                return Err(
                    ParameterError { field: "rule", fiber: Some(fiber), value, limit }.into()
                );
            }
        };
    }
    Ok(model::MotorUnits::new(params, sizes)?)
}
