//! FES controller of a joint's angle or torque: feed-forward by the model, feedback by PI.
//!
//! Each tick: target -> torque of the motion ([`LimbParams`]) plus PI -> the model's inverse ->
//! activation of flexor and extensor -> pulse. Nothing in it can fail, and no loop depends on data.

use super::feed_forward::{CoContraction, Inverse, InverseState, LEAST_ACTIVATION};
use super::fes_params::{FesControllerParams, Measured, Modulation};
use super::gain_estimate::{GainEstimate, Learnt};
use super::joint::{Joint, JointError, JointMuscle, TORQUE_UNIT};
use super::lead::{Lead, LeadParams, LeadState};
use super::limb::Limb;
use super::pi::{Pi, PiState, Saturated};
use super::saved::{Parts, fingerprint};
use crate::beyond_paper::fatigue::{Fatigue, FatigueParams, FatigueState};
use crate::beyond_paper::recruitment_curve::{
    Pulse, PulseStatus, RecruitmentCurve, RecruitmentCurveParams,
};
use crate::beyond_paper::steady::SteadyFes;
use crate::checksum::Checksum;
use crate::error::ParameterError;
use crate::params::MuscleParams;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::status::Status;
use crate::summed::{Summed, summed};
use crate::tick::lag::Lag;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

bitflags::bitflags! {
    /// What a tick of a controller had to saturate.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct ControlStatus: u16 {
        /// The measured value was not finite: the last one was kept.
        const MEASURED_NOT_FINITE = 1 << 0;
        /// The target was not finite (the last angle was kept, without motion) or outside its
        /// range, for torques 10,240 N m (clipped).
        const TARGET_INVALID = 1 << 1;
        /// The measured angle was outside the joint's range, or the torque beyond 10,240 N m, and
        /// was clipped.
        const MEASURED_CLIPPED = 1 << 2;
        /// The torque was clipped to its limits.
        const TORQUE_LIMITED = 1 << 3;
        /// No activation makes the torque: a muscle is stimulated fully.
        const UNREACHABLE = 1 << 4;
        /// The lead asked for stimulation outside of 0..1.
        const LEAD_CLIPPED = 1 << 5;
        /// The gain would have left its range: the update was refused.
        const GAIN_REFUSED = 1 << 6;
        /// The gain is frozen: too little torque, or saturated.
        const GAIN_FROZEN = 1 << 7;
        /// No pulse recruits what was asked for.
        const PULSE_UNREACHABLE = 1 << 8;
    }
}

/// What is wanted, in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<S: Scalar> {
    /// Angle, rad.
    pub angle: S,
    /// Its velocity, rad/s.
    pub velocity: S,
    /// Its acceleration, rad/s².
    pub acceleration: S,
    /// Torque, N m, in addition to that of the motion; with [`Measured::Torque`] the only one.
    pub torque: S::Quantity,
}

/// What is measured, in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors<S: Scalar> {
    /// Angle, rad.
    pub angle: S,
    /// Torque of the muscles, N m; only used with [`Measured::Torque`].
    pub torque: S::Quantity,
}

/// What is commanded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FesCommand<S: Scalar> {
    /// Stimulation of flexor and extensor, 0..1. 0 once less than 0.001 is left of a muscle that is
    /// no longer wanted.
    pub activations: [S; 2],
    /// The pulse that recruits it; for 0 the greatest that recruits nothing, which need not be
    /// given.
    pub pulses: [Pulse<S>; 2],
    /// Torque that was asked of the model's inverse, N m.
    pub torque: S::Quantity,
    /// Estimated gain of the muscles.
    pub gain: S,
    /// Flags of the inverse.
    pub muscles: [Status; 2],
    /// What had to be saturated.
    pub status: ControlStatus,
}

summed! {
    /// A controller of a joint with a flexor and an extensor.
    #[derive(Clone, Copy, Debug)]
    pub struct FesController<S: Scalar, const N: usize> {
        range: Range<S>,
        joint: Joint<S, 1, 2>,
        limb: Limb<S>,
        inverses: [Inverse<S, N>; 2],
        electrodes: [Electrode<S>; 2],
        cocontraction: CoContraction<S>,
        feedback: Pi<S>,
        of_torque: bool,
        expected: Lag<S>,
        gain: Option<GainEstimate<S>>,
        torque: Range<S>,
        per_torque: S::Factor,
        frequency: S::Quantity,
        most_motion: S,
        most_torque: S,
    }

    sum only
}

