//! What became of an arm under constant activations: whether its swings die out or grow.

use super::simulation::Moment;
use super::skeleton::Joints;
use vm_nostd::Status;

/// How a joint swings is judged in windows of this length, s.
const WINDOW: f64 = 0.5;
/// From here on, s: before, the arm goes to where its muscles balance.
const SETTLING: f64 = 1.0;
/// A joint that moves less in a window is at rest, degrees: a hundredth of what goniometers tell apart.
const LEAST_SWING: f64 = 0.01;

/// What became of it; pairs are shoulder and elbow.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Angles at the end, degrees.
    pub final_angles: Joints,
    /// The largest swing, from the least to the greatest angle of a window, in the second half of the run,
    /// degrees.
    pub late_swing: Joints,
    /// The fastest growth of the swing from one window to the next, 1/s; negative where it never grows.
    pub growth: Joints,
    /// Energy that is in the arm without a muscle having put it there, as a share of all that muscles
    /// gave and took: the largest over the run.
    pub energy_error: f64,
    /// All flags of all muscles.
    pub status: Status,
}

impl Outcome {
    /// The outcome of a run with ticks of `time_step` (s).
    pub fn of(moments: &[Moment], time_step: f64) -> Self {
        let ticks = |seconds: f64| (seconds / time_step).round() as usize;
        let (window, settling) = (ticks(WINDOW), ticks(SETTLING));
        let judged = moments.get(settling..).unwrap_or_default();
        let swings = |joint: usize| -> Vec<f64> {
            judged.chunks_exact(window).map(|moments| swing(moments, joint)).collect()
        };
        let late = &moments[moments.len() / 2..];
        let turnover = moments.last().map_or(0.0, |moment| moment.turnover);
        let imbalance = moments
            .iter()
            .map(|moment| (moment.kinetic_energy - moment.work).abs())
            .fold(0.0, f64::max);
        Self {
            final_angles: moments
                .last()
                .map_or([f64::NAN; 2], |moment| moment.angles.map(f64::to_degrees)),
            late_swing: [0, 1].map(|joint| {
                late.chunks(window).map(|moments| swing(moments, joint)).fold(0.0, f64::max)
            }),
            growth: [0, 1].map(|joint| fastest_growth(&swings(joint))),
            energy_error: if turnover > 0.0 { imbalance / turnover } else { 0.0 },
            status: moments.iter().fold(Status::empty(), |all, moment| all | moment.status),
        }
    }

    /// Whether no swing grew.
    pub fn settles(&self) -> bool {
        self.growth.iter().all(|&growth| growth <= 0.0)
    }
}

/// From the least to the greatest angle, degrees.
fn swing(moments: &[Moment], joint: usize) -> f64 {
    let (least, most) = moments
        .iter()
        .map(|moment| moment.angles[joint].to_degrees())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), angle| (a.min(angle), b.max(angle)));
    most - least
}

/// The fastest growth from one window's swing to the next one's, 1/s.
fn fastest_growth(swings: &[f64]) -> f64 {
    let rates = swings.windows(2).map(|pair| {
        let [before, after] = [pair[0], pair[1]].map(|swing| swing.max(LEAST_SWING));
        (after / before).ln() / WINDOW
    });
    rates.fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_that_of_the_swings() {
        let exponential: Vec<f64> = (0..8).map(|i| (-0.6 * WINDOW * f64::from(i)).exp()).collect();
        assert!((fastest_growth(&exponential) + 0.6).abs() < 1e-12);
        let bursting = [1.0, 0.3, 0.1, 0.1 * (2.0 * WINDOW).exp(), 0.01];
        assert!((fastest_growth(&bursting) - 2.0).abs() < 1e-12);
        assert!(fastest_growth(&[1.0, 1e-4, 2e-4, 5e-3]) <= 0.0, "at rest, whatever rounding does");
    }
}
