//! A neuromuscular prosthesis: two EMGs drive two virtual antagonists whose torque and stiffness
//! command the joint.
//!
//! EMG -> [`Envelope`] -> natural continuous muscles on the measured angle -> τ = Σ F r and
//! K = Σ (k r² - F dr/dq), each tick.

use super::envelope::{Envelope, EnvelopeParams, EnvelopeState};
use super::joint::{Joint, JointError, JointMuscle, JointStatus, TORQUE_UNIT};
use super::limit::{CommandLimits, Limited, Limiter};
use super::path_params::{AngleRange, PathParams};
use super::saved::{Parts, fingerprint};
use crate::checksum::Checksum;
use crate::error::ParameterError;
use crate::io::Input;
use crate::muscle::ContinuousMuscle;
use crate::params::MuscleParams;
use crate::recruitment::NaturalContinuous;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::state::State;
use crate::status::Status;
use crate::summed::{Summed, summed};
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

bitflags::bitflags! {
    /// What a tick of a prosthesis had to saturate.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct ProsthesisStatus: u16 {
        /// An EMG sample was not a number, or beyond 8 times the range of its envelope.
        const EMG_INVALID = 1 << 0;
        /// The angle was outside the joint's range and was clipped.
        const ANGLE_CLIPPED = 1 << 1;
        /// The angle was not finite; that of the tick before was kept.
        const ANGLE_NOT_FINITE = 1 << 2;
        /// The torque was outside its limits.
        const TORQUE_LIMITED = 1 << 3;
        /// The torque changed faster than its rate limit.
        const TORQUE_RATE_LIMITED = 1 << 4;
        /// The stiffness was outside its limits; negative stiffness counts as the least.
        const STIFFNESS_LIMITED = 1 << 5;
        /// The stiffness changed faster than its rate limit.
        const STIFFNESS_RATE_LIMITED = 1 << 6;
        /// A muscle raised a flag of its own, in [`ProsthesisCommand::muscles`].
        const MUSCLE = 1 << 7;
    }
}

/// Parameters of a prosthesis with a flexor and an extensor, in this order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProsthesisParams<const N: usize> {
    /// Range of the joint.
    pub range: AngleRange,
    /// Muscles.
    pub muscles: [MuscleParams<N>; 2],
    /// Their paths.
    pub paths: [PathParams<1>; 2],
    /// Their EMGs.
    pub envelopes: [EnvelopeParams; 2],
    /// Torque, N m and N m/s.
    pub torque: CommandLimits,
    /// Stiffness, N m/rad and N m/rad/s.
    pub stiffness: CommandLimits,
}

/// Inputs of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProsthesisInput<S: Scalar> {
    /// EMG of flexor and extensor, mV.
    pub emg: [S::Quantity; 2],
    /// Measured angle, rad.
    pub angle: S,
}

/// What a tick commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProsthesisCommand<S: Scalar> {
    /// Torque, N m; flexion is positive.
    pub torque: S::Quantity,
    /// Stiffness about the measured angle, N m/rad.
    pub stiffness: S::Quantity,
    /// Activations of flexor and extensor, 0..1.
    pub activations: [S; 2],
    /// Flags of the muscles.
    pub muscles: [Status; 2],
    /// What had to be saturated.
    pub status: ProsthesisStatus,
}

summed! {
    /// A prosthesis with delay lines of `D` ticks.
    #[derive(Clone, Copy, Debug)]
    pub struct Prosthesis<S: Scalar, const N: usize, const D: usize> {
        range: Range<S>,
        joint: Joint<S, 1, 2>,
        muscles: [ContinuousMuscle<S, N>; 2],
        envelopes: [Envelope<S, D>; 2],
        torque: Limiter<S>,
        stiffness: Limiter<S>,
        /// A frequency, which natural recruitment does not use.
        none: S::Quantity,
    }
}

/// Everything of a prosthesis that changes from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProsthesisState<S: Scalar, const N: usize, const D: usize> {
    envelopes: [EnvelopeState<S, D>; 2],
    angle: S,
    /// Last commands, in torque units.
    torque: S,
    stiffness: S,
    muscles: [State<S, NaturalContinuous, N>; 2],
}

