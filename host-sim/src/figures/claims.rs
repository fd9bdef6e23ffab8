//! What the paper says, and what is found.

use super::{computation_time, sinusoids, static_force};
use crate::arm::Outcome;
use serde::Serialize;
use sinusoids::Swing;

/// A claim of the paper's section 3.
#[derive(Clone, Debug, Serialize)]
pub struct Claim {
    /// What is claimed.
    pub claim: &'static str,
    /// The claimed number.
    pub claimed: &'static str,
    /// The number that is found.
    pub measured: String,
    /// Whether they agree.
    pub agrees: bool,
    /// Where they do not, why.
    pub why: &'static str,
}

/// The least and the greatest of some numbers.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
}

/// What "close to unity" is held to: for mean force, and for the range of force.
const MEANS_NEAR_ONE: f64 = 0.05;
const RANGES_NEAR_ONE: f64 = 0.15;
/// What "about" so many newtons is held to.
const ABOUT: f64 = 0.5;

/// Why length sinusoids at a constant activation differ.
const STEADY_DIFFERENCE: &str = "at the same U of 0.5, continuous recruitment holds less force than 30 + 30 \
     units (static_force.csv); at the higher frequencies the tendon goes slack and snaps";

/// Continuous over discrete, by one kind of sinusoid.
fn ratio(
    claim: &'static str,
    why: &'static str,
    ratios: impl Iterator<Item = f64>,
    near: f64,
) -> Claim {
    let (least, most) = range(ratios);
    Claim {
        claim,
        claimed: "close to 1",
        measured: format!("{least:.3} to {most:.3}"),
        agrees: least >= 1.0 - near && most <= 1.0 + near,
        why,
    }
}

/// All claims of the paper that the figures bear on.
pub(super) fn judge(
    [continuous, discrete, effective_length]: &[Outcome; 3],
    curve: &[static_force::Row],
    dynamics: &[sinusoids::Row],
    times: &[computation_time::Row],
) -> Vec<Claim> {
    let step = static_force::first_step(curve);
    let of = |swing| dynamics.iter().filter(move |row| row.swing == swing);
    let effective = |swing| range(of(swing).map(|row| row.effective_length_pct)).1;
    let by_activation = effective(Swing::Activation);
    let by_length = effective(Swing::Length);
    let last = times.last();
    let units_time = last.map_or(f64::NAN, |row| row.discrete);
    let length_time = last.map_or(f64::NAN, |row| row.effective_length / row.discrete);
    let settles = |outcome: &Outcome| outcome.swings.is_some_and(|swings| swings.settle());
    let swings = |outcome: &Outcome| {
        outcome.swings.map_or("not judged".to_owned(), |swings| {
            let [shoulder, elbow] = swings.growth();
            let [early, late] = [swings.early[1], swings.late[1]];
            format!(
                "growth {shoulder:+.2}/s and {elbow:+.2}/s; elbow swings by {early:.2}, then {late:.2} degrees"
            )
        })
    };
    vec![
        Claim {
            claim: "with effective length the arm goes unstable",
            claimed: "oscillations of the joints",
            measured: swings(effective_length),
            agrees: !settles(effective_length),
            why: "with other activations and starts it may settle; arm.csv has the angles",
        },
        Claim {
            claim: "without effective length the arm settles",
            claimed: "no oscillations",
            measured: format!("discrete: {}; continuous: {}", swings(discrete), swings(continuous)),
            agrees: settles(discrete) && settles(continuous),
            why: "arm.csv has the angles",
        },
        Claim {
            claim: "the first of 3 + 3 units is recruited with a step of force",
            claimed: "about 14 to 15 N",
            measured: format!("{step:.2} N"),
            agrees: (14.0 - ABOUT..=15.0 + ABOUT).contains(&step),
            why: "",
        },
        ratio(
            "continuous over discrete 30 + 30, mean force, sinusoids of activation",
            "",
            of(Swing::Activation).map(|row| row.mean_ratio),
            MEANS_NEAR_ONE,
        ),
        ratio(
            "continuous over discrete 30 + 30, range of force, sinusoids of activation",
            "",
            of(Swing::Activation).map(|row| row.range_ratio),
            RANGES_NEAR_ONE,
        ),
        ratio(
            "continuous over discrete 30 + 30, mean force, sinusoids of length",
            STEADY_DIFFERENCE,
            of(Swing::Length).map(|row| row.mean_ratio),
            MEANS_NEAR_ONE,
        ),
        ratio(
            "continuous over discrete 30 + 30, range of force, sinusoids of length",
            STEADY_DIFFERENCE,
            of(Swing::Length).map(|row| row.range_ratio),
            RANGES_NEAR_ONE,
        ),
        Claim {
            claim: "effective length changes force, sinusoids of activation",
            claimed: "less than 1 %",
            measured: format!("{by_activation:.2} %"),
            agrees: by_activation < 1.0,
            why: "",
        },
        Claim {
            claim: "effective length changes force, sinusoids of length",
            claimed: "less than 1 %",
            measured: format!("{by_length:.2} %"),
            agrees: by_length < 1.0,
            why: "the L_eff of a unit that is not fully active lags behind L, and n_f with it; where \
                  the tendon goes slack and snaps, small delays make large differences",
        },
        Claim {
            claim: "time of discrete 30 + 30 over continuous",
            claimed: "8.5 (8.5 s over about 1 s), or 15 by the abstract",
            measured: format!("{units_time:.1}"),
            agrees: (8.0..=16.0).contains(&units_time),
            why: "here most of a continuous tick is the mechanics, which all modes share",
        },
        Claim {
            claim: "time of effective length over none, 30 + 30",
            claimed: "7.3 (62 s over 8.5 s)",
            measured: format!("{length_time:.2}"),
            agrees: (6.0..=9.0).contains(&length_time),
            why: "here L_eff is integrated exactly instead of as one more stiff state",
        },
    ]
}
