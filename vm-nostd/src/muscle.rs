//! A muscle: its coefficients, computed once from the parameters.

use crate::checksum::Checksum;
use crate::domain::{Domain, velocities};
use crate::equations::passive::{Compression, Parallel};
use crate::equations::tendon::logarithm;
use crate::equations::yielding::Speed;
use crate::error::{Limit, ParameterError, within};
use crate::fiber::Fiber;
use crate::io::Output;
use crate::mechanics::contraction::{Contraction, INERTIA, largest_inertia};
use crate::params::MuscleParams;
use crate::recruitment::{
    EffectiveLength, FascicleLength, IntramuscularFes, NaturalContinuous, NaturalDiscrete,
    Recruitment, RecruitmentTick,
};
use crate::saved::{ROUNDING, RestoreError, Saved};
use crate::scalar::{Arithmetic, Kernels, MOST_PARTS, Scalar};
use crate::state::State;
use crate::status::Status;
use crate::summed::{Summed, summed};
use crate::tick::range::share;
use crate::tick::time_step::TimeStep;

/// A muscle of `N` fibre types under natural continuous recruitment.
pub type ContinuousMuscle<S, const N: usize> = Muscle<S, NaturalContinuous, N>;
/// A muscle of `N` fibre types under intramuscular FES.
pub type FesMuscle<S, const N: usize> = Muscle<S, IntramuscularFes, N>;

/// A muscle of `N` fibre types and at most `UNITS` motor units under natural discrete recruitment.
pub type DiscreteMuscle<S, const N: usize, const UNITS: usize> =
    Muscle<S, NaturalDiscrete<FascicleLength, UNITS>, N>;
/// The same with an effective length of each unit (VM 3.x).
pub type EffectiveLengthMuscle<S, const N: usize, const UNITS: usize> =
    Muscle<S, NaturalDiscrete<EffectiveLength, UNITS>, N>;

summed! {
    /// Coefficients of a muscle of `N` fibre types with arithmetic `S` and recruitment mode `R`.
    ///
    /// They are constant; everything that changes is in a [`State`]. One muscle can be used with
    /// several states.
    #[derive(Clone, Copy, Debug)]
    pub struct Muscle<S: Scalar, R: Recruitment<S, N>, const N: usize> {
        pub(crate) domain: Domain<S>,
        pub(crate) recruitment: R::Coefficients,
        pub(crate) fibers: [Fiber<S>; N],
        pub(crate) parallel: Parallel<S>,
        pub(crate) compression: Compression<S>,
        pub(crate) contraction: Contraction<S>,
        /// F0, as a factor from relative force to force.
        pub(crate) force: S::Factor,
        max_isometric_force: S::Force,
        /// Logarithm of the ratio of the scales of tendon and parallel force, cT kT/(c1 k1).
        scales: S,
        /// Parts of a tick per second.
        pub(crate) part_rate: S::Factor,
        /// Number of parts of a tick; coefficients are those of a part.
        pub(crate) parts: u8,
    }

    valid: |muscle| (1..=MOST_PARTS).contains(&muscle.parts)
}

/// Number of bisections for the length at rest: accurate to the last bit in `f32`, nearly so in
/// `f64`.
const REST_BISECTIONS: usize = 48;

impl<S: Scalar, R: Recruitment<S, N, Units = ()>, const N: usize> Muscle<S, R, N> {
    /// Builds a muscle for a time step. An error gives the name of the field, its value and the
    /// limit.
    pub fn build(params: &MuscleParams<N>, step: TimeStep) -> Result<Self, ParameterError> {
        Self::build_with_units(params, &(), step)
    }
}