summed! {
    /// A recruitment curve, and the half of the pulse that is constant.
    #[derive(Clone, Copy, Debug)]
    struct Electrode<S: Scalar> {
        curve: RecruitmentCurve<S>,
        by_width: bool,
        constant: S::Quantity,
    }
}

/// Everything of a controller that changes from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FesControllerState<S: Scalar> {
    /// Last target and measured angle, rad; measured torque, in its unit.
    target: S,
    angle: S,
    measured: S,
    /// What the feedback expects to be measured.
    expected: S::LagState,
    feedback: PiState<S>,
    gain: S::LagState,
    saturated: Saturated,
    inverses: [InverseState<S>; 2],
}

impl<S: Scalar> FesControllerState<S> {
    const OWN: usize =
        1 + 4 + 2 * S::LAG_STATE_WORDS + PiState::<S>::WORDS + 2 * LeadState::<S>::WORDS;
    /// Words of a saved state without fatigue; [`FesController::saved_words`] has those of a
    /// controller.
    pub const LEAST_SAVED_WORDS: usize = Self::OWN;

    /// Estimated gain.
    pub fn gain(&self) -> S {
        S::of(self.gain)
    }

    /// Its bits, for comparison; [`FesController::save`] adds the fingerprints.
    pub fn words(&self) -> impl Iterator<Item = S::Bits> {
        let Self { target, angle, measured, expected, feedback, gain, saturated, inverses } = self;
        let own = [*target, *angle, *measured].map(S::to_bits);
        own.into_iter()
            .chain(core::iter::once(S::Bits::from(saturated.bits())))
            .chain([*expected, *gain].into_iter().flat_map(S::lag_state_words))
            .chain(feedback.words())
            .chain(inverses.iter().flat_map(InverseState::words))
    }

    /// Checksum of all words, see [`FesController::checksum`].
    pub fn checksum(&self) -> u32 {
        let mut checksum = Checksum::EMPTY;
        self.words().for_each(|word| word.sum(&mut checksum));
        checksum.value()
    }
}

/// Distinguishes saved controllers: no mode has this number.
const CONTROLLER: u32 = 0x101;
/// Greatest velocity (rad/s) and acceleration (rad/s²) of a target.
const MOST_MOTION: f64 = 100.0;
/// Greatest torque (N m) of a target, and that is measured: of an artefact no more stays in the
/// filters than a saved state may hold.
const MOST_TORQUE: f64 = 10_240.0;

