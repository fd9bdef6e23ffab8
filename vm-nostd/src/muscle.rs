//! A muscle: parameters made into coefficients once, and the tick.

use crate::checksum::{Checksum, Summed, summed};
use crate::domain::Domain;
use crate::equations::force_length::{self, OptimalLength};
use crate::equations::force_velocity;
use crate::equations::passive::{Compression, Parallel};
use crate::equations::yielding::Speed;
use crate::error::{ParameterError, within};
use crate::fiber::Fiber;
use crate::io::{Input, Output};
use crate::mechanics::contraction::{Contractile, Contraction, INERTIA, Motion, largest_inertia};
use crate::params::MuscleParams;
use crate::recruitment::{
    EffectiveLength, FascicleLength, IntramuscularFes, Moment, NaturalContinuous, NaturalDiscrete,
    Recruitment, RecruitmentTick,
};
use crate::saved::{ROUNDING, RestoreError, Saved};
use crate::scalar::Scalar;
use crate::state::State;
use crate::status::Status;
use crate::tick::course::Course;
use crate::tick::range::share;
use crate::tick::time_step::TimeStep;
use core::array::from_fn;

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

/// A muscle of `N` fibre types, computed in `S`, recruited as `R` says: constant coefficients.
///
/// All that changes is in its [`State`], so that one muscle can serve several states.
#[derive(Clone, Copy, Debug)]
pub struct Muscle<S: Scalar, R: Recruitment<S, N>, const N: usize> {
    pub(crate) domain: Domain<S>,
    pub(crate) recruitment: R::Coefficients,
    pub(crate) optimal_length: OptimalLength<S>,
    pub(crate) fibers: [Fiber<S>; N],
    pub(crate) parallel: Parallel<S>,
    pub(crate) compression: Compression<S>,
    pub(crate) contraction: Contraction<S>,
    /// F0.
    force: S::Factor,
    max_isometric_force: S::Force,
    /// Ticks per second.
    tick_rate: S::Factor,
}

summed!([S: Scalar, R: Recruitment<S, N>, const N: usize] Muscle<S, R, N> { domain, recruitment, optimal_length, fibers, parallel, compression, contraction, force, max_isometric_force, tick_rate });

/// Bisections that bring a resting length to the last bit of `f32` and near that of `f64`.
const REST_BISECTIONS: usize = 48;

impl<S: Scalar, R: Recruitment<S, N, Units = ()>, const N: usize> Muscle<S, R, N> {
    /// Builds a muscle for a time step, or refuses with the name of the field, its value and the
    /// limit it broke.
    pub fn build(params: &MuscleParams<N>, step: TimeStep) -> Result<Self, ParameterError> {
        Self::build_with_units(params, &(), step)
    }
}

impl<S: Scalar, R: Recruitment<S, N>, const N: usize> Muscle<S, R, N> {
    /// Builds a muscle whose mode has motor units for a time step, or refuses with the name of the
    /// field, its value and the limit it broke.
    pub fn build_with_units(
        params: &MuscleParams<N>,
        units: &R::Units,
        step: TimeStep,
    ) -> Result<Self, ParameterError> {
        params.validate()?;
        within(INERTIA, largest_inertia(params, step), 0.0, S::LARGEST_COEFFICIENT)?;
        params.validate_magnitudes(step, S::LARGEST_COEFFICIENT, S::LONGEST_PATH)?;
        within("max_path_length", params.max_path_length, 0.0, S::LONGEST_PATH)?;
        let (least, most) = S::MAXIMAL_FORCES;
        let force = params.max_isometric_force();
        // A force that was made into a mass comes back rounded.
        let nearest = Scalar::min(Scalar::max(force, least), most);
        let rounded = (force - nearest).abs() <= 1e-9 * nearest;
        within("mass: F0, N", if rounded { nearest } else { force }, least, most)?;
        let elements = &params.elements;
        Ok(Self {
            domain: Domain::new(params),
            recruitment: R::Coefficients::new(params, units, step)?,
            optimal_length: OptimalLength::new(),
            fibers: params.fibers.map(|fiber| Fiber::new(&fiber, params.fascicle_domain(), step)),
            parallel: Parallel::new(&elements.parallel, params.maximum_fascicle_length(), step),
            compression: Compression::new(&elements.compression, step),
            contraction: Contraction::new(params, step),
            max_isometric_force: S::ONE.force(&S::force_factor(params.max_isometric_force())),
            force: S::force_factor(params.max_isometric_force()),
            tick_rate: S::factor(1.0 / step.seconds()),
        })
    }

