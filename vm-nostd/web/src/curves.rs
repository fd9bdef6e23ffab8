//! The curves beside the scope, all at full activation.
//!
//! Isometric forces are those of [`SteadyFes`]; the force-velocity points come from stepping the
//! muscle on paths of constant speed, where its fascicles pass L_ce0.

use crate::muscle::Definition;
use vm_nostd::{FesMuscle, Input, ParameterError, SteadyFes, TimeStep};

/// Stimulation at which every type is fused, pps.
const TETANUS: f64 = 100.0;
/// Points of an isometric curve.
const POINTS: usize = 61;
/// Speeds of the path, L_ce0/s.
const FASTEST: (f64, f64) = (-14.0, 5.0);
/// The path moves for this long before the fascicles pass L_ce0 if they keep up with it, s.
const LEAD: f64 = 0.03;
/// Ticks until a tetanus is steady, and most ticks of a movement.
const HELD: usize = 800;
const MOVING: usize = 200;
/// Bisections of a path.
const HALVINGS: usize = 40;

/// A point: L (L_ce0) or V (L_ce0/s), and force (F0).
pub type Point = (f64, f64);

/// Isometric force, passive force, and force while the fascicles pass L_ce0.
pub struct Curves {
    /// Force against length at full activation.
    pub isometric: Vec<Point>,
    /// Force against length without activation.
    pub passive: Vec<Point>,
    /// Force against velocity.
    pub velocity: Vec<Point>,
}

impl Curves {
    /// The curves of a muscle.
    pub fn of(definition: &Definition) -> Result<Self, ParameterError> {
        let params = definition.params();
        let steady = SteadyFes::<f64, 2>::build(&params)?;
        let muscle = FesMuscle::<f64, 2>::build(&params, TimeStep::MILLISECOND)?;
        let (shortest, longest) = params.path_domain();
        let longest = longest.min(params.max_path_length * 1.1);
        let at = |activation, path_length| {
            steady.force(Input { activation, path_length, stimulation_frequency: TETANUS })
        };
        let along = |activation| {
            (0..POINTS)
                .map(|index| {
                    let share = index as f64 / (POINTS - 1) as f64;
                    let found = at(activation, shortest + share * (longest - shortest));
                    (found.fascicle_length, found.relative_force)
                })
                .collect()
        };
        let path_of = |length: f64| {
            let (mut least, mut most) = (shortest, longest);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (least + most);
                if at(1.0, middle).fascicle_length > length {
                    most = middle
                } else {
                    least = middle
                }
            }
            least
        };
        let mut velocity = Vec::new();
        let (fastest_shortening, fastest_lengthening) = FASTEST;
        let mut speed = fastest_shortening;
        while speed <= fastest_lengthening {
            velocity.extend(passing(
                &muscle,
                path_of(1.0 - speed * LEAD),
                speed * params.fascicle_length,
            )?);
            speed += 0.5;
        }
        velocity.sort_by(|one, other| one.0.total_cmp(&other.0));
        Ok(Self { isometric: along(1.0), passive: along(0.0), velocity })
    }
}

/// Velocity and force where the fascicles of a tetanised muscle pass L_ce0 on a path that starts at
/// `start` (m) and moves at `speed` (m/s); none if they do not.
fn passing(
    muscle: &FesMuscle<f64, 2>,
    start: f64,
    speed: f64,
) -> Result<Option<Point>, ParameterError> {
    let mut state = muscle.rest(start)?;
    let input =
        |path_length| Input { activation: 1.0, path_length, stimulation_frequency: TETANUS };
    let mut before = muscle.observe(&state).fascicle_length;
    for _ in 0..HELD {
        before = muscle.step(&mut state, input(start)).fascicle_length;
    }
    if speed == 0.0 {
        let output = muscle.observe(&state);
        return Ok(Some((output.fascicle_velocity, output.relative_force)));
    }
    for tick in 1..=MOVING {
        let output = muscle.step(&mut state, input(start + speed * 1e-3 * tick as f64));
        if (output.fascicle_length - 1.0) * (before - 1.0) <= 0.0 {
            return Ok(Some((output.fascicle_velocity, output.relative_force)));
        }
        before = output.fascicle_length;
    }
    Ok(None)
}