impl<S: Scalar, const N: usize> FesController<S, N> {
    /// Builds a controller for a time step; the error has the muscle's index, field, value, limit.
    pub fn build(params: &FesControllerParams<N>, step: TimeStep) -> Result<Self, JointError> {
        let of = |muscle: usize| move |error| JointError { muscle: Some(muscle), error };
        let own = |error: ParameterError| JointError { muscle: None, error };
        params.validate_own().map_err(own)?;
        let driven = params.modulation.iter().zip(&params.electrodes);
        for (index, (muscle, (modulation, curve))) in params.muscles.iter().zip(driven).enumerate()
        {
            // Before the joint, which would name what follows from a muscle's fields.
            muscle.validate().map_err(of(index))?;
            curve.validate().map_err(of(index))?;
            modulation.validate(curve).map_err(of(index))?;
        }
        let [flexor, extensor] = &params.muscles;
        let [of_flexor, of_extensor] = params.paths;
        let placed = [JointMuscle::new(flexor, of_flexor), JointMuscle::new(extensor, of_extensor)];
        let joint = Joint::build(&[params.range], &placed)?;
        let frequency = params.stimulation_frequency;
        let inverse = |muscle: &MuscleParams<N>, fatigue: Option<FatigueParams>| {
            let lead = LeadParams::of_muscle(muscle, frequency, params.lead_filter_time);
            let fatigue = fatigue.map(|fatigue| Fatigue::build(&fatigue, step));
            Ok::<_, ParameterError>(Inverse {
                steady: SteadyFes::build(muscle)?,
                lead: Lead::build(&lead, step)?,
                fatigue: fatigue.transpose()?,
                least_fitness: S::from_f64(params.least_fitness),
                least_activation: S::from_f64(LEAST_ACTIVATION),
            })
        };
        let electrode = |curve: &RecruitmentCurveParams, modulation: Modulation| {
            let (by_width, constant) = match modulation {
                Modulation::Width { amplitude } => (true, amplitude * 1e3),
                Modulation::Amplitude { width } => (false, width * 1e6),
            };
            Ok::<_, ParameterError>(Electrode {
                curve: RecruitmentCurve::build(curve)?,
                by_width,
                constant: S::quantity(constant),
            })
        };
        let [flexor_tires, extensor_tires] = params.fatigue;
        let [first_driven, second_driven] = params.modulation;
        let [first, second] = &params.electrodes;
        let of_torque = params.measured == Measured::Torque;
        let error_unit = if of_torque { TORQUE_UNIT } else { 1.0 };
        let gain = params.gain.map(|gain| GainEstimate::build(&gain, TORQUE_UNIT, step));
        Ok(Self {
            range: Range::new((params.range.least, params.range.most), S::from_f64),
            joint,
            limb: Limb::new(&params.limb, &params.range, TORQUE_UNIT).map_err(own)?,
            inverses: [
                inverse(flexor, flexor_tires).map_err(of(0))?,
                inverse(extensor, extensor_tires).map_err(of(1))?,
            ],
            electrodes: [
                electrode(first, first_driven).map_err(of(0))?,
                electrode(second, second_driven).map_err(of(1))?,
            ],
            cocontraction: CoContraction {
                torque: S::from_f64(params.cocontraction / TORQUE_UNIT),
            },
            feedback: Pi::build(&params.feedback, TORQUE_UNIT, error_unit, step).map_err(own)?,
            of_torque,
            expected: Lag::new(params.expected_lag, step),
            gain: gain.transpose().map_err(own)?,
            torque: Range::new(
                (params.torque.0 / TORQUE_UNIT, params.torque.1 / TORQUE_UNIT),
                S::from_f64,
            ),
            per_torque: S::per_quantity(1.0 / TORQUE_UNIT),
            frequency: S::quantity(frequency),
            most_motion: S::from_f64(MOST_MOTION),
            most_torque: S::from_f64(MOST_TORQUE / TORQUE_UNIT),
        })
    }

    /// Checksum of all coefficients, see [`Muscle::checksum`](crate::Muscle::checksum).
    pub fn checksum(&self) -> u32 {
        let mut checksum = Checksum::EMPTY;
        self.sum(&mut checksum);
        checksum.value()
    }

    /// A controller that starts at an angle (rad), clipped to the joint's range, with rested
    /// muscles and a gain of 1.
    pub fn start(&self, angle: S) -> FesControllerState<S> {
        let (angle, _) = self.range.clip(angle);
        let expected = if self.of_torque { S::ZERO } else { angle };
        FesControllerState {
            target: angle,
            angle,
            measured: S::ZERO,
            expected: expected.lag_state(),
            feedback: self.feedback.rested(),
            gain: S::ONE.lag_state(),
            saturated: Saturated::default(),
            inverses: self.inverses.each_ref().map(|inverse| InverseState {
                lead: inverse.lead.rested(),
                fatigue: inverse.fatigue.map(|fatigue| fatigue.rested()),
            }),
        }
    }

