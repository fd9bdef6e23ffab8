//! A value with its checksum, so that a bit that memory has lost is a fault before it is a current.
//!
//! Made where a value is known to be right (a frame's checksum was good, a limit was validated), and looked at
//! wherever it is used, however many queues are between.

use vm_nostd::Checksum;

/// What can be summed, every bit that matters.
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

/// A value, and its checksum when it was put here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Guarded<T> {
    value: T,
    sum: u32,
}

impl<T: Sum> Guarded<T> {
    /// Guards a value from now on.
    pub fn new(value: T) -> Self {
        let sum = sum_of(&value);
        Self { value, sum }
    }

    /// What memory does to a value.
    #[cfg(test)]
    pub(crate) fn corrupt(&mut self, change: impl FnOnce(&mut T)) {
        change(&mut self.value);
    }

    /// The value; none if memory has lost a bit of it.
    pub fn get(&self) -> Option<&T> {
        (sum_of(&self.value) == self.sum).then_some(&self.value)
    }
}

/// Never that of memory that was erased: not 0 for a value of zeros.
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
