//! Memory owned by C, and what was built in it.

use crate::result::VmResult;
use core::mem::MaybeUninit;

/// Memory for one thing: a mark, and the thing if the mark is set. `MARK` differs by thing and
/// arithmetic.
#[repr(C, align(8))]
pub struct Slot<T, const MARK: u32> {
    mark: u32,
    thing: MaybeUninit<T>,
}

impl<T, const MARK: u32> Slot<T, MARK> {
    /// What is put into memory.
    pub fn new(thing: T) -> Self {
        Self { mark: MARK, thing: MaybeUninit::new(thing) }
    }

    /// The thing, if there is one.
    pub fn get(&self) -> Result<&T, VmResult> {
        if self.mark != MARK {
            return Err(VmResult::NotBuilt);
        }
        // SAFETY: the mark is written only together with the thing.
        #[allow(unsafe_code)]
        Ok(unsafe { self.thing.assume_init_ref() })
    }

    /// The thing, to be changed.
    pub fn get_mut(&mut self) -> Result<&mut T, VmResult> {
        if self.mark != MARK {
            return Err(VmResult::NotBuilt);
        }
        // SAFETY: as above.
        #[allow(unsafe_code)]
        Ok(unsafe { self.thing.assume_init_mut() })
    }
}

/// What a muscle's memory begins with.
#[repr(C, align(8))]
#[derive(Clone, Copy, Debug)]
pub struct Header {
    /// Set together with a muscle; differs by arithmetic.
    pub mark: u32,
    /// VmMode.
    pub mode: u8,
    /// Number of fibre types.
    pub types: u8,
    /// Accuracy class.
    pub class: u8,
    /// 1 as soon as the muscle has a state.
    pub rested: u8,
}

/// A muscle's memory: the header, then the muscle.
#[derive(Clone, Copy)]
pub struct Memory(*mut Header);

impl Memory {
    /// Memory that may be used.
    pub fn new<T>(pointer: *mut T) -> Result<Self, VmResult> {
        let header = pointer.cast::<Header>();
        crate::pointer::borrow::<Header>(header)?;
        Ok(Self(header))
    }

    /// What it says of itself, if it has the `mark`.
    pub fn header(self, mark: u32) -> Result<Header, VmResult> {
        let header = crate::pointer::read(self.0)?;
        if header.mark == mark { Ok(header) } else { Err(VmResult::NotBuilt) }
    }

    /// Writes a muscle. The memory has at least [`bytes`] for it.
    pub fn put<T>(self, header: Header, muscle: T) {
        // SAFETY: the pointer is aligned to 8 bytes, and its size was compared with `bytes`.
        #[allow(unsafe_code)]
        unsafe {
            self.0.write(header);
            self.0.add(1).cast::<T>().write(muscle);
        }
    }

    /// Marks that the muscle has a state.
    pub fn rested(self, header: Header) {
        // SAFETY: as above.
        #[allow(unsafe_code)]
        unsafe {
            self.0.write(Header { rested: 1, ..header });
        }
    }

    /// The muscle that the header says is here.
    pub fn muscle<'a, T>(self) -> &'a mut T {
        // SAFETY: the header has the arithmetic's mark, and its mode and number of types have
        // chosen T, as when it was written. No other reference exists during a call.
        #[allow(unsafe_code)]
        unsafe {
            &mut *self.0.add(1).cast::<T>()
        }
    }
}

/// Bytes of memory that a muscle needs.
pub const fn bytes<T>() -> usize {
    assert!(align_of::<T>() <= 8);
    (size_of::<Header>() + size_of::<T>()).next_multiple_of(8)
}
