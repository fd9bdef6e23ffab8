//! What follows from a muscle's parameters.

use crate::kinds::by_types;
use crate::outcome::told;
use crate::params::{VM_MAX_FIBERS, VM_VERSION, VmMuscleParams};
use crate::pointer::{Place, borrow};
use crate::result::{Refusal, VmError, VmResult};
use model::{Limit, ParameterError};

/// What follows from a muscle's parameters, in their units.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmDerived {
    /// Maximal isometric force F0, N.
    pub max_isometric_force_n: f64,
    /// Fascicle length L_max on the longest path, L_ce0.
    pub maximum_fascicle_length: f64,
    /// Shortest and longest fascicles at which the filaments' equations hold, L_ce0.
    pub fascicle_domain: [f64; 2],
    /// V_max of the slowest type, L_ce0/s, negative.
    pub shortening_velocity: f64,
    /// Shortest and longest path, m. In fixed point the longest may be shorter.
    pub path_domain_m: [f64; 2],
    /// Midpoint between the shortest path and max_path_length_m, m.
    pub middle_path_m: f64,
}

/// Parameters of this version, with a number of types that this library has.
pub(crate) fn admitted<'a>(params: *const VmMuscleParams) -> Result<&'a VmMuscleParams, Refusal> {
    let params = borrow(params)?;
    if params.version != VM_VERSION {
        return Err(VmResult::Version.into());
    }
    has_types(params.fiber_count)?;
    Ok(params)
}

/// Refuses a number of types that this library does not have.
pub(crate) fn has_types(count: u32) -> Result<(), ParameterError> {
    let (least, most) = if cfg!(feature = "types") { (1, VM_MAX_FIBERS as u32) } else { (2, 2) };
    if (least..=most).contains(&count) {
        return Ok(());
    }
    let limit = Limit::Within { least: least.into(), most: most.into() };
    Err(ParameterError { field: "fiber_count", fiber: None, value: count.into(), limit })
}

fn derived_of<const N: usize>(params: &VmMuscleParams) -> Result<VmDerived, Refusal> {
    let params = params.model::<N>()?;
    params.validate()?;
    let (shortest, longest) = params.fascicle_domain();
    let paths = params.path_domain();
    Ok(VmDerived {
        max_isometric_force_n: params.max_isometric_force(),
        maximum_fascicle_length: params.maximum_fascicle_length(),
        fascicle_domain: [shortest, longest],
        shortening_velocity: params.shortening_velocity(),
        path_domain_m: [paths.0, paths.1],
        middle_path_m: params.middle_path(),
    })
}

/// What follows from admitted parameters.
pub(crate) fn derived_from(params: &VmMuscleParams) -> Result<VmDerived, Refusal> {
    by_types!(params.fiber_count, Err(VmResult::NotBuilt.into()), derived_of, (params))
}

/// Validates parameters and computes what follows from them. On VM_RESULT_PARAMETER `error`, which
/// may be null, has the field, value and limits.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_params_derive(
    params: *const VmMuscleParams,
    derived: *mut VmDerived,
    error: *mut VmError,
) -> VmResult {
    let outcome = || -> Result<(), Refusal> {
        Place::optional(error)?;
        let place = Place::new(derived)?;
        place.put(derived_from(admitted(params)?)?);
        Ok(())
    };
    told(outcome(), error)
}
