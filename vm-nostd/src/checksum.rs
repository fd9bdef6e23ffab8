//! A checksum of coefficients and state, with which firmware detects flipped bits in RAM.
//!
//! For each word, h <- (rotate(h, 5) xor word) k with odd k. This is a bijection of h for a given
//! word, and of the word for a given h: one changed word is always detected, several are missed
//! with a probability of about 2^-32.

/// A checksum of words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checksum(u32);

/// The factor k: 2^32 over the golden ratio, odd and with well-mixed bits.
const FACTOR: u32 = 0x9E37_79B1;

impl Checksum {
    /// The checksum of no words.
    pub const EMPTY: Self = Self(0);

    /// Adds a word.
    #[inline]
    pub const fn add(&mut self, word: u32) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(FACTOR);
    }

    /// The checksum.
    pub const fn value(self) -> u32 {
        self.0
    }

    /// The checksum with another word.
    pub(crate) const fn and_word(mut self, word: u32) -> Self {
        self.add(word);
        self
    }

    /// The checksum with a text, byte by byte.
    pub(crate) const fn and(mut self, text: &str) -> Self {
        let mut rest = text.as_bytes();
        while let [byte, after @ ..] = rest {
            self.add(*byte as u32);
            rest = after;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use crate::checksum::Checksum;
    use crate::muscle::{ContinuousMuscle, DiscreteMuscle, EffectiveLengthMuscle, FesMuscle};
    use crate::params::MuscleParams;
    use crate::params::presets::PAPER_MUSCLE;
    use crate::recruitment::{MotorUnits, UnitSizes};
    use crate::scalar::Scalar;
    use crate::scalar::fixed::Fixed;
    use crate::tick::time_step::TimeStep;

    #[test]
    fn every_flipped_bit_is_detected() {
        let sum = |words: &[u32]| {
            let mut checksum = Checksum::EMPTY;
            words.iter().for_each(|&word| checksum.add(word));
            checksum.value()
        };
        let words = [0, 1, 0x8000_0000, u32::MAX, 12345];
        for index in 0..words.len() {
            for bit in 0..32 {
                let mut other = words;
                other[index] ^= 1 << bit;
                assert_ne!(sum(&words), sum(&other), "word {index} bit {bit}");
            }
        }
        assert_ne!(sum(&[1, 2]), sum(&[2, 1]));
    }

    /// A small change of any parameter changes the checksum.
    fn parameters_change_the_checksum<S: Scalar>() {
        let muscle = PAPER_MUSCLE;
        let step = TimeStep::MILLISECOND;
        let sums = |params: &MuscleParams<2>, step| {
            let units =
                MotorUnits::<3>::new(params, [UnitSizes::Default(2), UnitSizes::Default(1)])
                    .expect("units");
            [
                ContinuousMuscle::<S, 2>::build(params, step).expect("a muscle").checksum(),
                FesMuscle::<S, 2>::build(params, step).expect("a muscle").checksum(),
                DiscreteMuscle::<S, 2, 3>::build_with_units(params, &units, step)
                    .expect("a muscle")
                    .checksum(),
                EffectiveLengthMuscle::<S, 2, 3>::build_with_units(params, &units, step)
                    .expect("a muscle")
                    .checksum(),
            ]
        };
        let before = sums(&muscle, step);
        let check = |what: &str, change: &dyn Fn(&mut MuscleParams<2>), modes: &[usize]| {
            let mut other = muscle;
            change(&mut other);
            let after = sums(&other, step);
            for (mode, (before, after)) in before.iter().zip(&after).enumerate() {
                assert_eq!(before != after, modes.contains(&mode), "{what}, mode {mode}");
            }
        };
        let all = &[0, 1, 2, 3];
        check("nothing", &|_| (), &[]);
        check("mass", &|m| m.mass *= 1.01, all);
        check("fascicle_length", &|m| m.fascicle_length *= 1.01, all);
        check("tendon_length", &|m| m.tendon_length *= 1.01, all);
        check("max_path_length", &|m| m.max_path_length *= 1.01, all);
        check("class", &|m| m.class = crate::Class::Fine, all);
        // FES has no recruitment thresholds, and only FES uses frequencies in pps.
        check("recruitment_saturation", &|m| m.recruitment_saturation = 0.7, &[0, 2, 3]);
        check("tendon.stiffness", &|m| m.elements.tendon.stiffness *= 1.01, all);
        check("tendon.toe", &|m| m.elements.tendon.toe *= 1.01, all);
        check("parallel.stiffness", &|m| m.elements.parallel.stiffness *= 1.01, all);
        check("parallel.viscosity", &|m| m.elements.parallel.viscosity *= 1.01, all);
        check("compression.strength", &|m| m.elements.compression.strength *= 1.01, all);
        check("compression.onset", &|m| m.elements.compression.onset_length *= 1.01, all);
        for fiber in 0..2 {
            let of = |m: &mut MuscleParams<2>, change: fn(&mut crate::params::FiberType)| {
                change(&mut m.fibers[fiber].fiber_type);
            };
            check("half_force", &|m| of(m, |t| t.half_force_frequency *= 1.01), &[1]);
            check("force_length.width", &|m| of(m, |t| t.force_length.width *= 1.01), all);
            check("skewness", &|m| of(m, |t| t.force_length.skewness *= 1.01), all);
            check("roundness", &|m| of(m, |t| t.force_length.roundness *= 1.01), all);
            check("shortening", &|m| of(m, |t| t.force_velocity.shortening[0] *= 1.01), all);
            check("lengthening", &|m| of(m, |t| t.force_velocity.lengthening[0] *= 1.01), all);
            check("b_V", &|m| of(m, |t| t.force_velocity.lengthening_velocity *= 1.01), all);
            check("scale", &|m| of(m, |t| t.activation.scale *= 1.01), all);
            check("exponent", &|m| of(m, |t| t.activation.exponent *= 1.01), all);
            check("rise", &|m| of(m, |t| t.excitation.rise *= 1.01), all);
            check("fall", &|m| of(m, |t| t.excitation.fall_per_activation *= 1.01), all);
            check("T_L", &|m| of(m, |t| t.effective_length_time *= 1.01), &[3]);
        }
        let slow: fn(&mut MuscleParams<2>) = |m| {
            m.fibers[0].fiber_type.yielding.as_mut().expect("yield").time_constant *= 1.01;
        };
        check("yield", &slow, all);
        let fast: fn(&mut MuscleParams<2>) = |m| {
            m.fibers[1].fiber_type.sag.as_mut().expect("sag").firing_level *= 1.01;
        };
        check("sag", &fast, all);
        let other = TimeStep::from_seconds(0.99e-3).expect("a step");
        assert!(before.iter().zip(sums(&muscle, other)).all(|(before, after)| *before != after));
    }

    #[test]
    fn every_parameter_changes_the_checksum() {
        parameters_change_the_checksum::<f32>();
        parameters_change_the_checksum::<Fixed>();
        parameters_change_the_checksum::<f64>();
    }
}
