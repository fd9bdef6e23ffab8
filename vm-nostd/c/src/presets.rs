//! Published elements and fibre types.

use crate::outcome::plain;
use crate::params::{VmElements, VmFiber};
use crate::pointer::Place;
use crate::result::VmResult;
use model::{ElementParams, FiberType, feline_vm4, human_vm4, paper_table_1};

/// Writes a set; null pointers are skipped, and nothing is written if one is not aligned.
fn give(
    elements: (*mut VmElements, &ElementParams),
    fibers: [(*mut VmFiber, &FiberType); 3],
) -> Result<(), VmResult> {
    let place = Place::optional(elements.0)?;
    let [first, second, third] = fibers;
    let places = [Place::optional(first.0)?, Place::optional(second.0)?, Place::optional(third.0)?];
    if let Some(place) = place {
        place.put(elements.1.into());
    }
    for (place, (_, fiber)) in places.into_iter().zip(fibers) {
        if let Some(place) = place {
            place.put(VmFiber::of(fiber));
        }
    }
    Ok(())
}

/// Elements, a slow and a fast fibre type of the paper's table 1 (Song et al. 2008); fractions are
/// one half each. Null pointers are skipped.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_params_paper(
    elements: *mut VmElements,
    slow: *mut VmFiber,
    fast: *mut VmFiber,
) -> VmResult {
    use paper_table_1::{ELEMENTS, FAST, SLOW};
    plain(give(
        (elements, &ELEMENTS),
        [(core::ptr::null_mut(), &SLOW), (slow, &SLOW), (fast, &FAST)],
    ))
}

/// Elements, a super-slow, a slow and a fast fibre type of human muscle, as in Virtual Muscle 4.0;
/// fractions are one half each. Null pointers are skipped.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_params_human(
    elements: *mut VmElements,
    super_slow: *mut VmFiber,
    slow: *mut VmFiber,
    fast: *mut VmFiber,
) -> VmResult {
    use human_vm4::{ELEMENTS, FAST, SLOW, SUPER_SLOW};
    plain(give((elements, &ELEMENTS), [(super_slow, &SUPER_SLOW), (slow, &SLOW), (fast, &FAST)]))
}

/// The same of feline muscle.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_params_feline(
    elements: *mut VmElements,
    super_slow: *mut VmFiber,
    slow: *mut VmFiber,
    fast: *mut VmFiber,
) -> VmResult {
    use feline_vm4::{ELEMENTS, FAST, SLOW, SUPER_SLOW};
    plain(give((elements, &ELEMENTS), [(super_slow, &SUPER_SLOW), (slow, &SLOW), (fast, &FAST)]))
}
