//! Tasks: a joint, its limb, and the angle that is wanted over time.

use std::f64::consts::{PI, TAU};
use vm_nostd::control::{ANKLE, ELBOW, JointPreset, KNEE, LimbParams};

/// A task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Task {
    /// The foot is lifted in the swing of each of five steps, against drop foot.
    DropFoot,
    /// The knee is held extended against gravity and fatigue for 5 minutes.
    KneeHold,
    /// The elbow follows a sinusoid whose frequency goes from 0.1 to 2 Hz.
    ElbowSinusoid,
    /// The elbow reaches and returns, twice.
    ElbowReach,
}

/// Angle, velocity and acceleration, rad, rad/s and rad/s².
pub type Motion = [f64; 3];

/// Time of the approach, s: not scored.
pub const APPROACH: f64 = 2.5;

impl Task {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::DropFoot, Self::KneeHold, Self::ElbowSinusoid, Self::ElbowReach];

    /// Name on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::DropFoot => "drop-foot",
            Self::KneeHold => "knee-hold",
            Self::ElbowSinusoid => "elbow-sinusoid",
            Self::ElbowReach => "elbow-reach",
        }
    }

    /// The joint.
    pub fn joint(self) -> JointPreset {
        match self {
            Self::DropFoot => ANKLE,
            Self::KneeHold => KNEE,
            Self::ElbowSinusoid | Self::ElbowReach => ELBOW,
        }
    }

    /// The limb of a body of 75 kg and 1.75 m by Dempster's fractions as Winter has them
    /// (Biomechanics and Motor Control of Human Movement): foot 0.0145 of the mass, its centre 6 cm
    /// and its radius of gyration 9 cm from the ankle (assumed), leg and foot 0.061 at 0.606 of
    /// 0.43 m (0.735), forearm and hand 0.022 at 0.682 of 0.256 m (0.827). Damping is assumed. The
    /// patient sits; the shank of a swinging leg is taken as upright.
    pub fn limb(self) -> LimbParams {
        const G: f64 = 9.81;
        match self {
            Self::DropFoot => LimbParams {
                inertia: 1.09 * 0.09 * 0.09,
                damping: 0.1,
                gravity: 1.09 * G * 0.06,
                hanging_angle: -PI / 2.0,
            },
            Self::KneeHold => LimbParams {
                inertia: 4.58 * (0.735_f64 * 0.43).powi(2),
                damping: 0.8,
                gravity: 4.58 * G * 0.606 * 0.43,
                hanging_angle: PI / 2.0,
            },
            Self::ElbowSinusoid | Self::ElbowReach => LimbParams {
                inertia: 1.65 * (0.827_f64 * 0.256).powi(2),
                damping: 0.2,
                gravity: 1.65 * G * 0.682 * 0.256,
                hanging_angle: 0.0,
            },
        }
    }

    /// Share of a healthy muscle's F0 that a paralysed one has: assumed.
    pub fn strength(self) -> f64 {
        match self {
            Self::DropFoot | Self::ElbowSinusoid | Self::ElbowReach => 0.5,
            Self::KneeHold => 0.3,
        }
    }

    /// Duration with the approach, s. Tuners hold the knee for 40 s: as long as it takes to see
    /// fatigue.
    pub fn duration(self, tuning: bool) -> f64 {
        match self {
            Self::DropFoot => 8.75,
            Self::KneeHold if tuning => 40.0,
            Self::KneeHold => 300.0,
            Self::ElbowSinusoid => 22.5,
            Self::ElbowReach => 10.5,
        }
    }

    /// Angle at which the task starts, rad.
    pub fn start(self) -> f64 {
        self.target(0.0)[0]
    }

    /// What is wanted at a time (s). All tasks begin with an approach from where the limb rests.
    pub fn target(self, time: f64) -> Motion {
        let (rest, first) = self.approach();
        let degrees = if time < APPROACH {
            minimum_jerk(time - 0.2, rest, first, APPROACH - 0.5)
        } else {
            self.scored(time - APPROACH)
        };
        degrees.map(f64::to_radians)
    }

    /// Where the limb rests, and where the scored part begins, degrees.
    fn approach(self) -> (f64, f64) {
        match self {
            Self::DropFoot => (-38.0, -20.0),
            Self::KneeHold => (85.0, 80.0),
            Self::ElbowSinusoid => (5.0, 70.0),
            Self::ElbowReach => (5.0, 40.0),
        }
    }

    /// Motion after the approach, in degrees.
    fn scored(self, time: f64) -> Motion {
        match self {
            // Lifted within 0.25 s, held for 0.4 s, dropped again, every 1.25 s.
            Self::DropFoot => pulse(time.rem_euclid(1.25), -20.0, 2.0, 0.25, 0.65),
            Self::KneeHold => minimum_jerk(time, 80.0, 35.0, 2.0),
            Self::ElbowSinusoid => {
                // 0.1 to 2 Hz with a phase that grows exponentially.
                let scored = self.duration(false) - APPROACH;
                let (least, rate) = (0.1, 20.0_f64.ln() / scored);
                let frequency = least * (rate * time).exp();
                let phase = TAU * (frequency - least) / rate;
                let speed = TAU * frequency;
                [
                    70.0 + 15.0 * phase.sin(),
                    15.0 * speed * phase.cos(),
                    15.0 * (speed * rate * phase.cos() - speed * speed * phase.sin()),
                ]
            }
            Self::ElbowReach => pulse(time.rem_euclid(4.0), 40.0, 100.0, 1.0, 2.0),
        }
    }

    /// Least and greatest angle that is wanted, rad.
    pub fn extent(self) -> (f64, f64) {
        let degrees = match self {
            Self::DropFoot => (-20.0, 2.0),
            Self::KneeHold => (35.0, 80.0),
            Self::ElbowSinusoid => (55.0, 85.0),
            Self::ElbowReach => (40.0, 100.0),
        };
        (f64::to_radians(degrees.0), f64::to_radians(degrees.1))
    }
}

