//! Effect of pennation, which Virtual Muscle does not model, on steady force.
//!
//! A muscle of constant thickness (Zajac, Crit. Rev. Biomed. Eng. 17 (1989) 359-411): L sin α is
//! constant, so that sin α = sin α0/L with the angle α0 at L_ce0; the tendon carries cos α of the
//! fascicle force.

use super::elements as element;
use super::muscle::Muscle;

/// An angle α0 between fascicles at L_ce0 and tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pennation {
    sine: f64,
}

impl Pennation {
    /// From α0, rad, 0 up to but not π/2.
    pub fn new(angle: f64) -> Self {
        Self { sine: angle.sin() }
    }

    /// cos α at fascicle length `l`, L_ce0; 0 if that is at most the muscle's thickness.
    pub fn cosine(self, l: f64) -> f64 {
        (1.0 - (self.sine / l).powi(2)).max(0.0).sqrt()
    }

    /// Steady tendon force, in F0, of a fully activated muscle on a path (m): Af = 1, V = 0.
    pub fn isometric_force(self, muscle: &Muscle, path: f64) -> f64 {
        let e = &muscle.elements;
        let l_max = muscle.maximum_fascicle_length();
        let tendon = |l: f64| {
            let fascicles = l * muscle.L_ce0 * self.cosine(l);
            element::tendon(e, (path - fascicles) / muscle.L_se0)
        };
        let fascicles = |l: f64| {
            let filaments: f64 = muscle
                .fibers
                .iter()
                .map(|fiber| fiber.fraction * element::force_length(&fiber.fiber_type, l))
                .sum();
            let passive = element::parallel_elastic(e, l, l_max, 0.0) + element::compression(e, l);
            self.cosine(l) * (filaments + passive).max(0.0)
        };
        // Bracket: from cos α = 0 to a tendon of zero length.
        let (mut low, mut high) = (self.sine.max(1e-3), path / muscle.L_ce0 + 1.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if tendon(middle) > fascicles(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        tendon(low)
    }
}
