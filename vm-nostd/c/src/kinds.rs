//! Modes, numbers of fibre types, and the muscle of each.

use crate::arithmetic::Arithmetic;
use crate::units::VmUnits;
#[cfg(feature = "units")]
use model::{EffectiveLength, FascicleLength, MotorUnits, NaturalDiscrete};
use model::{
    IntramuscularFes, Limit, Muscle, NaturalContinuous, ParameterError, Recruitment, State,
};

/// How a muscle is recruited.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VmMode {
    /// Natural continuous recruitment.
    Continuous = 0,
    /// Intramuscular FES.
    Fes = 1,
    /// Natural discrete recruitment, motor unit by motor unit; library feature `units`.
    Discrete = 2,
    /// The same with an effective length of each unit; library feature `units`.
    EffectiveLength = 3,
}

/// Mode of a number, if this library has it.
pub(crate) fn mode_of(mode: u32) -> Result<VmMode, ParameterError> {
    match mode {
        0 => Ok(VmMode::Continuous),
        1 => Ok(VmMode::Fes),
        2 if cfg!(feature = "units") => Ok(VmMode::Discrete),
        3 if cfg!(feature = "units") => Ok(VmMode::EffectiveLength),
        other => {
            let most = if cfg!(feature = "units") { 3.0 } else { 1.0 };
            let limit = Limit::Within { least: 0.0, most };
            Err(ParameterError { field: "mode", fiber: None, value: other.into(), limit })
        }
    }
}

/// A muscle and its state.
pub struct Held<S: Arithmetic, R: Recruitment<S, N>, const N: usize> {
    pub muscle: Muscle<S, R, N>,
    pub state: State<S, R, N>,
}

/// A mode, with what C says of its motor units.
pub trait Mode<S: Arithmetic, const N: usize>: Recruitment<S, N> + Sized {
    /// Motor units of a muscle.
    fn units(
        params: &model::MuscleParams<N>,
        units: Option<&VmUnits>,
    ) -> Result<Self::Units, crate::result::Refusal>;

    /// Static stiffness; none with motor units.
    fn stiffness(held: &Held<S, Self, N>) -> Option<S>;
}

macro_rules! of_types {
    ($($mode:ty),*) => {
        $(impl<S: Arithmetic, const N: usize> Mode<S, N> for $mode {
            fn units(
                _: &model::MuscleParams<N>,
                _: Option<&VmUnits>,
            ) -> Result<(), crate::result::Refusal> {
                Ok(())
            }
            fn stiffness(held: &Held<S, Self, N>) -> Option<S> {
                Some(held.muscle.stiffness(&held.state))
            }
        })*
    };
}
of_types!(NaturalContinuous, IntramuscularFes);

/// Capacity of a muscle of motor units.
#[cfg(feature = "units")]
const UNITS: usize = crate::units::VM_MAX_UNITS;

/// Discrete recruitment, with the fascicles' length.
#[cfg(feature = "units")]
pub type Discrete = NaturalDiscrete<FascicleLength, UNITS>;
/// The same, with an effective length of each unit.
#[cfg(feature = "units")]
pub type Effective = NaturalDiscrete<EffectiveLength, UNITS>;

#[cfg(feature = "units")]
macro_rules! of_units {
    ($($mode:ty),*) => {
        $(impl<S: Arithmetic, const N: usize> Mode<S, N> for $mode {
            fn units(
                params: &model::MuscleParams<N>,
                units: Option<&VmUnits>,
            ) -> Result<MotorUnits<UNITS>, crate::result::Refusal> {
                crate::units::motor_units(params, units)
            }
            fn stiffness(_: &Held<S, Self, N>) -> Option<S> {
                None
            }
        })*
    };
}
#[cfg(feature = "units")]
of_units!(Discrete, Effective);

/// Calls `$call::<S, N>` (or `$call::<N>`) for a number of types; `$none` if this library does not
/// have it.
macro_rules! by_types {
    ($types:expr, $none:expr, $call:ident $(::<$($S:ty),+>)?, ($($argument:expr),*)) => {
        match $types {
            2 => $call::<$($($S,)+)? 2>($($argument),*),
            #[cfg(feature = "types")]
            1 => $call::<$($($S,)+)? 1>($($argument),*),
            #[cfg(feature = "types")]
            3 => $call::<$($($S,)+)? 3>($($argument),*),
            #[cfg(feature = "types")]
            4 => $call::<$($($S,)+)? 4>($($argument),*),
            #[cfg(feature = "types")]
            5 => $call::<$($($S,)+)? 5>($($argument),*),
            #[cfg(feature = "types")]
            6 => $call::<$($($S,)+)? 6>($($argument),*),
            _ => $none,
        }
    };
}
pub(crate) use by_types;

/// Calls a macro for each number of types of this library.
macro_rules! each_number_of_types {
    ($each:ident) => {
        $each!(2);
        #[cfg(feature = "types")]
        {
            $each!(1);
            $each!(3);
            $each!(4);
            $each!(5);
            $each!(6);
        }
    };
}
pub(crate) use each_number_of_types;

/// Calls `$call::<S, mode, N>` for a mode and a number of types; `$none` if this library does not
/// have it.
macro_rules! by_kind {
    ($types:expr, $mode:expr, $none:expr, $call:ident::<$S:ty>, $arguments:tt) => {
        match $types {
            2 => $crate::kinds::by_mode!(2, $mode, $none, $call::<$S>, $arguments),
            #[cfg(feature = "types")]
            1 => $crate::kinds::by_mode!(1, $mode, $none, $call::<$S>, $arguments),
            #[cfg(feature = "types")]
            3 => $crate::kinds::by_mode!(3, $mode, $none, $call::<$S>, $arguments),
            #[cfg(feature = "types")]
            4 => $crate::kinds::by_mode!(4, $mode, $none, $call::<$S>, $arguments),
            #[cfg(feature = "types")]
            5 => $crate::kinds::by_mode!(5, $mode, $none, $call::<$S>, $arguments),
            #[cfg(feature = "types")]
            6 => $crate::kinds::by_mode!(6, $mode, $none, $call::<$S>, $arguments),
            _ => $none,
        }
    };
}
pub(crate) use by_kind;

/// The same for one number of types.
macro_rules! by_mode {
    ($N:literal, $mode:expr, $none:expr, $call:ident::<$S:ty>, ($($argument:expr),*)) => {
        match $mode {
            0 => $call::<$S, model::NaturalContinuous, $N>($($argument),*),
            1 => $call::<$S, model::IntramuscularFes, $N>($($argument),*),
            #[cfg(feature = "units")]
            2 => $call::<$S, $crate::kinds::Discrete, $N>($($argument),*),
            #[cfg(feature = "units")]
            3 => $call::<$S, $crate::kinds::Effective, $N>($($argument),*),
            _ => $none,
        }
    };
}
pub(crate) use by_mode;
