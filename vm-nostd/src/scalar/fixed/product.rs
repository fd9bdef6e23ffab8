//! 32 x 32 to 64-bit products.
//!
//! ARMv6-M (Cortex-M0, M0+) has 32-bit products only. Four products of half words are faster there
//! than the compiler's routine for 64-bit factors.

/// Whether the core lacks UMULL and SMULL. Stable Rust has no `cfg` for that, but one for atomic
/// read-modify-write, which the same Arm cores lack.
const HALVES: bool = cfg!(all(target_arch = "arm", not(target_has_atomic = "32")));

/// Signed product: at most 2^62.
#[inline(always)]
pub(super) fn signed(a: i32, b: i32) -> i64 {
    if HALVES { words(signed_by_halves(a, b)) } else { i64::from(a) * i64::from(b) }
}

/// Product of a signed and an unsigned number: below 2^63 in magnitude.
#[inline(always)]
pub(super) fn mixed(a: i32, b: u32) -> i64 {
    if HALVES { words(mixed_by_halves(a, b)) } else { i64::from(a) * i64::from(b) }
}

/// Unsigned product.
#[inline(always)]
pub(super) fn unsigned(a: u32, b: u32) -> u64 {
    if HALVES { words(unsigned_by_halves(a, b)) as u64 } else { u64::from(a) * u64::from(b) }
}

/// Joins a high and a low word.
#[inline(always)]
fn words((high, low): (u32, u32)) -> i64 {
    (u64::from(high) << 32 | u64::from(low)) as i64
}

/// # Scaling and overflow
/// A high half is at least -2^15 and a low half below 2^16: their product plus 2^16 - 1 fits in a
/// signed 32-bit word. The high word is exact: it is that of the 64-bit product, modulo 2^32.
#[inline(never)]
fn signed_by_halves(a: i32, b: i32) -> (u32, u32) {
    let [(a_low, a_high), (b_low, b_high)] = [a, b].map(|x| (x & 0xFFFF, x >> 16));
    let low = (a_low as u32).wrapping_mul(b_low as u32);
    let cross = a_low * b_high + (low >> 16) as i32;
    let other = a_high * b_low + (cross & 0xFFFF);
    let high = a_high * b_high + (cross >> 16) + (other >> 16);
    (high as u32, (other as u32) << 16 | (low & 0xFFFF))
}

/// # Scaling and overflow
/// As in [`signed_by_halves`]; the product of two unsigned halves plus 2^16 - 1 fits in an unsigned
/// 32-bit word.
#[inline(never)]
fn mixed_by_halves(a: i32, b: u32) -> (u32, u32) {
    let (a_low, a_high) = (a as u32 & 0xFFFF, a >> 16);
    let (b_low, b_high) = (b & 0xFFFF, b >> 16);
    let low = a_low * b_low;
    let cross = a_low * b_high + (low >> 16);
    let other = a_high * b_low as i32 + (cross & 0xFFFF) as i32;
    let high = a_high * b_high as i32 + (cross >> 16) as i32 + (other >> 16);
    (high as u32, (other as u32) << 16 | (low & 0xFFFF))
}

/// # Scaling and overflow
/// The product of two halves plus 2^16 - 1 fits in an unsigned 32-bit word.
#[inline(never)]
fn unsigned_by_halves(a: u32, b: u32) -> (u32, u32) {
    let [(a_low, a_high), (b_low, b_high)] = [a, b].map(|x| (x & 0xFFFF, x >> 16));
    let low = a_low * b_low;
    let cross = a_low * b_high + (low >> 16);
    let other = a_high * b_low + (cross & 0xFFFF);
    (a_high * b_high + (cross >> 16) + (other >> 16), other << 16 | (low & 0xFFFF))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_by_halves_are_exact() {
        let mut numbers: Vec<u32> =
            vec![0, 1, 2, 0xFFFF, 0x1_0000, 0x1_0001, 0x7FFF_FFFF, 0x8000_0000, 0x8000_FFFF];
        numbers.extend(numbers.clone().iter().map(|n| !n));
        let mut state = 1_u64;
        numbers.extend((0..2000).map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 32) as u32 >> (state >> 27 & 31)
        }));
        for (a, b) in numbers.iter().flat_map(|a| numbers.iter().map(move |b| (*a, *b))) {
            let (sa, sb) = (a as i32, b as i32);
            assert_eq!(words(signed_by_halves(sa, sb)), i64::from(sa) * i64::from(sb), "{sa} {sb}");
            assert_eq!(words(mixed_by_halves(sa, b)), i64::from(sa) * i64::from(b), "{sa} {b}");
            let unsigned = words(unsigned_by_halves(a, b)) as u64;
            assert_eq!(unsigned, u64::from(a) * u64::from(b), "{a} {b}");
        }
    }
}