impl<S: Scalar, const N: usize, const D: usize> ProsthesisState<S, N, D> {
    const OWN: usize = 1 + 2 * EnvelopeState::<S, D>::WORDS + 3;
    /// Words of a saved state.
    pub const SAVED_WORDS: usize = Self::OWN + 2 * State::<S, NaturalContinuous, N>::SAVED_WORDS;
}

/// Distinguishes saved prostheses: no mode has this number.
const PROSTHESIS: u32 = 0x100;

impl<S: Scalar, const N: usize, const D: usize> Prosthesis<S, N, D> {
    /// Builds a prosthesis for a time step; the error has the muscle's index, field, value, limit.
    pub fn build(params: &ProsthesisParams<N>, step: TimeStep) -> Result<Self, JointError> {
        let of = |muscle: usize| move |error| JointError { muscle: Some(muscle), error };
        let own = |error: ParameterError| JointError { muscle: None, error };
        let [flexor, extensor] = &params.muscles;
        let [of_flexor, of_extensor] = params.paths;
        let muscles = [
            ContinuousMuscle::build(flexor, step).map_err(of(0))?,
            ContinuousMuscle::build(extensor, step).map_err(of(1))?,
        ];
        let placed = [JointMuscle::new(flexor, of_flexor), JointMuscle::new(extensor, of_extensor)];
        let [first, second] = &params.envelopes;
        let torque = ["torque.least", "torque.most", "torque.rate"];
        let stiffness = ["stiffness.least", "stiffness.most", "stiffness.rate"];
        Ok(Self {
            range: Range::new((params.range.least, params.range.most), S::from_f64),
            joint: Joint::build(&[params.range], &placed)?,
            muscles,
            envelopes: [
                Envelope::build(first, step).map_err(of(0))?,
                Envelope::build(second, step).map_err(of(1))?,
            ],
            none: S::quantity(0.0),
            torque: Limiter::new(&params.torque, torque, TORQUE_UNIT, step).map_err(own)?,
            stiffness: Limiter::new(&params.stiffness, stiffness, TORQUE_UNIT, step)
                .map_err(own)?,
        })
    }

    /// At rest at an angle (rad), which is clipped to the joint's range.
    pub fn rest(&self, angle: S) -> Result<ProsthesisState<S, N, D>, ParameterError> {
        let posture = self.joint.posture([angle]);
        let [flexor, extensor] = &self.muscles;
        let [of_flexor, of_extensor] = posture.muscles.map(|muscle| muscle.path_length);
        let (angle, _) = self.range.clip(angle);
        Ok(ProsthesisState {
            envelopes: self.envelopes.each_ref().map(Envelope::rested),
            angle,
            torque: self.torque.clip(S::ZERO),
            stiffness: self.stiffness.clip(S::ZERO),
            muscles: [flexor.rest(of_flexor)?, extensor.rest(of_extensor)?],
        })
    }

