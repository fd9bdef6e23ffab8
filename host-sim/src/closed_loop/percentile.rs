//! Percentiles of scores.

/// The value that a share of the values is at or below; NaN counts as the greatest.
pub(super) fn percentile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (share * sorted.len() as f64).ceil() as usize;
    sorted[place.clamp(1, sorted.len()) - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values_that_a_share_is_at_or_below() {
        let values: Vec<f64> = (1..=200).rev().map(f64::from).collect();
        assert_eq!(
            [0.0, 0.05, 0.5, 0.95, 1.0].map(|p| percentile(&values, p)),
            [1.0, 10.0, 100.0, 190.0, 200.0]
        );
        assert_eq!(percentile(&[3.0], 0.95), 3.0);
        assert!(percentile(&[1.0, f64::NAN], 0.95).is_nan());
    }
}
