//! Recruitment curve: pulse amplitude and width to activation, and back.
//!
//! Strength and duration (Lapicque 1907): a pulse of amplitude I and width w acts like a very long
//! one of I_e = I/(1 + c/w) with the chronaxie c. The least effective I_e is the rheobase of the
//! first recruited fibres, here the threshold. Between threshold and saturation recruitment is
//! S-shaped like isometric recruitment curves (Durfee & MacLean, IEEE Trans. Biomed. Eng. 36 (1989)
//! 654-667). With x = (I_e - threshold)/(saturation - threshold) and t = 2x,
//!
//! `U = t/(t + m (1 - t))/2` up to x = 1/2,
//!
//! and point-symmetric about (1/2, 1/2) beyond. This rational form is ours: its slope is m in the
//! middle and 1/m at both ends, it is exactly 0 and 1 at the ends, and its inverse has the same
//! form.

use crate::checksum::Checksum;
use crate::error::{ParameterError, within};
use crate::scalar::Scalar;
use crate::summed::{Summed, summed};
use crate::tick::admission::{Admission, admit_one};
use crate::tick::range::Range;

bitflags::bitflags! {
    /// Flags of a pulse or of the inverse.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct PulseStatus: u16 {
        /// Amplitude was outside 0..500 mA, or beyond 100 times saturation, and was clipped.
        const AMPLITUDE_CLIPPED = 1 << 0;
        /// Amplitude was not a number (taken as 0) or infinite (clipped).
        const AMPLITUDE_NOT_FINITE = 1 << 1;
        /// Width was outside 0..5,000 µs and was clipped.
        const WIDTH_CLIPPED = 1 << 2;
        /// Width was not a number (taken as 0) or infinite (clipped).
        const WIDTH_NOT_FINITE = 1 << 3;
        /// Activation was outside 0..1 and was clipped.
        const ACTIVATION_CLIPPED = 1 << 4;
        /// Activation was not a number (taken as 0) or infinite (clipped).
        const ACTIVATION_NOT_FINITE = 1 << 5;
        /// No amplitude or width within these limits gives the requested activation: the result is
        /// the greatest one.
        const UNREACHABLE = 1 << 6;
    }
}

/// Greatest amplitude, mA, and width, µs.
const GREATEST_AMPLITUDE: f64 = 500.0;
const GREATEST_WIDTH: f64 = 5000.0;
/// Greatest amplitude, in saturations. Pulses of usual width recruit all fibres with less.
pub(crate) const GREATEST_STRENGTH: f64 = 100.0;

/// Parameters of the recruitment curve of an electrode and a muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RecruitmentCurveParams {
    /// Amplitude of a very long pulse that recruits the first fibres (their rheobase), A; 1e-5 to
    /// 0.2.
    pub threshold: f64,
    /// Amplitude of a very long pulse that recruits all fibres, A; 1.05 thresholds to 0.2.
    pub saturation: f64,
    /// Pulse width at which twice these amplitudes are needed, s; 5e-5 to 0.001.
    pub chronaxie: f64,
    /// Slope m in the middle, relative to a straight line; 1 to 10.
    pub slope: f64,
}

impl RecruitmentCurveParams {
    /// Validates the parameters; the error has field, value and limit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("threshold", self.threshold, 1e-5, 0.2)?;
        // Rounded down, so that 1.05 thresholds in decimals are enough.
        let least = 1.05 * self.threshold * (1.0 - f64::EPSILON);
        within("saturation", self.saturation, least, 0.2)?;
        within("chronaxie", self.chronaxie, 5e-5, 1e-3)?;
        within("slope", self.slope, 1.0, 10.0)
    }
}

/// A stimulation pulse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulse<S: Scalar> {
    /// I, mA; 0 to 500, and to 100 times saturation.
    pub amplitude: S::Quantity,
    /// w of the stimulating phase, µs; 0 to 5,000.
    pub width: S::Quantity,
}

