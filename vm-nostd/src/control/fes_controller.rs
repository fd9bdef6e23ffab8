//! FES controller of a joint's angle or torque: feed-forward by the model, feedback by PI.
//!
//! Each tick: target -> torque of the motion ([`LimbParams`]) plus PI -> the model's inverse ->
//! activation of flexor and extensor -> pulse. Nothing in it can fail, and no loop depends on data.

use super::electrode::Electrode;
use super::feed_forward::{CoContraction, Inverse, InverseState, LEAST_ACTIVATION, Stimulated};
use super::fes_io::{ControlStatus, FesCommand, Sensors, Target};
use super::fes_params::{FesControllerParams, Measured};
use super::fes_state::FesControllerState;
use super::gain_estimate::{GainEstimate, Learnt};
use super::joint::{Joint, JointError, JointMuscle, TORQUE_UNIT};
use super::lead::{Lead, LeadParams};
use super::limb::Limb;
use super::pi::{Pi, Saturated};
use crate::beyond_paper::fatigue::{Fatigue, FatigueParams};
use crate::beyond_paper::recruitment_curve::Pulse;
use crate::beyond_paper::steady::SteadyFes;
use crate::checksum::Checksum;
use crate::error::ParameterError;
use crate::params::MuscleParams;
use crate::scalar::Scalar;
use crate::scalar::constant::Constant;
use crate::status::Status;
use crate::summed::{Summed, summed};
use crate::tick::lag::Lag;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

summed! {
    /// A controller of a joint with a flexor and an extensor.
    #[derive(Clone, Copy, Debug)]
    pub struct FesController<S: Scalar, const N: usize> {
        pub(super) range: Range<S>,
        joint: Joint<S, 1, 2>,
        limb: Limb<S>,
        pub(super) inverses: [Inverse<S, N>; 2],
        electrodes: [Electrode<S>; 2],
        cocontraction: CoContraction<S>,
        pub(super) feedback: Pi<S>,
        pub(super) of_torque: bool,
        expected: Lag<S>,
        pub(super) gain: Option<GainEstimate<S>>,
        torque: Range<S>,
        per_torque: S::Factor,
        frequency: S::Quantity,
        most_motion: S,
        most_torque: S,
    }

    sum only
}

/// Amplitude and width of a pulse that is none.
const NO_PULSE: Constant = Constant::new(0.0);
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
                Electrode::build(first, first_driven).map_err(of(0))?,
                Electrode::build(second, second_driven).map_err(of(1))?,
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
            expected: expected.wide(),
            feedback: self.feedback.rested(),
            gain: S::ONE.wide(),
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
        let [forces, forward] = [torque, forward]
            .map(|torque| self.joint.forces_for(&posture, &self.cocontraction.shares(torque)));
        let none = S::quantity_constant(&NO_PULSE);
        let mut pulses = [Pulse { amplitude: none, width: none }; 2];
        let mut activations = [S::ZERO; 2];
        let mut muscles = [Status::empty(); 2];
        let mut at_most = [false; 2];
        for i in 0..2 {
            let (inverse, path) = (&mut state.inverses[i], posture.muscles[i].path_length);
            let stimulated =
                self.inverses[i].step(inverse, forces[i], forward[i], path, self.frequency);
            let (pulse, reached) = self.electrodes[i].pulse(stimulated.activation);
            status |= flags(&stimulated, reached);
            (activations[i], pulses[i]) = (stimulated.activation, pulse);
            (muscles[i], at_most[i]) = (stimulated.status, stimulated.at_most);
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
}

/// What one muscle's part of a tick had to saturate.
fn flags<S>(stimulated: &Stimulated<S>, reached: bool) -> ControlStatus {
    let mut status = ControlStatus::empty();
    status.set(ControlStatus::UNREACHABLE, stimulated.at_most);
    status.set(ControlStatus::LEAD_CLIPPED, stimulated.lead_clipped);
    status.set(ControlStatus::PULSE_UNREACHABLE, !reached);
    status
}
