//! The tick of a muscle.

use crate::domain::velocities;
use crate::equations::force_length::{self, Distance};
use crate::equations::force_velocity;
use crate::io::{Input, Output};
use crate::mechanics::contraction::{Contractile, Motion};
use crate::muscle::Muscle;
use crate::recruitment::{Moment, Recruitment, RecruitmentTick};
use crate::scalar::Scalar;
use crate::state::State;
use crate::status::Status;
use crate::tick::course::Course;
use core::array::from_fn;

impl<S: Scalar, R: Recruitment<S, N>, const N: usize> Muscle<S, R, N> {
    /// Advances the state by one tick. Never fails; the number of iterations is fixed; the output's
    /// status flags what was clipped or clamped; the state stays finite for any input.
    ///
    /// Slow quantities (excitation, sag, yield, activation, factors that depend on length) are
    /// evaluated at mid-tick and extrapolated linearly across the tick, with their change since the
    /// last mid-tick. The mechanics are then integrated implicitly. The fine class does so for each
    /// of some equal parts of a long tick, in which the path is linear.
    pub fn step(&self, state: &mut State<S, R, N>, input: Input<S>) -> Output<S> {
        if self.parts > 1 {
            return self.step_in_parts(state, input);
        }
        self.part(state, input)
    }

    #[cold]
    #[inline(never)]
    fn step_in_parts(&self, state: &mut State<S, R, N>, input: Input<S>) -> Output<S> {
        let (input, mut status) = self.domain.admit(input, state.path_length);
        for left in (2..=self.parts).rev() {
            let path_length = S::path_towards(state.path_length, input.path_length, left);
            status |= self.part(state, Input { path_length, ..input }).status;
        }
        let mut output = self.part(state, input);
        output.status |= status;
        output
    }

    /// A tick, or a part of one.
    fn part(&self, state: &mut State<S, R, N>, input: Input<S>) -> Output<S> {
        let (input, mut status) = self.domain.admit(input, state.path_length);
        let tendon = &self.contraction.tendon;

        let extension = S::of(state.tendon_extension);
        let length = tendon.fascicle_length(state.path_length, extension);
        let travel = self.contraction.lengthening(state.fascicle_velocity);
        let middle = self.domain.mid_tick_length(length + travel.half());
        let yieldings = self.yieldings(state);
        let reciprocal = middle.valid.reciprocal();
        let moment =
            Moment { input, fascicle_length: middle.length, travel, reciprocal, yieldings };
        let contractile = self.contractile(state, &moment, length, middle.valid);

        let stretch = tendon.stretch(state.path_length, input.path_length);
        let extension = Course { middle: extension + stretch.half(), change: stretch };
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
            self.contraction.stretched(state.tendon_extension, stretch, travel);
        let extension = S::of(state.tendon_extension);
        let length = tendon.fascicle_length(state.path_length, extension);
        if !(middle.unclamped && self.domain.raises_no_flag(length, velocity)) {
            status |= self.clamp_state(state, length, middle.length);
        }

        let extension = S::of(state.tendon_extension);
        let tendon_pull = tendon.pull(extension);
        status.set(Status::TENDON_FORCE_LIMITED, tendon_pull.saturated);
        Output {
            force: tendon_pull.force.force(&self.force),
            relative_force: tendon_pull.force,
            fascicle_length: tendon.fascicle_length(state.path_length, extension),
            fascicle_velocity: state.fascicle_velocity,
            status,
        }
    }

    /// Clamps `length` and velocity to the state range. Returns flags for what was clamped, and a
    /// flag if the mid-tick length (`middle`), the length or the velocity is outside the validity
    /// range of the filaments' equations.
    fn clamp_state(&self, state: &mut State<S, R, N>, length: S, middle: S) -> Status {
        let tendon = &self.contraction.tendon;
        let (length, length_limited) = self.domain.fascicle_length.clip(length);
        if length_limited {
            state.tendon_extension = tendon.extension(state.path_length, length).wide();
            state.fascicle_velocity = S::ZERO;
        }
        let speeds = velocities::<S>();
        let (velocity, _) = speeds.clip(state.fascicle_velocity);
        state.fascicle_velocity = velocity;
        let mut status = Status::empty();
        status.set(Status::FASCICLE_LENGTH_LIMITED, length_limited);
        let velocity_limited = velocity >= speeds.most || velocity <= speeds.least;
        status.set(Status::FASCICLE_VELOCITY_LIMITED, velocity_limited);
        // The coefficients depend on the mid-tick length, the output on the length at the end.
        let outside = |length| !self.domain.filaments.contains(length);
        let too_fast = velocity < self.domain.shortening_velocity;
        status.set(Status::FASCICLE_OUTSIDE_DOMAIN, outside(middle) || outside(length) || too_fast);
        status
    }

    /// Mid-tick Y of each type. Y is advanced to the start of this tick with the speed during the
    /// last one, and extrapolated linearly by half a tick.
    fn yieldings(&self, state: &mut State<S, R, N>) -> [S; N] {
        let mut middles = [S::ONE; N];
        let starts = state.yieldings.iter_mut().zip(&self.fibers);
        for (middle, (yielding, fiber)) in middles.iter_mut().zip(starts) {
            let before = S::of(*yielding);
            *yielding = fiber.yielding.advance(*yielding, &state.speed);
            let start = S::of(*yielding);
            *middle = start + (start - before).half();
        }
        middles
    }

    /// Advances recruitment and returns the contractile element during the tick. `start` is the
    /// fascicle length at the start of the tick, `valid` the mid-tick length clamped to the
    /// validity range of the filaments' equations (L_ce0).
    ///
    /// Gains are evaluated at mid-tick. Their change across the tick is taken to be that since the
    /// last mid-tick, so that no slopes with respect to length, frequency and recruitment are
    /// needed.
    fn contractile(
        &self,
        state: &mut State<S, R, N>,
        moment: &Moment<S, N>,
        start: S,
        valid: S,
    ) -> Contractile<'_, S, N> {
        let Moment { fascicle_length: middle, travel, .. } = *moment;
        let distance = Distance::new(valid);
        let (parallel, parallel_slope) = self.parallel.at(middle);
        let (compression, compression_slope) = self.compression.at(middle);
        let recruited = self.recruitment.advance(&self.fibers, &mut state.recruitment, moment);
        let force_lengths =
            force_length::at(self.fibers.each_ref().map(|fiber| &fiber.force_length), &distance);
        let active: [S; N] = from_fn(|i| recruited[i].activation * force_lengths[i]);
        let last_gains = state.gains;
        state.gains = from_fn(|i| recruited[i].weight * active[i]);
        let gains = from_fn(|i| {
            let gain = state.gains[i];
            let jump = recruited[i].change_after_jump;
            let change = jump.map_or(gain - last_gains[i], |weight| weight * active[i]);
            // Extrapolation must not make a fast-falling gain negative at the end of the tick.
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
                valid,
                travel,
            ),
            passive: Course {
                middle: passive_at_middle
                    + passive_slope * (start - middle).scaled(&self.part_rate),
                change: compressed.change * compression,
            },
            passive_slope,
        }
    }
}