summed! {
    /// Coefficients of a recruitment curve. Its methods cannot fail and have no data-dependent
    /// loops.
    ///
    /// Activation is monotonic in amplitude and width.
    ///
    /// ```
    /// use vm_nostd::{Pulse, PulseStatus, RecruitmentCurve, RecruitmentCurveParams};
    /// let curve = RecruitmentCurve::<f32>::build(&RecruitmentCurveParams {
    ///     threshold: 4e-3,
    ///     saturation: 12e-3,
    ///     chronaxie: 200e-6,
    ///     slope: 2.0,
    /// })?;
    /// // Twice the mean of threshold and saturation, with the width of the chronaxie.
    /// let (activation, status) = curve.activation(Pulse { amplitude: 16.0, width: 200.0 });
    /// assert!((activation - 0.5).abs() < 1e-6);
    /// assert!(status.is_empty());
    /// let (amplitude, _) = curve.amplitude_for(activation, 200.0);
    /// assert!((amplitude - 16.0).abs() < 1e-4);
    /// assert_eq!(curve.activation(Pulse { amplitude: 7.9, width: 200.0 }).0, 0.0);
    /// assert_eq!(curve.amplitude_for(0.5, 0.0).1, PulseStatus::UNREACHABLE);
    /// # Ok::<(), vm_nostd::ParameterError>(())
    /// ```
    #[derive(Clone, Copy, Debug)]
    pub struct RecruitmentCurve<S: Scalar> {
        amplitudes: Range<S::Quantity>,
        widths: Range<S::Quantity>,
        activations: Range<S>,
        /// 1/saturation, per mA.
        per_saturation: S::Factor,
        /// mA.
        saturation: S::Factor,
        /// 1/chronaxie, per µs.
        per_chronaxie: S::Factor,
        /// µs.
        chronaxie: S::Factor,
        /// threshold/saturation.
        threshold: S,
        /// (saturation - threshold)/saturation, and one over it.
        reach: S::Factor,
        per_reach: S::Factor,
        slope: S,
    }
}

impl<S: Scalar> RecruitmentCurve<S> {
    /// Builds a curve; the error has field, value and limit.
    pub fn build(params: &RecruitmentCurveParams) -> Result<Self, ParameterError> {
        params.validate()?;
        let (saturation, chronaxie) = (params.saturation * 1e3, params.chronaxie * 1e6);
        let threshold = params.threshold / params.saturation;
        let greatest_amplitude = (GREATEST_STRENGTH * saturation).min(GREATEST_AMPLITUDE);
        Ok(Self {
            amplitudes: Range::new((0.0, greatest_amplitude), S::quantity),
            widths: Range::new((0.0, GREATEST_WIDTH), S::quantity),
            activations: Range { least: S::ZERO, most: S::ONE },
            per_saturation: S::per_quantity(1.0 / saturation),
            saturation: S::quantity_factor(saturation),
            per_chronaxie: S::per_quantity(1.0 / chronaxie),
            chronaxie: S::quantity_factor(chronaxie),
            threshold: S::from_f64(threshold),
            reach: S::factor(1.0 - threshold),
            per_reach: S::factor(1.0 / (1.0 - threshold)),
            slope: S::from_f64(params.slope),
        })
    }

    /// Checksum of the coefficients, see [`Muscle::checksum`](crate::Muscle::checksum).
    pub fn checksum(&self) -> u32 {
        let mut checksum = Checksum::EMPTY;
        self.sum(&mut checksum);
        checksum.value()
    }

    /// Activation U (0..1) of a pulse, and flags.
    pub fn activation(&self, pulse: Pulse<S>) -> (S, PulseStatus) {
        let (amplitude, a) = self.admit_amplitude(pulse.amplitude);
        let (width, w) = self.admit_width(pulse.width);
        let strength = S::of_quantity(amplitude, &self.per_saturation) * self.share(width);
        let excess = (strength - self.threshold).scaled(&self.per_reach);
        (self.rise(self.activations.clip(excess).0), a.union(w))
    }

    /// Amplitude (mA) at which a pulse of a given width has an activation; for activation 0, the
    /// greatest amplitude that recruits nothing. Subject to rounding: the activation of the result
    /// may be slightly above 0 or below 1.
    pub fn amplitude_for(&self, activation: S, width: S::Quantity) -> (S::Quantity, PulseStatus) {
        let (width, w) = self.admit_width(width);
        let (strength, u) = self.strength_for(activation);
        let share = self.share(width);
        let most = self.amplitudes.most;
        // A pulse of zero width needs an infinite amplitude.
        let wanted = strength.ratio(share.max(S::LEAST));
        let reachable = share > S::ZERO && wanted <= S::of_quantity(most, &self.per_saturation);
        if reachable {
            (self.amplitudes.clip(wanted.to_quantity(&self.saturation)).0, w.union(u))
        } else {
            (most, w.union(u).union(unreachable(activation)))
        }
    }

