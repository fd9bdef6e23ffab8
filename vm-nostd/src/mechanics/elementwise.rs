//! Element-wise operations on arrays with one value per fibre type. Computing each step for all
//! types before the next step keeps the pipeline busy: the types do not depend on each other.

use crate::scalar::Scalar;

/// Applies a function to the two values of each type.
#[inline(always)]
pub(super) fn zip<A, B, T, const N: usize>(
    first: &[A; N],
    second: &[B; N],
    both: impl Fn(&A, &B) -> T,
) -> [T; N] {
    core::array::from_fn(|index| both(&first[index], &second[index]))
}

/// The sum over the types.
#[inline(always)]
pub(super) fn sum<S: Scalar, const N: usize>(values: &[S; N]) -> S {
    values.iter().copied().reduce(|sum, value| sum + value).unwrap_or(S::ZERO)
}