    /// The muscle at rest on a path of so many metres, in any arithmetic; see
    /// [`rest`](Self::rest). Fixed point takes the nearest 1/512 µm.
    pub fn rest_at_metres(&self, path_length: f64) -> Result<State<S, R, N>, ParameterError> {
        let refused = |error| ParameterError { value: path_length, ..error };
        self.rest(S::path_length(path_length)).map_err(refused)
    }

    /// The muscle at rest on a path of `path_length`: not activated, not moving, tendon and
    /// parallel elastic element in balance. Refused outside of
    /// [`path_length_range`](Self::path_length_range).
    pub fn rest(&self, path_length: S::PathLength) -> Result<State<S, R, N>, ParameterError> {
        let range = &self.domain.path_length;
        let metres = S::path_metres;
        within("path_length", metres(path_length), metres(range.least), metres(range.most))?;
        let tendon = &self.contraction.tendon;
        let lengths = &self.domain.fascicle_length;
        let mut least = tendon.extension(path_length, lengths.most);
        let mut most = tendon.extension(path_length, lengths.least);
        for _ in 0..REST_BISECTIONS {
            let extension = (least + most).half();
            let length = tendon.fascicle_length(path_length, extension);
            // The tendon pulls more, and the parallel element less, the further it is extended.
            if tendon.pull(extension).force > self.parallel.at(length).0 {
                most = extension;
            } else {
                least = extension;
            }
        }
        Ok(State {
            tendon_extension: (least + most).half(),
            fascicle_velocity: S::ZERO,
            path_length,
            gains: [S::ZERO; N],
            compressed: S::ZERO,
            speed: Speed::NONE,
            yieldings: [S::ONE.lag_state(); N],
            recruitment: self.recruitment.at_rest(&self.fibers),
        })
    }

    /// Maximal isometric force F0, in N (in fixed point: mN).
    pub fn max_isometric_force(&self) -> S::Force {
        self.max_isometric_force
    }

    /// Checksum of all coefficients: it stays what it is as long as memory does. Firmware that
    /// compares it every tick sees a flipped bit before it makes a force.
    pub fn checksum(&self) -> u32 {
        let mut checksum = Checksum::EMPTY;
        self.sum(&mut checksum);
        checksum.value()
    }

    /// Shortest and longest path that are taken as they are; others are clipped and flagged.
    pub fn path_length_range(&self) -> (S::PathLength, S::PathLength) {
        (self.domain.path_length.least, self.domain.path_length.most)
    }

    /// What saved states begin with: it tells muscles apart, their modes, time steps and
    /// arithmetics.
    fn fingerprint(&self) -> u32 {
        // The time step is in the coefficients; where no bit of them differs, the muscles are the
        // same.
        let mut fingerprint = Checksum::EMPTY;
        let words = [S::ARITHMETIC, R::MODE, N as u32, self.checksum()];
        words.into_iter().for_each(|word| fingerprint.add(word));
        fingerprint.value()
    }

    /// The words to save a state of this muscle in, [`State::SAVED_WORDS`] of them: a fingerprint
    /// of the muscle, its mode, time step and arithmetic, and [`State::words`]. A muscle of other
    /// fields or whose memory has lost a bit has another fingerprint, but for a chance of 2^-32.
    pub fn save(&self, state: &State<S, R, N>) -> impl Iterator<Item = S::Bits> {
        core::iter::once(S::Bits::from(self.fingerprint())).chain(state.words())
    }

