//! `const` elementary functions for tables, accurate to the last few bits of `f64`. Not used in a
//! tick.

/// e^x for -100 <= x <= 100; the relative error is below 3e-13.
pub(super) const fn exp(x: f64) -> f64 {
    // e^x = (e^(x/256))^256; the series converges fast for |x| < 1/2.
    let y = x / 256.0;
    let (mut term, mut sum, mut n) = (1.0, 1.0, 1.0);
    while n < 20.0 {
        term *= y / n;
        sum += term;
        n += 1.0;
    }
    let mut squarings = 0;
    while squarings < 8 {
        sum *= sum;
        squarings += 1;
    }
    sum
}

/// 1 - e^-x for x >= 0, accurate near 0.
pub(super) const fn one_minus_exp(x: f64) -> f64 {
    if x > 0.5 {
        return 1.0 - exp(-x);
    }
    let (mut term, mut sum, mut n) = (x, x, 2.0);
    while n < 20.0 {
        term *= -x / n;
        sum += term;
        n += 1.0;
    }
    sum
}

/// ln(1 + x) for -0.75 <= x <= 1, accurate near 0: 2 artanh(x/(2 + x)).
pub(super) const fn ln_1p(x: f64) -> f64 {
    let z = x / (2.0 + x);
    let (mut power, mut sum, mut n) = (z, 0.0, 1.0);
    while n < 80.0 {
        sum += power / n;
        power *= z * z;
        n += 2.0;
    }
    2.0 * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_agree_with_the_standard_library() {
        for step in -6400..=6400 {
            let x = f64::from(step) / 64.0;
            assert!((exp(x) / x.exp() - 1.0).abs() < 3e-13, "exp {x}");
            let positive = x.abs() + 1e-9;
            assert!((one_minus_exp(positive) / -(-positive).exp_m1() - 1.0).abs() < 1e-13);
            let small = (x / 100.0).max(-0.75);
            let exact = small.ln_1p();
            assert!((ln_1p(small) - exact).abs() <= 1.5e-15 * exact.abs(), "ln_1p {small}");
        }
    }
}
