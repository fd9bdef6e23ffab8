//! Coefficients as a sequence of words: summed into a checksum, written out, and read back.

use crate::checksum::Checksum;

/// Where words go.
#[doc(hidden)]
pub trait Sink {
    /// Takes the next word.
    fn add(&mut self, word: u32);
}

impl Sink for Checksum {
    #[inline]
    fn add(&mut self, word: u32) {
        Self::add(self, word);
    }
}

/// Values that are a sequence of words, with all of their bits.
#[doc(hidden)]
pub trait Summed {
    /// Passes on its words.
    fn sum<T: Sink>(&self, sink: &mut T);
}

/// Values that can be read back from their words; their number is fixed.
#[doc(hidden)]
pub trait FromWords: Summed + Copy {
    /// Number of words.
    const WORDS: usize;
    /// Checksum of the names of all fields and of the formats of all numbers, in order.
    const LAYOUT: Checksum;

    /// Reads the words of [`Summed::sum`]. `None` if there are too few, if a number is not finite,
    /// or if a value is out of the range that its type relies on.
    fn read(words: &mut Words<'_>) -> Option<Self>;
}

/// Words that are read one by one.
#[doc(hidden)]
pub struct Words<'a> {
    rest: core::slice::Iter<'a, u32>,
}

impl<'a> Words<'a> {
    pub(crate) fn new(words: &'a [u32]) -> Self {
        Self { rest: words.iter() }
    }

    /// The next word.
    pub(crate) fn next(&mut self) -> Option<u32> {
        self.rest.next().copied()
    }

    /// Number of words that have not been read.
    pub(crate) fn left(&self) -> usize {
        self.rest.len()
    }
}

impl Summed for () {
    fn sum<T: Sink>(&self, _: &mut T) {}
}

impl FromWords for () {
    const WORDS: usize = 0;
    const LAYOUT: Checksum = Checksum::EMPTY;

    fn read(_: &mut Words<'_>) -> Option<Self> {
        Some(())
    }
}

impl<T: Summed, const N: usize> Summed for [T; N] {
    fn sum<W: Sink>(&self, sink: &mut W) {
        self.iter().for_each(|one| one.sum(sink));
    }
}

impl<T: FromWords, const N: usize> FromWords for [T; N] {
    const WORDS: usize = N * T::WORDS;
    const LAYOUT: Checksum = T::LAYOUT.and("[]").and_word(N as u32);

    /// An array without elements is refused: nothing that was built has one.
    fn read(words: &mut Words<'_>) -> Option<Self> {
        if N == 0 {
            return None;
        }
        let mut all = [T::read(words)?; N];
        for one in all.iter_mut().skip(1) {
            *one = T::read(words)?;
        }
        Some(all)
    }
}

/// An absent value has no words: what contains one can be summed but not read.
impl<T: Summed> Summed for Option<T> {
    fn sum<W: Sink>(&self, sink: &mut W) {
        self.iter().for_each(|one| one.sum(sink));
    }
}

/// Makes 32-bit numbers [`Summed`] and [`FromWords`]: from a number to its word and back.
macro_rules! summed_numbers {
    ($($number:ty: |$value:ident| $word:expr, |$read:ident| $back:expr;)*) => {
        $(
            impl $crate::summed::Summed for $number {
                #[inline]
                fn sum<T: $crate::summed::Sink>(&self, sink: &mut T) {
                    let $value = *self;
                    sink.add($word);
                }
            }

            impl $crate::summed::FromWords for $number {
                const WORDS: usize = 1;
                const LAYOUT: $crate::checksum::Checksum =
                    $crate::checksum::Checksum::EMPTY.and(stringify!($number));

                fn read(words: &mut $crate::summed::Words<'_>) -> Option<Self> {
                    let $read = words.next()?;
                    $back
                }
            }
        )*
    };
}
pub(crate) use summed_numbers;

/// A word as a number, if it is finite.
fn finite(word: u32) -> Option<f32> {
    Some(f32::from_bits(word)).filter(|value| value.is_finite())
}

summed_numbers! {
    bool: |value| value.into(), |word| (word < 2).then_some(word == 1);
    u8: |value| value.into(), |word| word.try_into().ok();
    u32: |value| value, |word| Some(word);
    i32: |value| value.cast_unsigned(), |word| Some(word.cast_signed());
    f32: |value| value.to_bits(), |word| finite(word);
}

/// Makes 64-bit numbers [`Summed`] and [`FromWords`].
macro_rules! summed_long_numbers {
    ($($number:ty: |$value:ident| $long:expr, |$read:ident| $back:expr;)*) => {
        $(
            impl Summed for $number {
                #[inline]
                fn sum<T: Sink>(&self, sink: &mut T) {
                    let $value = *self;
                    let long: u64 = $long;
                    sink.add(long as u32);
                    sink.add((long >> 32) as u32);
                }
            }

            impl FromWords for $number {
                const WORDS: usize = 2;
                const LAYOUT: Checksum = Checksum::EMPTY.and(stringify!($number));

                fn read(words: &mut Words<'_>) -> Option<Self> {
                    let low: u64 = words.next()?.into();
                    let $read = low | u64::from(words.next()?) << 32;
                    $back
                }
            }
        )*
    };
}

