//! What became of an arm under constant activations: whether its swings die out or go on.

use super::data::Arm;
use super::simulation::Moment;
use super::skeleton::Joints;
use vm_nostd::Status;

/// How a joint swings is judged in windows of this length, s.
const WINDOW: f64 = 0.5;
/// From here on, s: before, the arm goes to where its muscles balance.
const SETTLING: f64 = 1.0;
/// At least so many windows, half of which are early and half late.
const FEWEST: usize = 4;
/// A joint that moves less in a window is at rest, degrees: a hundredth of what goniometers tell apart.
const LEAST_SWING: f64 = 0.01;
/// Of a swing that dies out, less than this share of the early one is left late.
const LEFT: f64 = 0.5;

/// What became of it; pairs are shoulder and elbow.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Angles at the end, degrees.
    pub final_angles: Joints,
    /// Early and late swings; none of a run that is too short to have them.
    pub swings: Option<Swings>,
    /// Some angle was beyond the joints' range, where nothing stops them and paths may be clipped.
    pub out_of_range: bool,
    /// Energy that is in the arm without a muscle having put it there, as a share of all that muscles
    /// gave and took: the largest over the run.
    pub energy_error: f64,
    /// All flags of all muscles.
    pub status: Status,
}

/// The largest swings, from the least to the greatest angle of half a second, degrees.
#[derive(Clone, Copy, Debug)]
pub struct Swings {
    /// In the first half of the time from 1 s on.
    pub early: Joints,
    /// In the second half.
    pub late: Joints,
    /// How long each half is, s.
    half: f64,
}

impl Swings {
    /// Of the swings from the early half to the late one, 1/s: negative where they die out. A joint at rest
    /// counts as swinging by a hundredth of a degree.
    pub fn growth(&self) -> Joints {
        [0, 1].map(|joint| {
            let [early, late] =
                [self.early, self.late].map(|swings| at_least(swings[joint], LEAST_SWING));
            (late / early).ln() / self.half
        })
    }

    /// Whether the swings of both joints die out, or have done so.
    pub fn settle(&self) -> bool {
        (0..2).all(|joint| {
            self.late[joint] <= LEAST_SWING || self.late[joint] <= LEFT * self.early[joint]
        })
    }
}

/// The larger of two; not-a-number where the first is.
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

/// From the least to the greatest angle, degrees; not-a-number where an angle is.
fn swing(moments: &[Moment], joint: usize) -> f64 {
    let angles = || moments.iter().map(|moment| moment.angles[joint].to_degrees());
    let (least, most) = angles()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), angle| (a.min(angle), b.max(angle)));
    if angles().all(f64::is_finite) { most - least } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run of 5 s in which the shoulder is at rest and the elbow goes by a function of time (degrees).
    fn judged(elbow: impl Fn(f64) -> f64) -> Swings {
        let moments: Vec<Moment> = (0..=500)
            .map(|tick| Moment {
                time: f64::from(tick) * 0.01,
                angles: [0.0, elbow(f64::from(tick) * 0.01).to_radians()],
                velocities: [0.0; 2],
                forces: Vec::new(),
                kinetic_energy: 0.0,
                work: 0.0,
                turnover: 0.0,
                status: Status::empty(),
            })
            .collect();
        assert!(swings(&moments[..=290], 0.01).is_none(), "too short to be judged");
        swings(&moments, 0.01).expect("long enough")
    }

    #[test]
    fn swings_that_die_out_settle_and_others_do_not() {
        let dying = judged(|t| 10.0 * (-0.6 * t).exp());
        assert!(dying.settle());
        assert!((dying.growth()[1] + 0.6).abs() < 0.01, "{:?}", dying.growth());
        let growing = judged(|t| (0.5 * t).exp() * (6.0 * t).sin());
        assert!(!growing.settle() && growing.growth()[1] > 0.4, "{:?}", growing.growth());
        assert!(!judged(|t| (6.0 * t).sin()).settle(), "it goes on");
        assert!(!judged(|t| if t > 4.0 { t } else { 0.0 }).settle(), "a burst");
        assert!(judged(|t| 4e-3 * (6.0 * t).sin()).settle(), "at rest, whatever rounding does");
        assert!(!judged(|t| if t > 4.0 { f64::NAN } else { 0.0 }).settle(), "not a number");
    }
}
