//! Where inputs and state must stay, and the flags that say when they had to be kept there.

use crate::checksum::{Summed, summed};
use crate::muscle::Input;
use crate::params::MuscleParams;
use crate::scalar::Scalar;
use core::ops::Add;

bitflags::bitflags! {
    /// What a tick had to saturate; empty when inputs and state were inside the domain.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct Status: u16 {
        /// Activation was outside 0..1 and was clipped.
        const ACTIVATION_CLIPPED = 1 << 0;
        /// Activation was not a number (taken as 0) or infinite (clipped).
        const ACTIVATION_NOT_FINITE = 1 << 1;
        /// Stimulation frequency was outside 0..500 pps and was clipped.
        const FREQUENCY_CLIPPED = 1 << 2;
        /// Stimulation frequency was not a number (taken as 0) or infinite (clipped).
        const FREQUENCY_NOT_FINITE = 1 << 3;
        /// Path length was outside the muscle's range and was clipped: shorter than a slack tendon
        /// with the fascicles at FV's pole, or longer than any activation could hold with n_f still
        /// defined, or beyond what the arithmetic holds.
        /// [`MuscleParams::path_domain`](crate::MuscleParams::path_domain) has the rules.
        const PATH_LENGTH_CLIPPED = 1 << 4;
        /// Path length was not a number (the one before was kept) or infinite (clipped).
        const PATH_LENGTH_NOT_FINITE = 1 << 5;
        /// The fascicles left the range of lengths, or shortened faster than V_max of a type, so
        /// that force-length, force-velocity or activation-frequency relation do not hold; they
        /// were taken at the edge of their range.
        const FASCICLE_OUTSIDE_DOMAIN = 1 << 6;
        /// The fascicles were stopped at the least or greatest length the state can have.
        const FASCICLE_LENGTH_LIMITED = 1 << 7;
        /// The fascicles were held at the greatest speed the state can have, 60 L_ce0/s.
        const FASCICLE_VELOCITY_LIMITED = 1 << 8;
        /// The forces on the fascicles were out of balance by more than half of F0 at the velocity
        /// foreseen for a substep, as when a path jumps: force is less accurate.
        const MECHANICS_UNSETTLED = 1 << 9;
        /// The tendon is extended by more than the arithmetic can tell: its force was taken at
        /// the most that it can. Only in fixed point, and at no less than ten times F0.
        const TENDON_FORCE_LIMITED = 1 << 10;
        /// No activation holds the force that was asked for: the answer is the nearest. Never set
        /// by a tick.
        const FORCE_UNREACHABLE = 1 << 11;
    }
}

/// Greatest stimulation frequency, pps.
pub(crate) const MAXIMUM_STIMULATION_FREQUENCY: f64 = 500.0;
/// Greatest fascicle speed, L_ce0/s.
pub(crate) const MAXIMUM_SPEED: f64 = 60.0;

/// A closed range.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Range<S> {
    pub(crate) least: S,
    pub(crate) most: S,
}

summed!([S: Summed] Range<S> { least, most });

impl<T: Copy + PartialOrd> Range<T> {
    pub(crate) fn new((least, most): (f64, f64), nearest: impl Fn(f64) -> T) -> Self {
        Self { least: nearest(least), most: nearest(most) }
    }

    /// The nearest value in the range, and whether that is another one; the least for
    /// not-a-number.
    pub(crate) fn clip(&self, value: T) -> (T, bool) {
        let raised = if value > self.least { value } else { self.least };
        let clipped = if raised < self.most { raised } else { self.most };
        (clipped, clipped != value)
    }

    /// Whether a value is in the range or out of it by no more than rounding may take it.
    pub(crate) fn about_contains(&self, value: T, rounding: T) -> bool
    where
        T: Add<Output = T>,
    {
        value + rounding >= self.least && value <= self.most + rounding
    }

    pub(crate) fn contains(&self, value: T) -> bool {
        value >= self.least && value <= self.most
    }
}

/// The stated domain of a muscle's inputs and state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Domain<S: Scalar> {
    pub(crate) activation: Range<S>,
    pub(crate) stimulation_frequency: Range<S::Quantity>,
    pub(crate) path_length: Range<S::PathLength>,
    /// Where the equations of the filaments hold, L_ce0.
    pub(crate) filaments: Range<S>,
    /// The slowest V_max of the types, or the greatest speed there is, L_ce0/s: FV of all types
    /// holds above.
    pub(crate) shortening_velocity: S,
    /// What the state can hold, L_ce0: from the shortest at which the equations hold to what a
    /// muscle at rest on the longest path is stretched to, and a little more.
    pub(crate) fascicle_length: Range<S>,
    /// L_ce0/s.
    pub(crate) fascicle_velocity: Range<S>,
    /// Lengths that the state can hold and where the equations of the filaments hold, L_ce0.
    usual: Range<S>,
}

