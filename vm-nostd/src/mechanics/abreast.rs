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

/// The sum over the types of products.
#[inline(always)]
pub(super) fn dot<S: Scalar, const N: usize>(gains: &[S; N], values: [S; N]) -> S {
    let products = zip(gains, &values, |gain, value| *gain * *value);
    products.into_iter().reduce(|sum, product| sum + product).unwrap_or(S::ZERO)
}