impl<S: Scalar, R: Recruitment<S, N>, const N: usize> Muscle<S, R, N> {
    /// Builds a muscle with motor units for a time step. An error gives the name of the field, its
    /// value and the limit.
    pub fn build_with_units(
        params: &MuscleParams<N>,
        units: &R::Units,
        step: TimeStep,
    ) -> Result<Self, ParameterError> {
        params.validate()?;
        let parts = params.class.parts(step);
        let step = step.part(parts);
        within(INERTIA, largest_inertia(params, step), 0.0, S::LARGEST_COEFFICIENT)?;
        params.validate_magnitudes(step, S::LARGEST_COEFFICIENT, S::LONGEST_PATH)?;
        within("max_path_length", params.max_path_length, 0.0, S::LONGEST_PATH)?;
        let (least, most) = S::MAXIMAL_FORCES;
        let force = params.max_isometric_force();
        // F0 at a limit may be outside it by rounding if the mass was computed from F0.
        let nearest = Arithmetic::min(Arithmetic::max(force, least), most);
        let rounded = (force - nearest).abs() <= 1e-9 * nearest;
        within("mass: F0, N", if rounded { nearest } else { force }, least, most)?;
        let elements = &params.elements;
        Ok(Self {
            domain: Domain::new(params),
            recruitment: R::Coefficients::new(params, units, step)?,
            fibers: params.fibers.map(|fiber| Fiber::new(&fiber, params.fascicle_domain(), step)),
            parallel: Parallel::new(&elements.parallel, params.maximum_fascicle_length(), step),
            compression: Compression::new(&elements.compression, step),
            contraction: Contraction::new(params, step),
            max_isometric_force: S::ONE.force(&S::force_factor(params.max_isometric_force())),
            force: S::force_factor(params.max_isometric_force()),
            scales: S::from_f64(Kernels::ln(elements.tendon.scale() / elements.parallel.scale())),
            part_rate: S::factor(1.0 / step.seconds()),
            parts,
        })
    }

    /// The muscle at rest at a path length in m, in any arithmetic; see [`rest`](Self::rest). Fixed
    /// point rounds to the nearest 1/512 µm.
    pub fn rest_at_metres(&self, path_length: f64) -> Result<State<S, R, N>, ParameterError> {
        let in_metres = |error| ParameterError { value: path_length, ..error };
        self.rest(S::path_length(path_length)).map_err(in_metres)
    }

    /// The muscle at rest at a path length: zero activation, zero velocity, and tendon force equal
    /// to that of the parallel elastic element. Returns an error outside
    /// [`path_length_range`](Self::path_length_range).
    pub fn rest(&self, path_length: S::PathLength) -> Result<State<S, R, N>, ParameterError> {
        self.rest_in_range(path_length).ok_or_else(|| {
            let range = &self.domain.path_length;
            let [value, least, most] = [path_length, range.least, range.most].map(S::path_metres);
            let limit = Limit::Within { least, most };
            ParameterError { field: "path_length", fiber: None, value, limit }
        })
    }

    /// The same without the details of an error, and thus without `f64`: `None` outside
    /// [`path_length_range`](Self::path_length_range).
    pub fn rest_in_range(&self, path_length: S::PathLength) -> Option<State<S, R, N>> {
        if !self.domain.path_length.contains(path_length) {
            return None;
        }
        let tendon = &self.contraction.tendon;
        let lengths = &self.domain.fascicle_length;
        let mut least = tendon.extension(path_length, lengths.most);
        let mut most = tendon.extension(path_length, lengths.least);
        for _ in 0..REST_BISECTIONS {
            let extension = (least + most).half();
            let length = tendon.fascicle_length(path_length, extension);
            // With the extension of the tendon its force rises and that of the parallel element
            // falls. If both are slack, their logarithms resolve them best.
            let pull = tendon.in_toes(extension);
            let passive = self.parallel.in_toes(length);
            let pulls_more = match (logarithm(pull), logarithm(passive)) {
                (Some(pull), Some(passive)) => pull + self.scales > passive,
                _ => tendon.force_of(pull.1) > self.parallel.force_of(passive.1),
            };
            if pulls_more {
                most = extension;
            } else {
                least = extension;
            }
        }
        Some(State {
            tendon_extension: (least + most).half().wide(),
            fascicle_velocity: S::ZERO,
            path_length,
            gains: [S::ZERO; N],
            compressed: S::ZERO,
            speed: Speed::NONE,
            yieldings: [S::ONE.wide(); N],
            recruitment: self.recruitment.at_rest(&self.fibers),
        })
    }

