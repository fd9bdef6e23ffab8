//! Kernels in `f64`, from `libm`: they show the error of the scheme alone.

pub(super) fn exp(x: f64) -> f64 {
    libm::exp(x)
}

pub(super) fn ln(x: f64) -> f64 {
    libm::log(x.max(f64::MIN_POSITIVE))
}

/// ln(e^x + 1) and its slope.
pub(super) fn softplus(x: f64) -> (f64, f64) {
    // One exponential, and no overflow.
    let decay = libm::exp(-x.abs());
    let tail = libm::log1p(decay);
    let share = 1.0 / (1.0 + decay);
    if x > 0.0 { (x + tail, share) } else { (tail, decay * share) }
}

/// 1 - e^-e^x and its slope.
pub(super) fn weibull(x: f64) -> (f64, f64) {
    let power = libm::exp(x.min(MOST));
    let left = libm::exp(-power);
    (-libm::expm1(-power), power * left)
}

/// e^-e^5 is 1e-64: nothing beside 1, and a larger power might overflow.
const MOST: f64 = 5.0;

pub(crate) fn square_root(x: f64) -> f64 {
    libm::sqrt(x)
}

pub(crate) fn tangent(x: f64) -> f64 {
    libm::tan(x)
}

/// 1 - e^-x for x >= 0, accurate near 0.
pub(crate) fn one_minus_exp(x: f64) -> f64 {
    -libm::expm1(-x)
}

pub(super) use one_minus_exp as soon_done;
