//! Operations on values of all fibre types, statement by statement rather than type by type: the
//! results of one type are not waited for while those of another are computed.

use crate::scalar::Scalar;

/// What a function makes of two things of each type.
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
