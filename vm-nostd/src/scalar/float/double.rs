//! Kernels in `f64`, from `libm`: with negligible rounding, they show the truncation error alone.

pub(super) fn exp(x: f64) -> f64 {
    libm::exp(x)
}

pub(super) fn ln(x: f64) -> f64 {
    libm::log(x.max(f64::MIN_POSITIVE))
}

/// ln(e^x + 1) and its slope; the relative errors are below 5e-16.
pub(super) fn softplus(x: f64) -> (f64, f64) {
    // One exponential, which cannot overflow.
    let decay = libm::exp(-x.abs());
    let tail = libm::log1p(decay);
    let share = 1.0 / (1.0 + decay);
    if x > 0.0 { (x + tail, share) } else { (tail, decay * share) }
}

/// 1 - e^-e^x; the relative error is below 5e-16.
pub(super) fn weibull(x: f64) -> f64 {
    -libm::expm1(-libm::exp(x.min(MOST)))
}

/// Upper bound of x, against overflow. e^-e^5 is 1e-64, negligible next to 1.
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

pub(super) use one_minus_exp as short_lag_response;
