//! Modes, arithmetics and accuracy classes by name.

use crate::errors::refused;
use host_sim::engine::{Arithmetic, Class, mode_name};
use host_sim::reference::Mode;
use pyo3::PyResult;

const MODES: [Mode; 4] =
    [Mode::Continuous, Mode::Fes, Mode::Discrete, Mode::DiscreteEffectiveLength];
const ARITHMETICS: [Arithmetic; 4] =
    [Arithmetic::F32, Arithmetic::Fixed, Arithmetic::F64, Arithmetic::Reference];

fn named<T: Copy, const N: usize>(
    field: &str,
    given: &str,
    all: [T; N],
    name: impl Fn(T) -> &'static str,
) -> PyResult<T> {
    all.into_iter().find(|&one| name(one) == given).ok_or_else(|| {
        let limit = format!("must be one of {}", all.map(name).join(", "));
        refused(field, given, &limit)
    })
}

/// A recruitment mode.
pub fn mode(name: &str) -> PyResult<Mode> {
    named("mode", name, MODES, mode_name)
}

/// An arithmetic, the reference included.
pub fn arithmetic(name: &str) -> PyResult<Arithmetic> {
    named("arithmetic", name, ARITHMETICS, Arithmetic::name)
}

/// An accuracy class.
pub fn class(name: &str) -> PyResult<Class> {
    named("accuracy_class", name, Class::ALL, Class::name)
}

/// Calls `$body` with the scalar of an arithmetic of the model as the type `$scalar`; the reference
/// is refused.
macro_rules! with_scalar {
    ($arithmetic:expr, $scalar:ident => $body:expr) => {
        match $arithmetic {
            host_sim::engine::Arithmetic::F32 => {
                type $scalar = f32;
                $body
            }
            host_sim::engine::Arithmetic::Fixed => {
                type $scalar = vm_nostd::Fixed;
                $body
            }
            host_sim::engine::Arithmetic::F64 => {
                type $scalar = f64;
                $body
            }
            host_sim::engine::Arithmetic::Reference => {
                Err($crate::errors::refused("arithmetic", "reference", "must be f32, fixed or f64"))
            }
        }
    };
}
pub(crate) use with_scalar;

/// Calls `$body` with a count as a constant `$n`, if it is one of those listed; else the count is
/// refused under the name of `$field`.
macro_rules! with_count {
    ($field:literal, $count:expr, [$($number:literal)+], $n:ident => $body:expr) => {
        match $count {
            $($number => {
                const $n: usize = $number;
                $body
            })+
            count => {
                let limit = concat!("must be one of", $(" ", $number),+);
                Err($crate::errors::refused($field, &count.to_string(), limit))
            }
        }
    };
}
pub(crate) use with_count;
