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

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from -40 to 40.
    fn numbers() -> impl Iterator<Item = f64> {
        (-40_000..=40_000).map(|step| f64::from(step) * 1e-3)
    }

    #[test]
    fn softplus_and_its_slope_have_a_relative_error_below_5e_16() {
        for x in numbers() {
            let (value, slope) = softplus(x);
            let (exact, logistic) = (x.exp().ln_1p(), 1.0 / (1.0 + (-x).exp()));
            assert!((value / exact - 1.0).abs() <= 5e-16, "{x}: {value} {exact}");
            assert!((slope / logistic - 1.0).abs() <= 5e-16, "{x}: {slope} {logistic}");
        }
    }

    #[test]
    fn weibull_is_within_the_bound_of_f64() {
        for x in numbers() {
            let power = x.exp();
            let (value, exact) = (weibull(x), -(-power).exp_m1());
            assert!((value / exact - 1.0).abs() <= 5e-16, "{x}: {value} {exact}");
        }
    }
}