/// Where the fascicles are at the middle of a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Midway<S> {
    /// As near as the state can hold, L_ce0.
    pub(crate) length: S,
    /// The nearest to that where the equations of the filaments hold, L_ce0.
    pub(crate) inside: S,
    /// Neither had to be changed.
    pub(crate) usual: bool,
}

summed!([S: Scalar] Domain<S> { activation, stimulation_frequency, path_length, filaments, shortening_velocity, fascicle_length, fascicle_velocity, usual });

impl<S: Scalar> Domain<S> {
    pub(crate) fn new<const N: usize>(params: &MuscleParams<N>) -> Self {
        let filaments = params.fascicle_domain();
        let paths = params.path_domain_within(S::LONGEST_PATH, S::LARGEST_COEFFICIENT);
        let longest = params.longest_fascicles(paths.1);
        Self {
            activation: Range::new((0.0, 1.0), S::from_f64),
            stimulation_frequency: Range::new((0.0, MAXIMUM_STIMULATION_FREQUENCY), S::quantity),
            path_length: Range::new(paths, S::path_length),
            filaments: Range::new(filaments, S::from_f64),
            shortening_velocity: S::from_f64(Scalar::max(
                params.shortening_velocity(),
                -MAXIMUM_SPEED,
            )),
            fascicle_length: Range::new((filaments.0, longest), S::from_f64),
            fascicle_velocity: Range::new((-MAXIMUM_SPEED, MAXIMUM_SPEED), S::from_f64),
            usual: Range::new((filaments.0, Scalar::min(filaments.1, longest)), S::from_f64),
        }
    }

    /// Where the fascicles are taken to be, of whose middle of a tick a length (L_ce0) was
    /// foreseen.
    pub(crate) fn midway(&self, length: S) -> Midway<S> {
        if self.usual.contains(length) {
            return Midway { length, inside: length, usual: true };
        }
        let (length, _) = self.fascicle_length.clip(length);
        let (inside, _) = self.filaments.clip(length);
        Midway { length, inside, usual: false }
    }

    /// Whether nothing has to be said of a length (L_ce0) and a velocity (L_ce0/s) at a tick's end.
    pub(crate) fn is_usual(&self, length: S, velocity: S) -> bool {
        self.usual.contains(length)
            && velocity > self.shortening_velocity
            && velocity < self.fascicle_velocity.most
    }

    /// The input as the model takes it, and what had to be changed.
    pub(crate) fn admit(&self, input: Input<S>, path_before: S::PathLength) -> (Input<S>, Status) {
        let (activation, a) = admit_one(&self.activation, input.activation, S::ZERO, S::is_finite);
        let (stimulation_frequency, f) = admit_one(
            &self.stimulation_frequency,
            input.stimulation_frequency,
            self.stimulation_frequency.least,
            S::quantity_is_finite,
        );
        let (path_length, p) =
            admit_one(&self.path_length, input.path_length, path_before, S::path_is_finite);
        let status = a.flags(Status::ACTIVATION_CLIPPED, Status::ACTIVATION_NOT_FINITE)
            | f.flags(Status::FREQUENCY_CLIPPED, Status::FREQUENCY_NOT_FINITE)
            | p.flags(Status::PATH_LENGTH_CLIPPED, Status::PATH_LENGTH_NOT_FINITE);
        (Input { activation, path_length, stimulation_frequency }, status)
    }
}

/// What was wrong with an input.
#[derive(Clone, Copy)]
pub(crate) enum Admission {
    AsIs,
    Clipped,
    NotFinite,
}

impl Admission {
    fn flags(self, clipped: Status, not_finite: Status) -> Status {
        match self {
            Self::AsIs => Status::empty(),
            Self::Clipped => clipped,
            Self::NotFinite => not_finite,
        }
    }
}

/// A value as a range admits it, and what was wrong with it; `instead` is taken for not-a-number.
pub(crate) fn admit_one<T: Copy + PartialOrd>(
    range: &Range<T>,
    value: T,
    instead: T,
    is_finite: impl Fn(T) -> bool,
) -> (T, Admission) {
    if range.contains(value) {
        return (value, Admission::AsIs);
    }
    let is_number = value.partial_cmp(&value).is_some();
    let (clipped, _) = range.clip(if is_number { value } else { instead });
    (clipped, if is_finite(value) { Admission::Clipped } else { Admission::NotFinite })
}