    /// Steps one tick: cannot fail, no loop depends on data.
    pub fn step(
        &self,
        state: &mut ProsthesisState<S, N, D>,
        input: ProsthesisInput<S>,
    ) -> ProsthesisCommand<S> {
        let mut status = ProsthesisStatus::empty();
        status.set(ProsthesisStatus::ANGLE_NOT_FINITE, !input.angle.is_finite());
        let angle = if input.angle.is_finite() { input.angle } else { state.angle };
        let posture = self.joint.posture([angle]);
        let outside = posture.status.contains(JointStatus::ANGLE_CLIPPED);
        status.set(ProsthesisStatus::ANGLE_CLIPPED, outside);
        (state.angle, _) = self.range.clip(angle);

        let mut activations = [S::ZERO; 2];
        let (mut forces, mut stiffnesses) = ([S::ZERO; 2], [S::ZERO; 2]);
        let mut flags = [Status::empty(); 2];
        for i in 0..2 {
            let (activation, invalid) =
                self.envelopes[i].step(&mut state.envelopes[i], input.emg[i]);
            if invalid {
                status |= ProsthesisStatus::EMG_INVALID;
            }
            activations[i] = activation;
            let output = self.muscles[i].step(
                &mut state.muscles[i],
                Input {
                    activation,
                    path_length: posture.muscles[i].path_length,
                    stimulation_frequency: self.none,
                },
            );
            forces[i] = output.relative_force;
            stiffnesses[i] = self.muscles[i].stiffness(&state.muscles[i]);
            flags[i] = output.status;
        }
        status.set(ProsthesisStatus::MUSCLE, flags.iter().any(|flags| !flags.is_empty()));

        let [torque] = self.joint.torque_numbers(&posture, &forces);
        let [stiffness] = self.joint.stiffness_numbers(&posture, &forces, &stiffnesses);
        let (torque, limited) = self.torque.limit(state.torque, torque);
        status |=
            limited.flags(ProsthesisStatus::TORQUE_LIMITED, ProsthesisStatus::TORQUE_RATE_LIMITED);
        let (stiffness, limited) = self.stiffness.limit(state.stiffness, stiffness);
        status |= limited
            .flags(ProsthesisStatus::STIFFNESS_LIMITED, ProsthesisStatus::STIFFNESS_RATE_LIMITED);
        (state.torque, state.stiffness) = (torque, stiffness);
        ProsthesisCommand {
            torque: self.joint.quantity(torque),
            stiffness: self.joint.quantity(stiffness),
            activations,
            muscles: flags,
            status,
        }
    }

    /// Checksum of all coefficients.
    pub fn checksum(&self) -> u32 {
        let mut checksum = Checksum::EMPTY;
        self.sum(&mut checksum);
        checksum.value()
    }

    /// The [`ProsthesisState::SAVED_WORDS`] words of a saved state: a fingerprint of the
    /// prosthesis, and the state.
    pub fn save(&self, state: &ProsthesisState<S, N, D>) -> impl Iterator<Item = S::Bits> {
        let own = [state.angle, state.torque, state.stiffness].map(S::to_bits);
        let muscles = self.muscles.iter().zip(&state.muscles);
        core::iter::once(S::Bits::from(fingerprint::<S, _>(PROSTHESIS, self)))
            .chain(state.envelopes.iter().flat_map(EnvelopeState::words))
            .chain(own)
            .chain(muscles.flat_map(|(muscle, state)| muscle.save(state)))
    }

    /// A state saved by [`save`](Self::save); refused unless it is this prosthesis's and one it can
    /// be in.
    pub fn restore(
        &self,
        words: impl IntoIterator<Item = S::Bits>,
    ) -> Result<ProsthesisState<S, N, D>, RestoreError> {
        let mut parts = Parts::new(words.into_iter(), ProsthesisState::<S, N, D>::SAVED_WORDS);
        let expected = fingerprint::<S, _>(PROSTHESIS, self);
        let mut rest = self.rest(self.range.least).map_err(|_| RestoreError::Value { word: 0 })?;
        parts.part(ProsthesisState::<S, N, D>::OWN, |words| {
            let mut saved = Saved::new(words, ProsthesisState::<S, N, D>::OWN, expected)?;
            for (envelope, state) in self.envelopes.iter().zip(&mut rest.envelopes) {
                *state = envelope.restored(&mut saved)?;
            }
            rest.angle = saved.number(|angle| self.range.contains(angle))?;
            rest.torque = saved.number(|torque| self.torque.clip(torque) == torque)?;
            rest.stiffness = saved.number(|value| self.stiffness.clip(value) == value)?;
            saved.finished()
        })?;
        for (muscle, state) in self.muscles.iter().zip(&mut rest.muscles) {
            let length = State::<S, NaturalContinuous, N>::SAVED_WORDS;
            *state = parts.part(length, |words| muscle.restore(words))?;
        }
        parts.finished()?;
        Ok(rest)
    }
}

impl Limited {
    fn flags(self, range: ProsthesisStatus, rate: ProsthesisStatus) -> ProsthesisStatus {
        let mut flags = ProsthesisStatus::empty();
        flags.set(range, self.range);
        flags.set(rate, self.rate);
        flags
    }
}
