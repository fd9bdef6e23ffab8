//! A patient who differs from the model, in parameters and in structure.

use super::random::Random;
use super::task::Task;
use vm_nostd::control::LimbParams;
use vm_nostd::{FatigueParams, MuscleParams, RecruitmentCurveParams};

/// Threshold and saturation of the electrodes as the controllers know them.
pub const ELECTRODE: RecruitmentCurveParams =
    RecruitmentCurveParams { threshold: 6e-3, saturation: 18e-3, chronaxie: 2e-4, slope: 2.0 };

/// An electrode whose curve is of another family than the controllers': Weibull's,
/// U = 1 - exp(-((I_e - threshold)/scale)^exponent).
#[derive(Clone, Copy, Debug)]
pub struct Electrode {
    threshold: f64,
    scale: f64,
    exponent: f64,
    chronaxie: f64,
}

impl Electrode {
    /// As the model's curve has it, but for a family: half recruited at the same amplitude.
    fn drawn(random: &mut Random) -> Self {
        let threshold = ELECTRODE.threshold * random.between(0.7, 1.3);
        let slope = random.between(0.7, 1.3);
        let half = 0.5 * (ELECTRODE.saturation - ELECTRODE.threshold) / slope;
        let exponent = random.between(1.5, 3.0);
        let scale = half / 2.0_f64.ln().powf(1.0 / exponent);
        Self { threshold, scale, exponent, chronaxie: ELECTRODE.chronaxie }
    }

    /// What a pulse (A, s) recruits.
    pub fn recruited(&self, amplitude: f64, width: f64) -> f64 {
        let effective = amplitude * width / (width + self.chronaxie);
        let above = ((effective - self.threshold) / self.scale).max(0.0);
        1.0 - (-above.powf(self.exponent)).exp()
    }
}

/// A patient: the plant's parameters. Pairs are flexor and extensor.
#[derive(Clone, Debug)]
pub struct Patient {
    /// Muscles: F0 0.6 to 1.4, time constants of excitation 0.75 to 1.25 of the controller's.
    pub muscles: [MuscleParams<2>; 2],
    /// Fatigue: a third to three times as fast.
    pub fatigue: [FatigueParams; 2],
    /// Thresholds and slopes 0.7 to 1.3.
    pub electrodes: [Electrode; 2],
    /// Inertia and weight 0.8 to 1.2, damping half to twice.
    pub limb: LimbParams,
    /// Angle between fascicles and tendon at L_ce0, rad: up to 20 degrees.
    pub pennation: [f64; 2],
    /// Delay of the sensor, s: 0.005 to 0.04.
    pub delay: f64,
    /// Standard deviation of its noise, rad: 0.1 to 0.5 degrees.
    pub noise: f64,
    /// Reflex torque against a stretched muscle, N m s/rad, half of the patients; 30 ms late.
    pub spasticity: f64,
    /// An external torque, N m, and when it begins and ends, s.
    pub push: (f64, f64, f64),
}

impl Patient {
    /// The patient of a number among those that are scored: drawn after the last change of tasks,
    /// controllers and ranges, none of which has seen them.
    pub fn scored(task: Task, number: u64) -> Self {
        Self::draw(task, 5, number)
    }

    /// The patient of a number among those that controllers are tuned on.
    pub fn tuned_on(task: Task, number: u64) -> Self {
        Self::draw(task, 2, number)
    }

    fn draw(task: Task, stream: u64, number: u64) -> Self {
        let mut random = Random::new(stream, number);
        let nominal = nominal(task);
        let muscles = nominal.map(|muscle| {
            let mut varied = muscle;
            varied.mass *= random.between(0.6, 1.4);
            for fiber in &mut varied.fibers {
                let e = &mut fiber.fiber_type.excitation;
                for time in [
                    &mut e.rise,
                    &mut e.rise_per_frequency,
                    &mut e.fall,
                    &mut e.fall_per_activation,
                ] {
                    *time *= random.between(0.75, 1.25);
                }
            }
            varied
        });
        let fatigue = [(); 2].map(|()| {
            let nominal = FatigueParams::QUADRICEPS;
            FatigueParams {
                fatigue_time: nominal.fatigue_time * random.factor(3.0),
                recovery_time: nominal.recovery_time * random.factor(3.0),
                ..nominal
            }
        });
        let electrodes = [(); 2].map(|()| Electrode::drawn(&mut random));
        let limb = task.limb();
        let spastic = random.share() < 0.5;
        // A tenth of the weight's torque or of that of half a radian per s, at least 0.1 N m.
        let size = 0.2 * limb.gravity + 0.1;
        let start = random.between(0.3, 0.6) * task.duration(false).min(20.0);
        Self {
            muscles,
            fatigue,
            electrodes,
            limb: LimbParams {
                inertia: limb.inertia * random.between(0.8, 1.2),
                damping: limb.damping * random.factor(2.0),
                gravity: limb.gravity * random.between(0.8, 1.2),
                ..limb
            },
            pennation: [(); 2].map(|()| random.between(0.0, 20.0).to_radians()),
            delay: random.between(0.005, 0.04),
            noise: random.between(0.1, 0.5).to_radians(),
            spasticity: if spastic { random.between(0.0, 0.5) * size } else { 0.0 },
            push: (size * random.between(-1.0, 1.0), start, start + random.between(0.1, 1.0)),
        }
    }
}

/// The muscles as the controllers know them.
pub fn nominal(task: Task) -> [MuscleParams<2>; 2] {
    task.joint().muscles.map(|muscle| {
        let mut params = muscle.params();
        params.mass *= task.strength();
        params
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patients_are_their_own_and_within_their_spreads() {
        for task in Task::ALL {
            let nominal = nominal(task);
            for number in 0..200 {
                let patient = Patient::scored(task, number);
                for (muscle, nominal) in patient.muscles.iter().zip(&nominal) {
                    let strength = muscle.mass / nominal.mass;
                    assert!((0.6..=1.4).contains(&strength), "{task:?} {number}: {strength}");
                    assert_eq!(muscle.validate(), Ok(()), "{task:?} {number}");
                }
                let other = Patient::tuned_on(task, number);
                assert_ne!(patient.muscles, other.muscles, "{task:?} {number}");
                let again = Patient::scored(task, number);
                assert_eq!(patient.muscles, again.muscles, "{task:?} {number}");
            }
        }
    }

    #[test]
    fn electrodes_recruit_from_none_to_all_without_a_step_back() {
        for number in 0..50 {
            let patient = Patient::scored(Task::KneeHold, number);
            let mut last = 0.0;
            for width in 0..=500 {
                let recruited = patient.electrodes[0].recruited(0.03, f64::from(width) * 1e-6);
                assert!(recruited >= last);
                last = recruited;
            }
            assert_eq!(patient.electrodes[0].recruited(0.03, 0.0), 0.0);
            assert!(last > 0.5, "{number}: {last}");
        }
    }
}
