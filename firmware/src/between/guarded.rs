//! A value with its checksum: a flipped bit becomes a fault before it becomes a current.
//!
//! It is made where a value is known to be correct (after the frame's CRC, after validation) and
//! checked at every use.

use vm_nostd::Checksum;

/// Values with a checksum over all bits that matter.
pub trait Sum {
    /// Adds all of its bits.
    fn sum(&self, checksum: &mut Checksum);
}

impl<T: Sum> Sum for Option<T> {
    fn sum(&self, checksum: &mut Checksum) {
        checksum.add(self.is_some().into());
        self.iter().for_each(|value| value.sum(checksum));
    }
}

impl<T: Sum, const N: usize> Sum for [T; N] {
    fn sum(&self, checksum: &mut Checksum) {
        self.iter().for_each(|value| value.sum(checksum));
    }
}

/// A value with the checksum of its construction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Guarded<T> {
    value: T,
    sum: u32,
}

impl<T: Sum> Guarded<T> {
    /// Guards a value.
    pub fn new(value: T) -> Self {
        let sum = sum_of(&value);
        Self { value, sum }
    }

    /// A flipped bit, for tests.
    #[cfg(test)]
    pub(crate) fn corrupt(&mut self, change: impl FnOnce(&mut T)) {
        change(&mut self.value);
    }

    /// The value; none if its checksum fails.
    pub fn get(&self) -> Option<&T> {
        (sum_of(&self.value) == self.sum).then_some(&self.value)
    }
}

/// Initial value: a value of zeros has no checksum of 0.
fn sum_of(value: &impl Sum) -> u32 {
    let mut checksum = Checksum::EMPTY;
    checksum.add(1);
    value.sum(&mut checksum);
    checksum.value()
}

#[cfg(test)]
mod tests {
    use super::{Guarded, Sum};
    use vm_nostd::Checksum;

    struct Words([u32; 2]);

    impl Sum for Words {
        fn sum(&self, checksum: &mut Checksum) {
            self.0.iter().for_each(|&word| checksum.add(word));
        }
    }

    #[test]
    fn every_bit_that_flips_is_seen() {
        for place in 0..2 {
            for bit in 0..32 {
                let mut guarded = Guarded::new(Words([0, 0xdead_beef]));
                assert!(guarded.get().is_some());
                guarded.value.0[place] ^= 1 << bit;
                assert!(guarded.get().is_none(), "bit {bit} of word {place}");
            }
        }
        let mut guarded = Guarded::new(Some(Words([0; 2])));
        guarded.value = None;
        assert!(guarded.get().is_none(), "a value that is gone");
        for bit in 0..32 {
            let mut guarded = Guarded::new(Words([1, 2]));
            guarded.sum ^= 1 << bit;
            assert!(guarded.get().is_none(), "bit {bit} of the sum");
        }
    }
}