/// From `low` to `high` within `rise`, and back from `back` on.
fn pulse(time: f64, low: f64, high: f64, rise: f64, back: f64) -> Motion {
    if time < back {
        minimum_jerk(time, low, high, rise)
    } else {
        minimum_jerk(time - back, high, low, rise)
    }
}

/// Minimum jerk (Flash & Hogan, J. Neurosci. 5 (1985) 1688-1703): 10 s³ - 15 s⁴ + 6 s⁵.
fn minimum_jerk(time: f64, from: f64, to: f64, duration: f64) -> Motion {
    let s = (time / duration).clamp(0.0, 1.0);
    let reach = to - from;
    [
        from + reach * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s),
        reach / duration * 30.0 * (s * (1.0 - s)).powi(2),
        reach / duration.powi(2) * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_and_accelerations_are_derivatives_of_the_angle() {
        for task in Task::ALL {
            let (least, most) = task.extent();
            let range = task.joint().range;
            for step in 1..2000 {
                let time = f64::from(step) * task.duration(false).min(20.0) / 2000.0;
                let h = 1e-4;
                let [before, now, after] = [time - h, time, time + h].map(|t| task.target(t));
                // Acceleration jumps where a movement begins and ends.
                let off = ((after[0] - before[0]) / (2.0 * h) - now[1]).abs();
                // The sinusoid starts with a velocity.
                let starts = task == Task::ElbowSinusoid && (time - APPROACH).abs() < 2.0 * h;
                assert!(starts || off < 0.01, "{task:?} {time}: velocity off by {off}");
                let off = ((after[1] - before[1]) / (2.0 * h) - now[2]).abs();
                assert!(starts || off < 0.05 + 0.01 * now[2].abs(), "{task:?} {time}: {off}");
                let scored = time >= APPROACH;
                assert!(!scored || (least - 1e-9..=most + 1e-9).contains(&now[0]), "{time}");
                assert!(range.least < now[0] && now[0] < range.most);
            }
        }
    }
}
