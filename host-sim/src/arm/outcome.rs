//! Outcome of an arm run: do its oscillations decay?

use super::data::Arm;
use super::simulation::Moment;
use super::skeleton::Joints;
use vm_nostd::Status;

/// Window in which the amplitude of a joint is measured, s.
const WINDOW: f64 = 0.5;
/// Start of the first window, s: the arm moves to its equilibrium before.
const SETTLING: f64 = 1.0;
/// Least number of windows, half of them early and half late.
const FEWEST: usize = 4;
/// A joint that moves less in a window is at rest, degrees: 1/100 of a goniometer's resolution.
const LEAST_SWING: f64 = 0.01;
/// An oscillation decays if its late amplitude is less than this share of the early one.
const LEFT: f64 = 0.5;

/// Outcome of a run; pairs are shoulder and elbow.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Angles at the end, degrees.
    pub final_angles: Joints,
    /// Early and late amplitudes; none if the run is too short.
    pub swings: Option<Swings>,
    /// Period of the elbow's oscillation in the second half of the run, s; `None` if there is none.
    pub period: Option<f64>,
    /// An angle left the range of its joint, where paths may be clipped.
    pub out_of_range: bool,
    /// Largest energy error over the run: kinetic energy minus work of the muscles, as a share of
    /// all work done and absorbed.
    pub energy_error: f64,
    /// All flags of all muscles.
    pub status: Status,
}

/// Largest peak-to-peak angles of a window, degrees.
#[derive(Clone, Copy, Debug)]
pub struct Swings {
    /// First half of the time after 1 s.
    pub early: Joints,
    /// Second half.
    pub late: Joints,
    /// Duration of each half, s.
    half: f64,
}

impl Swings {
    /// Growth rate of the amplitude from the early to the late half, 1/s; negative if it decays. A
    /// joint at rest counts as 0.01 degrees.
    pub fn growth(&self) -> Joints {
        [0, 1].map(|joint| {
            let [early, late] =
                [self.early, self.late].map(|swings| at_least(swings[joint], LEAST_SWING));
            (late / early).ln() / self.half
        })
    }

    /// Whether both joints settle.
    pub fn settle(&self) -> bool {
        (0..2).all(|joint| {
            self.late[joint] <= LEAST_SWING || self.late[joint] <= LEFT * self.early[joint]
        })
    }
}

/// Maximum; NaN if the first is NaN.
fn at_least(value: f64, least: f64) -> f64 {
    if value < least { least } else { value }
}

impl Outcome {
    /// The outcome of a run with ticks of `time_step` (s).
    pub fn of(arm: &Arm, moments: &[Moment], time_step: f64) -> Self {
        let turnover = moments.last().map_or(0.0, |moment| moment.turnover);
        let imbalance = moments
            .iter()
            .map(|moment| (moment.kinetic_energy - moment.work).abs())
            .fold(0.0, f64::max);
        let inside = |moment: &Moment| {
            (0..2).all(|joint| {
                (arm.least_angles[joint]..=arm.greatest_angles[joint])
                    .contains(&moment.angles[joint])
            })
        };
        Self {
            final_angles: moments
                .last()
                .map_or([f64::NAN; 2], |moment| moment.angles.map(f64::to_degrees)),
            swings: swings(moments, time_step),
            period: period(&moments[moments.len() / 2..], 1),
            out_of_range: !moments.iter().all(inside),
            energy_error: if turnover > 0.0 { imbalance / turnover } else { 0.0 },
            status: moments.iter().fold(Status::empty(), |all, moment| all | moment.status),
        }
    }
}

fn swings(moments: &[Moment], time_step: f64) -> Option<Swings> {
    let ticks = |seconds: f64| (seconds / time_step).round() as usize;
    let windows: Vec<Joints> = moments
        .get(ticks(SETTLING)..)?
        .chunks_exact(ticks(WINDOW).max(1))
        .map(|window| [0, 1].map(|joint| swing(window, joint)))
        .collect();
    if windows.len() < FEWEST {
        return None;
    }
    let (early, late) = windows.split_at(windows.len() / 2);
    let largest = |windows: &[Joints]| {
        [0, 1].map(|joint| windows.iter().fold(0.0, |most, window| at_least(window[joint], most)))
    };
    let half = 0.5 * windows.len() as f64 * WINDOW;
    Some(Swings { early: largest(early), late: largest(late), half })
}

