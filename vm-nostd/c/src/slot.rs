//! Memory owned by C, and what was built in it.

use crate::arithmetic::Arithmetic;
use crate::result::VmResult;
use core::mem::MaybeUninit;

/// What may be in memory.
#[derive(Clone, Copy, Debug)]
pub enum Thing {
    /// A muscle and its state.
    Muscle = 0x4D00,
    /// An inverse.
    Steady = 0x5300,
    /// Fatigue.
    Fatigue = 0x4600,
    /// A recruitment curve.
    Curve = 0x4300,
    /// A joint.
    Joint = 0x4A00,
    /// A prosthesis and its state.
    Prosthesis = 0x5000,
    /// An FES controller and its state.
    Fes = 0x4500,
}

/// Mark of a thing in an arithmetic.
pub const fn mark<S: Arithmetic>(thing: Thing) -> u32 {
    0x564D_0000 | thing as u32 | S::TAG
}

/// Memory for one thing: a mark, and the thing if the mark is set.
#[repr(C, align(8))]
pub struct Slot<T> {
    mark: u32,
    thing: MaybeUninit<T>,
}

impl<T> Slot<T> {
    /// What is put into memory.
    pub fn new(mark: u32, thing: T) -> Self {
        Self { mark, thing: MaybeUninit::new(thing) }
    }

    /// The thing, if there is one with this mark.
    pub fn get(&self, mark: u32) -> Result<&T, VmResult> {
        if self.mark != mark {
            return Err(VmResult::NotBuilt);
        }
        // SAFETY: the mark is written only together with the thing, and tells its type.
        #[allow(unsafe_code)]
        Ok(unsafe { self.thing.assume_init_ref() })
    }

    /// The thing, to be changed.
    pub fn get_mut(&mut self, mark: u32) -> Result<&mut T, VmResult> {
        if self.mark != mark {
            return Err(VmResult::NotBuilt);
        }
        // SAFETY: as above.
        #[allow(unsafe_code)]
        Ok(unsafe { self.thing.assume_init_mut() })
    }
}

/// What memory begins with whose size is chosen when it is built.
#[repr(C, align(8))]
#[derive(Clone, Copy, Debug)]
pub struct Header {
    /// Set together with a muscle; differs by arithmetic.
    pub mark: u32,
    /// VmMode; number of angles of a joint.
    pub mode: u8,
    /// Number of fibre types; of muscles of a joint.
    pub types: u8,
    /// Accuracy class.
    pub class: u8,
    /// 1 as soon as there is a state.
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
    pub fn thing<'a, T>(self) -> &'a mut T {
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

/// The header's sizes have room for what is built, and waste little: 128 bytes for each thing in
/// it that has a size of its own.
pub const fn fits(needed: usize, given: usize, things: usize) {
    assert!(needed <= given, "the model has grown: raise the sizes of the arithmetic's file");
    assert!(given <= needed + 128 * things, "the model has shrunk: lower the sizes");
}