    /// Steps one tick: cannot fail, no loop depends on data.
    pub fn step(
        &self,
        state: &mut FesControllerState<S>,
        target: Target<S>,
        sensors: Sensors<S>,
    ) -> FesCommand<S> {
        let mut status = ControlStatus::empty();
        let target = self.admit_target(state, target, &mut status);
        self.admit_sensors(state, sensors, &mut status);

        let (asked, clipped) = self.torque_of(target.torque);
        if clipped {
            status |= ControlStatus::TARGET_INVALID;
        }
        let motion = self.limb.torque(target.angle, target.velocity, target.acceleration);
        let (forward, wanted, measured) = if self.of_torque {
            (asked, asked, state.measured)
        } else {
            (motion + asked, target.angle, state.angle)
        };
        // The joint follows late: feedback compares with what is to be measured now.
        state.expected = self.expected.at_end(state.expected, wanted);
        let error = S::of(state.expected) - measured;
        let fed_back = self.feedback.step(&mut state.feedback, error, state.saturated);
        // The gain scales the feed-forward alone: an estimate that is off cannot destabilise the
        // loop.
        let forward = forward.ratio(S::of(state.gain));
        let (torque, limited) = self.torque.clip(forward + fed_back);
        status.set(ControlStatus::TORQUE_LIMITED, limited);

        let posture = self.joint.posture([state.angle]);
        let [forces, forward] = [torque, forward].map(|torque| {
            self.joint.forces_for(&posture, &self.cocontraction.shares(torque).torques)
        });
        let mut activations = [S::ZERO; 2];
        let mut pulses = [self.pulse(0, S::ZERO).0; 2];
        let mut muscles = [Status::empty(); 2];
        let mut at_most = [false; 2];
        for i in 0..2 {
            let inverse = &mut state.inverses[i];
            let path = posture.muscles[i].path_length;
            let stimulated =
                self.inverses[i].step(inverse, forces[i], forward[i], path, self.frequency);
            activations[i] = stimulated.activation;
            muscles[i] = stimulated.status;
            at_most[i] = stimulated.at_most;
            if stimulated.at_most {
                status |= ControlStatus::UNREACHABLE;
            }
            if stimulated.lead_clipped {
                status |= ControlStatus::LEAD_CLIPPED;
            }
            let (pulse, reached) = self.pulse(i, stimulated.activation);
            pulses[i] = pulse;
            if !reached {
                status |= ControlStatus::PULSE_UNREACHABLE;
            }
        }
        state.saturated = Saturated {
            above: at_most[0] || (limited && torque >= self.torque.most),
            below: at_most[1] || (limited && torque <= self.torque.least),
        };
        status |= self.learn(state, torque, fed_back, limited);
        FesCommand {
            activations,
            pulses,
            torque: self.joint.quantity(torque),
            gain: S::of(state.gain),
            muscles,
            status,
        }
    }

    fn admit_target(
        &self,
        state: &mut FesControllerState<S>,
        target: Target<S>,
        status: &mut ControlStatus,
    ) -> Target<S> {
        let finite =
            [target.angle, target.velocity, target.acceleration].into_iter().all(S::is_finite)
                && S::quantity_is_finite(target.torque);
        let target = if finite {
            target
        } else {
            let torque = self.joint.quantity(S::ZERO);
            Target { angle: state.target, velocity: S::ZERO, acceleration: S::ZERO, torque }
        };
        let (angle, clipped) = self.range.clip(target.angle);
        let most = self.most_motion;
        let [velocity, acceleration] =
            [target.velocity, target.acceleration].map(|value| value.max(-most).min(most));
        let same = velocity == target.velocity && acceleration == target.acceleration;
        status.set(ControlStatus::TARGET_INVALID, !finite || clipped || !same);
        state.target = angle;
        Target { angle, velocity, acceleration, torque: target.torque }
    }

    fn admit_sensors(
        &self,
        state: &mut FesControllerState<S>,
        sensors: Sensors<S>,
        status: &mut ControlStatus,
    ) {
        let mut lost = !sensors.angle.is_finite();
        if !lost {
            let (angle, clipped) = self.range.clip(sensors.angle);
            status.set(ControlStatus::MEASURED_CLIPPED, clipped);
            state.angle = angle;
        }
        if self.of_torque {
            if S::quantity_is_finite(sensors.torque) {
                let (measured, clipped) = self.torque_of(sensors.torque);
                state.measured = measured;
                if clipped {
                    *status |= ControlStatus::MEASURED_CLIPPED;
                }
            } else {
                lost = true;
            }
        }
        status.set(ControlStatus::MEASURED_NOT_FINITE, lost);
    }

    /// A torque in its unit, and whether it was clipped.
    fn torque_of(&self, torque: S::Quantity) -> (S, bool) {
        let number = S::of_quantity(torque, &self.per_torque);
        let clipped = number.max(-self.most_torque).min(self.most_torque);
        (clipped, clipped != number)
    }

