//! Outcomes as results for C.

use crate::pointer::Place;
use crate::result::{Refusal, VmError, VmResult};

/// Result for C, with details in `error` unless it is null.
pub fn told(outcome: Result<(), Refusal>, error: *mut VmError) -> VmResult {
    let Err(refusal) = outcome else { return VmResult::Ok };
    let (result, details) = match refusal {
        Refusal::Result(result) => (result, None),
        Refusal::Parameter(refused) => {
            let details = VmError::from(refused.error).of_muscle(refused.muscle);
            (VmResult::Parameter, Some(details))
        }
        Refusal::Size { size, needed } => (VmResult::Size, Some(VmError::size(size, needed))),
        Refusal::Words(error) => (VmResult::Words, Some(error.into())),
    };
    // A place that cannot be written was refused before.
    if let (Ok(place), Some(details)) = (Place::new(error), details) {
        place.put(details);
    }
    result
}

/// Result for C.
pub fn plain(outcome: Result<(), VmResult>) -> VmResult {
    outcome.err().unwrap_or(VmResult::Ok)
}
