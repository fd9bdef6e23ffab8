//! What the arithmetics do differently in C.

use model::{Fixed, Input, Output, Pulse, Scalar};

/// An arithmetic with the types that C has for it.
pub trait Arithmetic: Scalar {
    /// Tells what is in memory apart: 0 to 255.
    const TAG: u32;
    /// Length of a path: m, in fixed point um.
    type Path: Copy;
    /// A number: in fixed point 2^-24.
    type Number: Copy;
    /// A quantity: pps, mA or us; in fixed point 2^-16.
    type Amount: Copy;
    /// Force: N, in fixed point mN.
    type Newtons: Copy;
    /// A word of a saved state.
    type Word: Copy + Into<Self::Bits>;

    /// A path from C.
    fn path_from(path: Self::Path) -> Self::PathLength;
    /// A path for C, in fixed point the nearest um.
    fn path_to(path: Self::PathLength) -> Self::Path;
    /// Shortest and longest path for C, each inside the range.
    fn paths(range: (Self::PathLength, Self::PathLength)) -> (Self::Path, Self::Path);
    /// A number from C, and back.
    fn number_from(number: Self::Number) -> Self;
    /// Back.
    fn number(self) -> Self::Number;
    /// A quantity from C.
    fn amount_from(amount: Self::Amount) -> Self::Quantity;
    /// Back.
    fn amount(quantity: Self::Quantity) -> Self::Amount;
    /// A force from C.
    fn newtons_from(force: Self::Newtons) -> Self::Force;
    /// Back.
    fn newtons(force: Self::Force) -> Self::Newtons;
    /// A word for C.
    fn word(bits: Self::Bits) -> Self::Word;

    /// A pulse from C.
    fn pulse(amplitude: Self::Amount, width: Self::Amount) -> Pulse<Self> {
        Pulse { amplitude: Self::amount_from(amplitude), width: Self::amount_from(width) }
    }
}

/// Floating point has C's types.
macro_rules! floating {
    ($($S:ty: $word:ty, $tag:literal),*) => {
        $(impl Arithmetic for $S {
            const TAG: u32 = $tag;
            type Path = $S;
            type Number = $S;
            type Amount = $S;
            type Newtons = $S;
            type Word = $word;

            fn path_from(path: $S) -> $S {
                path
            }
            fn path_to(path: $S) -> $S {
                path
            }
            fn paths(range: ($S, $S)) -> ($S, $S) {
                range
            }
            fn number_from(number: $S) -> $S {
                number
            }
            fn number(self) -> $S {
                self
            }
            fn amount_from(amount: $S) -> $S {
                amount
            }
            fn amount(quantity: $S) -> $S {
                quantity
            }
            fn newtons_from(force: $S) -> $S {
                force
            }
            fn newtons(force: $S) -> $S {
                force
            }
            fn word(bits: $word) -> $word {
                bits
            }
        })*
    };
}

floating!(f32: u32, 0x32);
#[cfg(feature = "f64")]
floating!(f64: u64, 0x64);

/// Fractional bits of a path in um.
const PATH_BITS: u32 = 9;

impl Arithmetic for Fixed {
    const TAG: u32 = 0x24;
    type Path = i32;
    type Number = i32;
    type Amount = i32;
    type Newtons = i32;
    type Word = u32;

    fn path_from(path: i32) -> Self::PathLength {
        Input::<Fixed>::from_integers(0, path, 0).path_length
    }
    fn path_to(path: Self::PathLength) -> i32 {
        let bits = Self::path_bits(path).cast_signed();
        bits.saturating_add(1 << (PATH_BITS - 1)) >> PATH_BITS
    }
    fn paths(range: (Self::PathLength, Self::PathLength)) -> (i32, i32) {
        // Whole um inside the range.
        let [shortest, longest] =
            [range.0, range.1].map(|path| Self::path_bits(path).cast_signed());
        (-(-shortest >> PATH_BITS), longest >> PATH_BITS)
    }
    fn number_from(number: i32) -> Self {
        Self::from_bits(number)
    }
    fn number(self) -> i32 {
        self.to_bits()
    }
    fn amount_from(amount: i32) -> Self::Quantity {
        Self::Quantity::from_bits(amount)
    }
    fn amount(quantity: Self::Quantity) -> i32 {
        quantity.to_bits()
    }
    fn newtons_from(force: i32) -> i32 {
        force
    }
    fn newtons(force: i32) -> i32 {
        force
    }
    fn word(bits: u32) -> u32 {
        bits
    }
}

/// Inputs of a tick in C.
pub trait InputOf<S: Arithmetic>: Copy {
    /// For the model.
    fn input(self) -> Input<S>;
}

/// Outputs of a tick in C.
pub trait OutputOf<S: Arithmetic> {
    /// From the model.
    fn of(output: Output<S>) -> Self;
}