    /// Maximal isometric force F0: N in floating point, mN in fixed point.
    pub fn max_isometric_force(&self) -> S::Force {
        self.max_isometric_force
    }

    /// Checksum of all coefficients. Firmware that compares it every tick detects a flipped bit in
    /// memory before the bit affects a force.
    pub fn checksum(&self) -> u32 {
        let mut checksum = Checksum::EMPTY;
        self.sum(&mut checksum);
        checksum.value()
    }

    /// Shortest and longest valid path; path lengths outside are clipped and flagged.
    pub fn path_length_range(&self) -> (S::PathLength, S::PathLength) {
        (self.domain.path_length.least, self.domain.path_length.most)
    }

    /// Fingerprint of muscle, mode, time step and arithmetic: the first word of a saved state.
    fn fingerprint(&self) -> u32 {
        // The coefficients depend on the time step. Muscles with equal coefficients are equivalent.
        let mut fingerprint = Checksum::EMPTY;
        let words = [S::ARITHMETIC, R::MODE, N as u32, self.checksum()];
        words.into_iter().for_each(|word| fingerprint.add(word));
        fingerprint.value()
    }

    /// The [`State::SAVED_WORDS`] words of a saved state of this muscle: a fingerprint of the
    /// muscle, mode, time step and arithmetic, then [`State::words`]. With other parameters or
    /// after a bit flip in memory, the fingerprint differs, with an error probability of 2^-32.
    pub fn save(&self, state: &State<S, R, N>) -> impl Iterator<Item = S::Bits> {
        core::iter::once(S::Bits::from(self.fingerprint())).chain(state.words())
    }

    /// Restores a state saved by [`Muscle::save`]. Returns an error if the number of words is
    /// wrong, if the fingerprint is not that of this muscle, or if a value is out of range.
    pub fn restore(
        &self,
        words: impl IntoIterator<Item = S::Bits>,
    ) -> Result<State<S, R, N>, RestoreError> {
        let length = State::<S, R, N>::SAVED_WORDS;
        let mut saved = Saved::new(words.into_iter(), length, self.fingerprint())?;
        let tendon_extension = saved.wide_if(S::is_finite)?;
        let speeds = velocities::<S>();
        let fascicle_velocity = saved.number(|value| speeds.contains(value))?;
        let path_length = saved.path::<S>(&self.domain.path_length)?;
        let rounding = S::from_f64(ROUNDING);
        let is_share = |value: S| share::<S>().contains_within(value, rounding);
        let compressed = saved.number(is_share)?;
        let speed = Speed::restored(&mut saved)?;
        let tendon = &self.contraction.tendon;
        let length = tendon.fascicle_length(path_length, S::of(tendon_extension));
        let (nearest, _) = self.domain.fascicle_length.clip(length);
        // A length clamped to a limit may be outside it by the rounding of the extension.
        if (length - nearest).abs() > S::from_f64(1e-4) {
            return Err(RestoreError::Value { word: 1 });
        }
        let mut gains = [S::ZERO; N];
        for gain in &mut gains {
            *gain = saved.number(is_share)?;
        }
        let mut yieldings = [S::ONE.wide(); N];
        for (yielding, fiber) in yieldings.iter_mut().zip(&self.fibers) {
            *yielding = saved.wide(&fiber.yielding.range())?;
        }
        let recruitment = self.recruitment.restored(&self.fibers, &mut saved)?;
        saved.finished()?;
        Ok(State {
            tendon_extension,
            fascicle_velocity,
            path_length,
            gains,
            compressed,
            speed,
            yieldings,
            recruitment,
        })
    }

    /// Output of a state without a tick: force, fascicle length and velocity, and no flags.
    pub fn observe(&self, state: &State<S, R, N>) -> Output<S> {
        let tendon = &self.contraction.tendon;
        let extension = S::of(state.tendon_extension);
        let relative_force = tendon.pull(extension).force;
        Output {
            force: relative_force.force(&self.force),
            relative_force,
            fascicle_length: tendon.fascicle_length(state.path_length, extension),
            fascicle_velocity: state.fascicle_velocity,
            status: Status::empty(),
        }
    }
}
