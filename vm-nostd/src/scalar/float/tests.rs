//! Roots of force balances in floating point: signs, and extreme numbers.

use super::*;

/// Calls `check` with residual, line, steepness and half_curvature over the ranges of valid
/// muscles.
fn over_balances(check: impl Fn(f64, f64, f64, f64)) {
    for line in [2e-3, 0.05, 1.0, 50.0] {
        for steepness in [1e-5, 0.02, 1.0, 30.0] {
            for bend in [-3.0, -0.2, 0.0, 0.3, 20.0] {
                for step in -500..=500 {
                    check(f64::from(step) * 0.01, line, steepness, -bend * steepness);
                }
            }
        }
    }
}

#[test]
fn roots_cancel_the_residual_on_the_branch_through_0() {
    over_balances(|residual, line, steepness, half_curvature| {
        let (inertia, viscosity) = (0.3, 0.01);
        let found = residual.hyperbola_root(line, steepness, half_curvature, inertia, viscosity);
        let root = found.root;
        let below = 1.0 - half_curvature / steepness * root;
        assert!(below > 0.0, "{residual} {line} {steepness} {half_curvature}: {root}");
        let secant = steepness / below;
        let error = residual + line * root + secant * root;
        assert!(error.abs() <= 1e-6 * residual.abs(), "{root}: {error} of {residual}");
        let damping = viscosity + secant;
        assert!((found.reciprocal * (inertia + damping) - 1.0).abs() < 1e-4, "{found:?}");
        assert!((found.damped - damping / (inertia + damping)).abs() < 1e-4, "{found:?}");
    });
}

#[test]
fn balances_of_extreme_numbers_are_finite() {
    let any = [0.0, 1e-30, 1e-8, 1e-3, 1.0, 30.0, 1e4, 1e7_f32];
    for residual in any.into_iter().flat_map(|x| [x, -x]) {
        for half_curvature in any.into_iter().flat_map(|x| [x, -x]) {
            for (line, steepness) in
                any[3..7].iter().flat_map(|line| [3e-6, 1e-2, 3.0, 1e3].map(|s| (*line, s)))
            {
                let found = residual.hyperbola_root(line, steepness, half_curvature, 1e-3, 0.0);
                let what = format!("{residual} {line} {steepness} {half_curvature}: {found:?}");
                assert!(found.root.is_finite() && found.root * residual <= 0.0, "{what}");
                assert!((0.0..=1.000_001).contains(&found.damped), "{what}");
                assert!(found.reciprocal >= 0.0 && found.reciprocal.is_finite(), "{what}");
            }
        }
    }
}