    fn pulse(&self, muscle: usize, activation: S) -> (Pulse<S>, bool) {
        let Electrode { curve, by_width, constant } = &self.electrodes[muscle];
        let (pulse, status) = if *by_width {
            let (width, status) = curve.width_for(activation, *constant);
            (Pulse { amplitude: *constant, width }, status)
        } else {
            let (amplitude, status) = curve.amplitude_for(activation, *constant);
            (Pulse { amplitude, width: *constant }, status)
        };
        (pulse, !status.contains(PulseStatus::UNREACHABLE))
    }

    fn learn(
        &self,
        state: &mut FesControllerState<S>,
        torque: S,
        fed_back: S,
        limited: bool,
    ) -> ControlStatus {
        let Some(estimate) = &self.gain else { return ControlStatus::empty() };
        let saturated = limited || state.saturated.above || state.saturated.below;
        match estimate.step(&mut state.gain, torque, fed_back, saturated) {
            Learnt::Moved => ControlStatus::empty(),
            Learnt::Frozen => ControlStatus::GAIN_FROZEN,
            Learnt::Refused => ControlStatus::GAIN_REFUSED,
        }
    }

    /// Words of a saved state of this controller.
    pub fn saved_words(&self) -> usize {
        let tired = self.inverses.iter().filter(|inverse| inverse.fatigue.is_some()).count();
        FesControllerState::<S>::OWN + tired * FatigueState::<S>::SAVED_WORDS
    }

    /// The words of a saved state: a fingerprint of the controller, and the state.
    pub fn save(&self, state: &FesControllerState<S>) -> impl Iterator<Item = S::Bits> {
        let saturated = state.saturated.bits();
        let own = [state.target, state.angle, state.measured].map(S::to_bits);
        let slow = [state.expected, state.gain];
        let tired = self.inverses.iter().zip(&state.inverses).filter_map(|(inverse, state)| {
            Some(inverse.fatigue.as_ref()?.save(state.fatigue.as_ref()?))
        });
        core::iter::once(S::Bits::from(fingerprint::<S, _>(CONTROLLER, self)))
            .chain(own)
            .chain(core::iter::once(S::Bits::from(saturated)))
            .chain(slow.into_iter().flat_map(S::lag_state_words))
            .chain(state.feedback.words())
            .chain(state.inverses.iter().flat_map(|inverse| inverse.lead.words()))
            .chain(tired.flatten())
    }

    /// A state saved by [`save`](Self::save); refused unless it is this controller's and one it can
    /// be in.
    pub fn restore(
        &self,
        words: impl IntoIterator<Item = S::Bits>,
    ) -> Result<FesControllerState<S>, RestoreError> {
        let length = FesControllerState::<S>::OWN;
        let mut parts = Parts::new(words.into_iter(), self.saved_words());
        let expected = fingerprint::<S, _>(CONTROLLER, self);
        let mut state = self.start(self.range.least);
        parts.part(length, |words| {
            let mut saved = Saved::new(words, length, expected)?;
            state.target = saved.number(|angle| self.range.contains(angle))?;
            state.angle = saved.number(|angle| self.range.contains(angle))?;
            state.measured = saved.number(S::is_finite)?;
            let saturated = saved.count(4)?;
            state.saturated = Saturated { above: saturated & 1 != 0, below: saturated & 2 != 0 };
            let any = S::from_f64(1e4);
            let range = if self.of_torque { Range { least: -any, most: any } } else { self.range };
            state.expected = saved.lag_state(&range)?;
            let gains = Range { least: S::ONE, most: S::ONE };
            state.gain = match &self.gain {
                Some(gain) => gain.restored(&mut saved)?,
                None => saved.lag_state(&gains)?,
            };
            state.feedback = self.feedback.restored(&mut saved)?;
            for (inverse, state) in self.inverses.iter().zip(&mut state.inverses) {
                state.lead = inverse.lead.restored(&mut saved)?;
            }
            saved.finished()
        })?;
        for (inverse, state) in self.inverses.iter().zip(&mut state.inverses) {
            if let Some(fatigue) = &inverse.fatigue {
                let length = FatigueState::<S>::SAVED_WORDS;
                state.fatigue = Some(parts.part(length, |words| fatigue.restore(words))?);
            }
        }
        parts.finished()?;
        Ok(state)
    }
}