summed_long_numbers! {
    u64: |value| value, |long| Some(long);
    usize: |value| value as u64, |long| long.try_into().ok();
    f64: |value| value.to_bits(), |long| Some(Self::from_bits(long)).filter(|x| x.is_finite());
}

/// Declares a struct whose fields, in the order of their declaration, are its words. The struct is
/// written as anywhere else; a field cannot be left out. A type parameter without a bound stands
/// for a number or a struct of this kind.
///
/// After the struct may follow `valid: condition`, a function of the struct without which it is
/// refused when it is read (with `where T: Bound` if that needs one), or `sum only` if it cannot be
/// read because a part of it may be absent.
macro_rules! summed {
    // A struct without parameters.
    ($(#[$meta:meta])* $visibility:vis struct $name:ident { $($rest:tt)* } $($after:tt)*) => {
        $crate::summed::summed! {
            @ [$(#[$meta])* $visibility] $name [] [] [] > { $($rest)* } $($after)*
        }
    };
    ($(#[$meta:meta])* $visibility:vis struct $name:ident < $($rest:tt)*) => {
        $crate::summed::summed! { @ [$(#[$meta])* $visibility] $name [] [] [] $($rest)* }
    };
    // Parameters, one by one, into three lists: as declared, with all bounds, and by name.
    (
        @ $head:tt $name:ident [$($declared:tt)*] [$($bound:tt)*] [$($argument:tt)*]
        const $parameter:ident : usize $($rest:tt)*
    ) => {
        $crate::summed::summed! {
            @ $head $name
            [$($declared)* const $parameter: usize,] [$($bound)* const $parameter: usize,]
            [$($argument)* $parameter,] $($rest)*
        }
    };
    (
        @ $head:tt $name:ident [$($declared:tt)*] [$($bound:tt)*] [$($argument:tt)*]
        $parameter:ident : $path:path , $($rest:tt)*
    ) => {
        $crate::summed::summed! {
            @ $head $name [$($declared)* $parameter: $path,] [$($bound)* $parameter: $path,]
            [$($argument)* $parameter,] $($rest)*
        }
    };
    (
        @ $head:tt $name:ident [$($declared:tt)*] [$($bound:tt)*] [$($argument:tt)*]
        $parameter:ident : $path:path > $($rest:tt)*
    ) => {
        $crate::summed::summed! {
            @ $head $name [$($declared)* $parameter: $path,] [$($bound)* $parameter: $path,]
            [$($argument)* $parameter,] > $($rest)*
        }
    };
    (
        @ $head:tt $name:ident [$($declared:tt)*] [$($bound:tt)*] [$($argument:tt)*]
        $parameter:ident $($rest:tt)*
    ) => {
        $crate::summed::summed! {
            @ $head $name [$($declared)* $parameter,]
            [$($bound)* $parameter: $crate::summed::FromWords,]
            [$($argument)* $parameter,] $($rest)*
        }
    };
    (@ $head:tt $name:ident $declared:tt $bound:tt $argument:tt , $($rest:tt)*) => {
        $crate::summed::summed! { @ $head $name $declared $bound $argument $($rest)* }
    };
    // The fields.
    (
        @ [$($head:tt)*] $name:ident [$($declared:tt)*] [$($bound:tt)*] [$($argument:tt)*]
        > {
            $($(#[$meta:meta])* $visibility:vis $field:ident : $type:ty),* $(,)?
        } $($after:tt)*
    ) => {
        $($head)* struct $name<$($declared)*> {
            $($(#[$meta])* $visibility $field: $type,)*
        }

        impl<$($bound)*> $crate::summed::Summed for $name<$($argument)*> {
            fn sum<To: $crate::summed::Sink>(&self, sink: &mut To) {
                $($crate::summed::Summed::sum(&self.$field, sink);)*
            }
        }

        $crate::summed::summed! {
            @read [$($bound)*] [$name<$($argument)*>] [$($field: $type,)*] $($after)*
        }
    };
    (@read $bound:tt $self:tt $fields:tt sum only) => {};
    (
        @read [$($bound:tt)*] [$self:ty] [$($field:ident: $type:ty,)*]
        $(valid: $valid:expr $(, where $parameter:ident: $more:path)?)?
    ) => {
        impl<$($bound)*> $crate::summed::FromWords for $self
        $($(where $parameter: $more)?)?
        {
            const WORDS: usize = 0 $(+ <$type as $crate::summed::FromWords>::WORDS)*;
            const LAYOUT: $crate::checksum::Checksum = $crate::checksum::Checksum::EMPTY
                $(.and(stringify!($field))
                .and_word(<$type as $crate::summed::FromWords>::LAYOUT.value()))*;

            fn read(words: &mut $crate::summed::Words<'_>) -> Option<Self> {
                let read = Self {
                    $($field: <$type as $crate::summed::FromWords>::read(words)?,)*
                };
                $(
                    let valid: fn(&Self) -> bool = $valid;
                    if !valid(&read) {
                        return None;
                    }
                )?
                Some(read)
            }
        }
    };
}
pub(crate) use summed;