    /// Width (µs) at which a pulse of a given amplitude has an activation; for activation 0, the
    /// greatest width that recruits nothing. Subject to rounding, as the amplitude.
    pub fn width_for(&self, activation: S, amplitude: S::Quantity) -> (S::Quantity, PulseStatus) {
        let (amplitude, a) = self.admit_amplitude(amplitude);
        let (strength, u) = self.strength_for(activation);
        let available = S::of_quantity(amplitude, &self.per_saturation);
        // I_e/I = w/(w + c), hence w/c = I_e/(I - I_e).
        let wanted = strength.ratio((available - strength).max(S::LEAST));
        let most = self.widths.most;
        let reachable = available > strength && wanted <= S::of_quantity(most, &self.per_chronaxie);
        if reachable {
            (self.widths.clip(wanted.to_quantity(&self.chronaxie)).0, a.union(u))
        } else {
            (most, a.union(u).union(unreachable(activation)))
        }
    }

    fn admit_amplitude(&self, amplitude: S::Quantity) -> (S::Quantity, PulseStatus) {
        let range = &self.amplitudes;
        let (amplitude, a) = admit_one(range, amplitude, range.least, S::quantity_is_finite);
        let clipped = PulseStatus::AMPLITUDE_CLIPPED;
        (amplitude, flags(a, clipped, PulseStatus::AMPLITUDE_NOT_FINITE))
    }

    fn admit_width(&self, width: S::Quantity) -> (S::Quantity, PulseStatus) {
        let range = &self.widths;
        let (width, w) = admit_one(range, width, range.least, S::quantity_is_finite);
        (width, flags(w, PulseStatus::WIDTH_CLIPPED, PulseStatus::WIDTH_NOT_FINITE))
    }

    /// I_e of an activation, in saturations.
    fn strength_for(&self, activation: S) -> (S, PulseStatus) {
        let (activation, u) = admit_one(&self.activations, activation, S::ZERO, S::is_finite);
        let clipped = PulseStatus::ACTIVATION_CLIPPED;
        let status = flags(u, clipped, PulseStatus::ACTIVATION_NOT_FINITE);
        (self.threshold + self.back(activation).scaled(&self.reach), status)
    }

    /// I_e/I of a width: w/(w + c), computed as 1 - 1/(1 + w/c), which is monotonic in spite of
    /// rounding.
    fn share(&self, width: S::Quantity) -> S {
        S::ONE - (S::ONE + S::of_quantity(width, &self.per_chronaxie)).reciprocal()
    }

    /// U of x, both 0..1.
    fn rise(&self, x: S) -> S {
        halves(x, |t| self.bend(t))
    }

    /// x of U, both 0..1: each half is inverted by rotating it about its own middle.
    fn back(&self, activation: S) -> S {
        halves(activation, |u| S::ONE - self.bend(S::ONE - u))
    }

    /// t/(t + m (1 - t)) for t in 0..1. Monotonic in spite of rounding: the numerator increases
    /// with t, the denominator does not.
    fn bend(&self, t: S) -> S {
        t.ratio(self.slope - (self.slope - S::ONE) * t)
    }
}

/// A point-symmetric curve from (0, 0) to (1, 1), made of its first half.
fn halves<S: Scalar>(x: S, half: impl Fn(S) -> S) -> S {
    let first = x <= S::HALF;
    let rest = if first { x } else { S::ONE - x };
    let value = half(rest + rest).half();
    if first { value } else { S::ONE - value }
}

/// The flag if the greatest amplitude or width is returned: an activation of 0 is always reachable.
fn unreachable<S: Scalar>(activation: S) -> PulseStatus {
    if activation > S::ZERO { PulseStatus::UNREACHABLE } else { PulseStatus::empty() }
}

fn flags(admission: Admission, clipped: PulseStatus, not_finite: PulseStatus) -> PulseStatus {
    match admission {
        Admission::AsIs => PulseStatus::empty(),
        Admission::Clipped => clipped,
        Admission::NotFinite => not_finite,
    }
}
