//! Floating point: kernels from `libm`, the same portable code on host and target.

use super::Scalar;
use super::sealed::Sealed;

macro_rules! float {
    ($float:ty, $bits:ty, $exp:path, $exp_m1:path, $ln:path, $ln_1p:path) => {
        impl Sealed for $float {}

        impl Scalar for $float {
            type Bits = $bits;
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;

            fn from_f64(value: f64) -> Self {
                value as Self
            }
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn to_bits(self) -> Self::Bits {
                <$float>::to_bits(self)
            }
            fn from_bits(bits: Self::Bits) -> Self {
                <$float>::from_bits(bits)
            }
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }
            fn exp(self) -> Self {
                $exp(self)
            }
            fn exp_m1(self) -> Self {
                $exp_m1(self)
            }
            fn ln(self) -> Self {
                $ln(self)
            }
            fn ln_1p(self) -> Self {
                $ln_1p(self)
            }
        }
    };
}

float!(f32, u32, libm::expf, libm::expm1f, libm::logf, libm::log1pf);
float!(f64, u64, libm::exp, libm::expm1, libm::log, libm::log1p);
