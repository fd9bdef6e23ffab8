//! Validity ranges of inputs and state.

use crate::io::Input;
use crate::params::MuscleParams;
use crate::params::limits::{MAXIMUM_SPEED, MAXIMUM_STIMULATION_FREQUENCY};
use crate::scalar::constant::Constant;
use crate::scalar::{Arithmetic, Scalar};
use crate::status::Status;
use crate::summed::summed;
use crate::tick::admission::admit_one;
use crate::tick::range::{Range, share};

/// Greatest stimulation frequency, pps.
const HIGHEST: Constant = Constant::new(MAXIMUM_STIMULATION_FREQUENCY);
/// No stimulation, pps.
const NONE: Constant = Constant::new(0.0);
/// Greatest fascicle speed, L_ce0/s.
pub(crate) const FASTEST: Constant = Constant::new(MAXIMUM_SPEED);

/// State range of the fascicle velocity, L_ce0/s.
pub(crate) fn velocities<S: Scalar>() -> Range<S> {
    let fastest = S::constant(&FASTEST);
    Range { least: -fastest, most: fastest }
}

summed! {
    /// Validity ranges of a muscle's inputs and ranges of its state.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Domain<S: Scalar> {
        pub(crate) path_length: Range<S::PathLength>,
        /// Validity range of the filaments' equations, L_ce0.
        pub(crate) filaments: Range<S>,
        /// V_max of the slowest type, limited to the state range, L_ce0/s: above it FV of all types
        /// is valid.
        pub(crate) shortening_velocity: S,
        /// State range of the length, L_ce0: from the lower end of the validity range to the length
        /// of a muscle at rest on the longest path, plus a margin.
        pub(crate) fascicle_length: Range<S>,
        /// Intersection of `fascicle_length` and `filaments`, L_ce0: lengths that raise no flag.
        unflagged: Range<S>,
    }
}

/// Mid-tick fascicle length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MidTickLength<S> {
    /// Clamped to the state range, L_ce0.
    pub(crate) length: S,
    /// Clamped to the validity range of the filaments' equations, L_ce0.
    pub(crate) valid: S,
    /// True if neither was clamped.
    pub(crate) unclamped: bool,
}

impl<S: Scalar> Domain<S> {
    pub(crate) fn new<const N: usize>(params: &MuscleParams<N>) -> Self {
        let filaments = params.fascicle_domain();
        let paths = params.path_domain_within(S::LONGEST_PATH, S::LARGEST_COEFFICIENT);
        let longest = params.longest_fascicles(paths.1);
        Self {
            path_length: Range::new(paths, S::path_length),
            filaments: Range::new(filaments, S::from_f64),
            shortening_velocity: S::from_f64(Arithmetic::max(
                params.shortening_velocity(),
                -MAXIMUM_SPEED,
            )),
            fascicle_length: Range::new((filaments.0, longest), S::from_f64),
            unflagged: Range::new(
                (filaments.0, Arithmetic::min(filaments.1, longest)),
                S::from_f64,
            ),
        }
    }

    /// Clamps the predicted mid-tick length (L_ce0) to the state range and the validity range.
    pub(crate) fn mid_tick_length(&self, predicted: S) -> MidTickLength<S> {
        if self.unflagged.contains(predicted) {
            return MidTickLength { length: predicted, valid: predicted, unclamped: true };
        }
        let (length, _) = self.fascicle_length.clip(predicted);
        let (valid, _) = self.filaments.clip(length);
        MidTickLength { length, valid, unclamped: false }
    }

    /// True if a length (L_ce0) and a velocity (L_ce0/s) at the end of a tick raise no flag.
    pub(crate) fn raises_no_flag(&self, length: S, velocity: S) -> bool {
        self.unflagged.contains(length)
            && velocity > self.shortening_velocity
            && velocity < S::constant(&FASTEST)
    }

    /// Clamps the input to the validity ranges and returns the flags. A path length that is NaN is
    /// replaced by `path_before`.
    pub(crate) fn admit(&self, input: Input<S>, path_before: S::PathLength) -> (Input<S>, Status) {
        let (activation, a) = admit_one(&share(), input.activation, S::ZERO, S::is_finite);
        let none = S::quantity_constant(&NONE);
        let (stimulation_frequency, f) = admit_one(
            &Range { least: none, most: S::quantity_constant(&HIGHEST) },
            input.stimulation_frequency,
            none,
            S::quantity_is_finite,
        );
        let (path_length, p) =
            admit_one(&self.path_length, input.path_length, path_before, S::path_is_finite);
        let status = a
            .flags(Status::ACTIVATION_CLIPPED, Status::ACTIVATION_NOT_FINITE)
            .union(f.flags(Status::FREQUENCY_CLIPPED, Status::FREQUENCY_NOT_FINITE))
            .union(p.flags(Status::PATH_LENGTH_CLIPPED, Status::PATH_LENGTH_NOT_FINITE));
        (Input { activation, path_length, stimulation_frequency }, status)
    }
}