/// Period of an oscillation, s: median time between upward crossings of its middle; `None` with
/// fewer than two crossings or at rest. The median is robust against single missing cycles.
fn period(moments: &[Moment], joint: usize) -> Option<f64> {
    let angle = |moment: &Moment| moment.angles[joint].to_degrees();
    let (least, most) = moments
        .iter()
        .map(angle)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), angle| (a.min(angle), b.max(angle)));
    let (low, high) = (least + 0.25 * (most - least), least + 0.75 * (most - least));
    // A crossing counts only after the angle was low again: small oscillations about the middle are
    // ignored.
    let mut was_low = false;
    let mut ups = Vec::new();
    for moment in moments {
        let angle = angle(moment);
        if angle < low {
            was_low = true;
        } else if was_low && angle > high {
            was_low = false;
            ups.push(moment.time);
        }
    }
    let swings = most - least > LEAST_SWING;
    let mut intervals: Vec<f64> = ups.windows(2).map(|pair| pair[1] - pair[0]).collect();
    intervals.sort_by(f64::total_cmp);
    swings.then(|| intervals.get(intervals.len() / 2).copied()).flatten()
}

/// Peak-to-peak angle, degrees; NaN if any angle is.
fn swing(moments: &[Moment], joint: usize) -> f64 {
    let angles = || moments.iter().map(|moment| moment.angles[joint].to_degrees());
    let (least, most) = angles()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), angle| (a.min(angle), b.max(angle)));
    if angles().all(f64::is_finite) { most - least } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(time: f64, elbow: impl Fn(f64) -> f64) -> Moment {
        Moment {
            time,
            angles: [0.0, elbow(time).to_radians()],
            velocities: [0.0; 2],
            forces: Vec::new(),
            kinetic_energy: 0.0,
            work: 0.0,
            turnover: 0.0,
            status: Status::empty(),
        }
    }

    /// A run of 5 s: the shoulder rests, the elbow follows a function of time (degrees).
    fn judged(elbow: impl Fn(f64) -> f64) -> Swings {
        let moments: Vec<Moment> =
            (0..=500).map(|tick| moment(f64::from(tick) * 0.01, &elbow)).collect();
        assert!(swings(&moments[..=290], 0.01).is_none(), "too short to be judged");
        swings(&moments, 0.01).expect("long enough")
    }

    #[test]
    fn the_period_is_that_of_whole_cycles() {
        let run = |elbow: &dyn Fn(f64) -> f64| -> Option<f64> {
            let moments: Vec<Moment> =
                (0..=3000).map(|tick| moment(f64::from(tick) * 0.01, elbow)).collect();
            period(&moments, 1)
        };
        let found = run(&|t| (t * std::f64::consts::TAU / 2.4).sin()).expect("a period");
        assert!((found - 2.4).abs() < 0.01, "{found}");
        // A small, faster oscillation on top has no effect.
        let found = run(&|t| (t * std::f64::consts::TAU / 2.4).sin() + 0.1 * (20.0 * t).sin());
        assert!((found.expect("a period") - 2.4).abs() < 0.03, "{found:?}");
        // Single missing cycles have no effect.
        let found = run(&|t| {
            let resting = (12.0..14.4).contains(&t);
            if resting { -1.0 } else { -(t * std::f64::consts::TAU / 2.4).cos() }
        });
        assert!((found.expect("a period") - 2.4).abs() < 0.01, "{found:?}");
        assert_eq!(run(&|t| 1e-3 * t.sin()), None, "at rest");
        assert_eq!(run(&|t| t), None, "on its way");
    }

    #[test]
    fn decaying_oscillations_settle_and_others_do_not() {
        let dying = judged(|t| 10.0 * (-0.6 * t).exp());
        assert!(dying.settle());
        assert!((dying.growth()[1] + 0.6).abs() < 0.01, "{:?}", dying.growth());
        let growing = judged(|t| (0.5 * t).exp() * (6.0 * t).sin());
        assert!(!growing.settle() && growing.growth()[1] > 0.4, "{:?}", growing.growth());
        assert!(!judged(|t| (6.0 * t).sin()).settle(), "a sustained oscillation");
        assert!(!judged(|t| if t > 4.0 { t } else { 0.0 }).settle(), "a burst");
        assert!(judged(|t| 4e-3 * (6.0 * t).sin()).settle(), "at rest, whatever rounding does");
        assert!(!judged(|t| if t > 4.0 { f64::NAN } else { 0.0 }).settle(), "not a number");
    }
}