    /// A state saved by [`Muscle::save`], refused unless it is this muscle's, for this time step,
    /// and one it can be in.
    pub fn restore(
        &self,
        words: impl IntoIterator<Item = S::Bits>,
    ) -> Result<State<S, R, N>, RestoreError> {
        let length = State::<S, R, N>::SAVED_WORDS;
        let mut saved = Saved::new(words.into_iter(), length, self.fingerprint())?;
        let tendon_extension = saved.number(S::is_finite)?;
        let speeds = &self.domain.fascicle_velocity;
        let fascicle_velocity = saved.number(|value| speeds.contains(value))?;
        let path_length = saved.path::<S>(&self.domain.path_length)?;
        let rounding = S::from_f64(ROUNDING);
        let about_a_share = |value: S| share::<S>().about_contains(value, rounding);
        let compressed = saved.number(about_a_share)?;
        let speed = Speed::restored(&mut saved)?;
        let length = self.contraction.tendon.fascicle_length(path_length, tendon_extension);
        let (nearest, _) = self.domain.fascicle_length.clip(length);
        // A length that was stopped at a limit comes back with the rounding of its extension.
        if (length - nearest).abs() > S::from_f64(1e-4) {
            return Err(RestoreError::Value { word: 1 });
        }
        let mut gains = [S::ZERO; N];
        for gain in &mut gains {
            *gain = saved.number(about_a_share)?;
        }
        let mut yieldings = [S::ONE.lag_state(); N];
        for (kept, fiber) in yieldings.iter_mut().zip(&self.fibers) {
            *kept = saved.lag_state(&fiber.yielding.range())?;
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

    /// The state as an output, as it was after the tick that left it: force, length, velocity.
    pub fn observe(&self, state: &State<S, R, N>) -> Output<S> {
        let tendon = &self.contraction.tendon;
        let relative_force = tendon.pull(state.tendon_extension).force;
        Output {
            force: relative_force.force(&self.force),
            relative_force,
            fascicle_length: tendon.fascicle_length(state.path_length, state.tendon_extension),
            fascicle_velocity: state.fascicle_velocity,
            status: Status::empty(),
        }
    }

    /// Steps one tick. Never fails; no loop depends on data; what had to be saturated is in the
    /// output's status, and the state stays finite whatever comes.
    ///
    /// Slow quantities (excitation, sag, yield, activation, the lengths' influence) are taken at
    /// the middle of the tick and change across it as they did since the middle before; the
    /// mechanics are then integrated implicitly on top of them.
    pub fn step(&self, state: &mut State<S, R, N>, input: Input<S>) -> Output<S> {
        let (input, mut status) = self.domain.admit(input, state.path_length);
        let tendon = &self.contraction.tendon;

        let length = tendon.fascicle_length(state.path_length, state.tendon_extension);
        let travel = self.contraction.lengthening(state.fascicle_velocity);
        let midway = self.domain.midway(length + travel.half());
        let yieldings = self.yieldings(state);
        let reciprocal = midway.inside.reciprocal();
        let moment =
            Moment { input, fascicle_length: midway.length, travel, reciprocal, yieldings };
        let contractile = self.contractile(state, &moment, length, midway.inside);

        let stretch = tendon.stretch(state.path_length, input.path_length);
        let extension = Course { middle: state.tendon_extension + stretch.half(), change: stretch };
        let end = self.contraction.advance::<R::Coefficients, N>(
            state.fascicle_velocity,
            extension,
            &contractile,
        );
        status.set(Status::MECHANICS_UNSETTLED, !end.settled);
        status.set(Status::FASCICLE_VELOCITY_LIMITED, end.velocity_limited);
        state.speed = end.speed;
        let Motion { travel, velocity } = end.motion;
        state.path_length = input.path_length;
        state.fascicle_velocity = velocity;
        state.tendon_extension =
            state.tendon_extension + stretch - self.contraction.lengthening(travel);
        let length = tendon.fascicle_length(state.path_length, state.tendon_extension);
        if !(midway.usual && self.domain.is_usual(length, velocity)) {
            status |= self.confine(state, length, midway.length);
        }

        let tendon_pull = tendon.pull(state.tendon_extension);
        status.set(Status::TENDON_FORCE_LIMITED, tendon_pull.saturated);
        Output {
            force: tendon_pull.force.force(&self.force),
            relative_force: tendon_pull.force,
            fascicle_length: tendon.fascicle_length(state.path_length, state.tendon_extension),
            fascicle_velocity: state.fascicle_velocity,
            status,
        }
    }

    /// Keeps `length` and velocity inside what the state can hold, and says what it had to keep,
    /// and whether the filaments' equations held at the tick's `middle` and at its end.
    fn confine(&self, state: &mut State<S, R, N>, length: S, middle: S) -> Status {
        let tendon = &self.contraction.tendon;
        let (length, stopped) = self.domain.fascicle_length.clip(length);
        if stopped {
            state.tendon_extension = tendon.extension(state.path_length, length);
            state.fascicle_velocity = S::ZERO;
        }
        let speeds = &self.domain.fascicle_velocity;
        let (velocity, _) = speeds.clip(state.fascicle_velocity);
        state.fascicle_velocity = velocity;
        let mut status = Status::empty();
        status.set(Status::FASCICLE_LENGTH_LIMITED, stopped);
        let held = velocity >= speeds.most || velocity <= speeds.least;
        status.set(Status::FASCICLE_VELOCITY_LIMITED, held);
        // The coefficients were taken at the middle, the state is left at the end.
        let outside = |length| !self.domain.filaments.contains(length);
        let too_fast = velocity < self.domain.shortening_velocity;
        status.set(Status::FASCICLE_OUTSIDE_DOMAIN, outside(middle) || outside(length) || too_fast);
        status
    }

    /// Y of each type at the middle of the tick that begins. It is brought to that beginning by the
    /// speed in the last tick, and goes on for half of this one as it did in the last.
    fn yieldings(&self, state: &mut State<S, R, N>) -> [S; N] {
        let mut middles = [S::ONE; N];
        let kept = state.yieldings.iter_mut().zip(&self.fibers);
        for (middle, (kept, fiber)) in middles.iter_mut().zip(kept) {
            let before = S::of(*kept);
            *kept = fiber.yielding.advance(*kept, &state.speed);
            let start = S::of(*kept);
            *middle = start + (start - before).half();
        }
        middles
    }

    /// Advances recruitment, and puts together the contractile element during the tick of a
    /// `moment`, whose fascicles are at `start` when it starts and, where the filaments' equations
    /// hold, `inside` at its middle (all L_ce0).
    ///
    /// Gains are taken at the middles of the ticks, and change across a tick by as much as from the
    /// middle before to this one: their slopes by length, frequency and recruitment need not be
    /// known.
    fn contractile(
        &self,
        state: &mut State<S, R, N>,
        moment: &Moment<S, N>,
        start: S,
        inside: S,
    ) -> Contractile<'_, S, N> {
        let Moment { fascicle_length: middle, travel, .. } = *moment;
        let distance = self.optimal_length.distance(inside);
        let (parallel, parallel_slope) = self.parallel.at(middle);
        let (compression, compression_slope) = self.compression.at(middle);
        let recruited = self.recruitment.advance(&self.fibers, &mut state.recruitment, moment);
        let force_lengths =
            force_length::at(self.fibers.each_ref().map(|fiber| &fiber.force_length), &distance);
        let active: [S; N] = from_fn(|i| recruited[i].activation * force_lengths[i]);
        let kept = state.gains;
        state.gains = from_fn(|i| recruited[i].weight * active[i]);
        let gains = from_fn(|i| {
            let gain = state.gains[i];
            let jump = recruited[i].change_after_jump;
            let change = jump.map_or(gain - kept[i], |weight| weight * active[i]);
            // A gain that falls fast would pass 0 before the tick's end.
            Course { middle: gain, change: change.max(-(gain + gain)) }
        });
        let compressed = recruited
            .iter()
            .fold(S::ZERO, |sum, of_type| sum + of_type.compression_weight * of_type.activation);
        let jumps = recruited.iter().any(|of_type| of_type.change_after_jump.is_some());
        let change = if jumps { S::ZERO } else { compressed - state.compressed };
        state.compressed = compressed;
        let compressed = Course { middle: compressed, change };
        let passive_slope = parallel_slope + compressed.middle * compression_slope;
        let passive_at_middle = parallel + compressed.middle * compression;
        Contractile {
            gains,
            fibers: &self.fibers,
            curves: force_velocity::curves(
                self.fibers.each_ref().map(|fiber| &fiber.force_velocity),
                inside,
                travel,
            ),
            passive: Course {
                middle: passive_at_middle
                    + passive_slope * (start - middle).scaled(&self.tick_rate),
                change: compressed.change * compression,
            },
            passive_slope,
        }
    }
}
