//! Pointers from C, checked for null and alignment before anything is read or written.

use crate::result::VmResult;
use core::mem::MaybeUninit;

/// A pointer that may be used, or why not.
fn checked<T>(pointer: *const T) -> Result<(), VmResult> {
    if pointer.is_null() {
        return Err(VmResult::NullPointer);
    }
    if pointer.is_aligned() { Ok(()) } else { Err(VmResult::Alignment) }
}

/// What an input has.
pub fn read<T: Copy>(pointer: *const T) -> Result<T, VmResult> {
    checked(pointer)?;
    // SAFETY: aligned and not null; the caller of C promises that there is a T, which has no
    // invalid bits.
    #[allow(unsafe_code)]
    Ok(unsafe { pointer.read() })
}

/// A place for an output. Nothing is read from it, so that two outputs may share a place.
pub struct Place<T>(*mut T);

impl<T> Place<T> {
    /// Checks the pointer, before anything is changed.
    pub fn new(pointer: *mut T) -> Result<Self, VmResult> {
        checked(pointer).map(|()| Self(pointer))
    }

    /// The same, none for a null pointer.
    pub fn optional(pointer: *mut T) -> Result<Option<Self>, VmResult> {
        if pointer.is_null() { Ok(None) } else { Self::new(pointer).map(Some) }
    }

    /// Writes the output.
    pub fn put(self, value: T) {
        // SAFETY: checked by `new`; the caller of C promises that it may be written.
        #[allow(unsafe_code)]
        unsafe {
            self.0.write(value);
        }
    }
}

/// What C owns, for the time of a call.
pub fn borrow<'a, T>(pointer: *const T) -> Result<&'a T, VmResult> {
    checked(pointer)?;
    // SAFETY: as above; the reference ends before the exported function returns.
    #[allow(unsafe_code)]
    Ok(unsafe { &*pointer })
}

/// The same, to be changed.
pub fn borrow_mut<'a, T>(pointer: *mut T) -> Result<&'a mut T, VmResult> {
    checked(pointer)?;
    // SAFETY: as above; no other reference to it exists, because inputs are copied and outputs are
    // only written.
    #[allow(unsafe_code)]
    Ok(unsafe { &mut *pointer })
}

/// `count` elements, for the time of a call.
pub fn slice<'a, T>(pointer: *const T, count: usize) -> Result<&'a [T], VmResult> {
    checked(pointer)?;
    if count.checked_mul(size_of::<T>()).is_none_or(|bytes| bytes > isize::MAX as usize) {
        return Err(VmResult::Size);
    }
    // SAFETY: as above, for `count` elements.
    #[allow(unsafe_code)]
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// `count` places, not read.
pub fn places<'a, T>(pointer: *mut T, count: usize) -> Result<&'a mut [MaybeUninit<T>], VmResult> {
    checked(pointer)?;
    if count.checked_mul(size_of::<T>()).is_none_or(|bytes| bytes > isize::MAX as usize) {
        return Err(VmResult::Size);
    }
    // SAFETY: as above, for `count` elements.
    #[allow(unsafe_code)]
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer.cast(), count) })
}
