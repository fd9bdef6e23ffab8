//! A joint's controller in its place: coefficients, state and the electrodes of both muscles.

use crate::between::guarded::Sum;
use crate::between::motion::Target;
use crate::between::stimulus::{LEAST_PHASE_US, MOST_FULL_SCALE_UA, Stimulus, within};
use crate::config::{MUSCLES, TYPES};
use crate::hard_tick::placed_muscle::Demand;
use crate::link::{Commanded, ControlUpload, Electrode, Modulation, Refusal, Upload};
use vm_nostd::control::{
    FesCommand, FesController, FesControllerParams, FesControllerState, Measured, Sensors,
};
use vm_nostd::{Checksum, Pulse, TimeStep, control};

const _: () = assert!(MUSCLES == 2, "a joint has a flexor and an extensor");

/// What a step of the controller asks for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stepped {
    pub(crate) demands: [Demand; MUSCLES],
    /// The estimated gain is finite and in its range.
    pub(crate) gain_is_valid: bool,
    pub(crate) command: Commanded,
}

/// The electrode of a muscle, as the controller drives it.
#[derive(Clone, Copy, Debug)]
struct Driven {
    channel: u8,
    width_us: u16,
    gap_us: u16,
    recovery: u8,
    modulation: Modulation,
}

/// What is checked every tick but is no coefficient of the controller.
#[derive(Clone, Copy, Debug)]
struct Frame {
    driven: [Driven; MUSCLES],
    frequency_tenths_pps: u16,
    range_urad: (i32, i32),
    period_us: u32,
    gains: (f32, f32),
}

/// A controller with its state and the checksums of all of it.
// Copied in memory, as muscles are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedController {
    controller: FesController<f32, TYPES>,
    state: FesControllerState<f32>,
    frame: Frame,
    checksums: [u32; 3],
    /// A checksum failed once. Stepping stops then, because a new state would get a valid checksum.
    lost: bool,
}

impl PlacedController {
    /// Builds a controller of two muscles, at rest in the middle of the joint's range; the error
    /// has muscle, field, value and limit.
    #[inline(never)]
    pub(crate) fn build(
        muscles: [Option<&Upload>; MUSCLES],
        control: &ControlUpload,
        step: TimeStep,
    ) -> Result<Self, Refusal<'static>> {
        let [flexor, extensor] = muscles;
        let (flexor, flexing) = controllable(0, flexor)?;
        let (extensor, extending) = controllable(1, extensor)?;
        let driven =
            [driven(flexing, control.modulation[0])?, driven(extending, control.modulation[1])?];
        let ControlUpload { range, sensor_period_us, stimulation_frequency, .. } = *control;
        within("sensor_period_us", sensor_period_us, 1_000, 10_000)?;
        let controller = FesController::build(
            &FesControllerParams {
                range,
                muscles: [flexor.muscle, extensor.muscle],
                paths: control.paths,
                limb: control.limb,
                electrodes: [flexing.curve, extending.curve],
                modulation: driven.map(|driven| driven.of_model()),
                stimulation_frequency,
                cocontraction: control.cocontraction,
                measured: Measured::Angle,
                feedback: control.feedback,
                expected_lag: control.expected_lag,
                lead_filter_time: control.lead_filter_time,
                fatigue: control.fatigue,
                least_fitness: control.least_fitness,
                gain: control.gain,
                torque: control.torque,
            },
            step,
        )?;
        // Validated: they are few and small.
        let urad = |angle: f64| (angle * 1e6) as i32;
        let frame = Frame {
            driven,
            frequency_tenths_pps: (stimulation_frequency * 10.0) as u16,
            range_urad: (urad(range.least), urad(range.most)),
            period_us: sensor_period_us,
            gains: control.gain.map_or((1.0, 1.0), |gain| (gain.least as f32, gain.most as f32)),
        };
        let state = controller.start((0.5 * (range.least + range.most)) as f32);
        let mut placed = Self { controller, state, frame, checksums: [0; 3], lost: false };
        placed.checksums = placed.sums();
        Ok(placed)
    }

    /// Begins anew at an angle (rad), with rested muscles and a gain of 1.
    pub(crate) fn start(&mut self, angle: f32) {
        if !self.lost {
            self.state = self.controller.start(angle);
            self.checksums[1] = self.state.checksum();
        }
    }

    /// Whether no checksum has failed.
    pub(crate) fn check(&mut self) -> bool {
        self.lost |= self.sums() != self.checksums;
        !self.lost
    }

    /// Range of the joint, µrad, and period of its sensor, µs.
    pub(crate) fn sensor(&self) -> ((i32, i32), u32) {
        (self.frame.range_urad, self.frame.period_us)
    }

    /// Steps by a tick, with the angle that is measured (rad); none after a failed checksum.
    pub(crate) fn step(&mut self, target: &Target, angle: f32) -> Option<Stepped> {
        if self.lost {
            return None;
        }
        let Target { angle: wanted, velocity, acceleration, torque } = *target;
        let target = control::Target { angle: wanted, velocity, acceleration, torque };
        let command = self.controller.step(&mut self.state, target, Sensors { angle, torque: 0.0 });
        // Keeps the checksums of what does not change: recomputing them would hide a flipped bit.
        self.checksums[1] = self.state.checksum();
        let (least, most) = self.frame.gains;
        Some(Stepped {
            demands: [0, 1].map(|index| self.demand(index, &command)),
            gain_is_valid: (least..=most).contains(&command.gain),
            command: Commanded {
                activations: command.activations,
                pulses: command.pulses.map(|Pulse { amplitude, width }| (amplitude, width)),
                torque: command.torque,
                gain: command.gain,
                status: command.status.bits(),
                state: self.checksums[1],
            },
        })
    }

    /// Pulses of one muscle.
    fn demand(&self, index: usize, command: &FesCommand<f32>) -> Demand {
        let Driven { channel, width_us, gap_us, recovery, modulation } = self.frame.driven[index];
        let (activation, pulse) = (command.activations[index], command.pulses[index]);
        let Pulse { amplitude, width } = pulse;
        if !(activation.is_finite() && amplitude.is_finite() && width.is_finite()) {
            return Demand::NotFinite;
        }
        // `as` saturates.
        let (amplitude_ua, width_us) = match modulation {
            Modulation::Width { amplitude_ua } => (amplitude_ua, (width as u16).min(width_us)),
            Modulation::Amplitude { most_ua } => {
                (((amplitude * 1000.0) as u32).min(most_ua), width_us)
            }
        };
        // The greatest pulse that recruits nothing is left out, and so is one that is too short.
        if activation <= 0.0 || u32::from(width_us) < LEAST_PHASE_US {
            return Demand::Nothing;
        }
        let frequency_tenths_pps = self.frame.frequency_tenths_pps;
        let stimulus = Stimulus { amplitude_ua, width_us, gap_us, frequency_tenths_pps, recovery };
        Demand::Pulses(channel.into(), stimulus)
    }

    fn sums(&self) -> [u32; 3] {
        let mut frame = Checksum::EMPTY;
        self.frame.sum(&mut frame);
        [self.controller.checksum(), self.state.checksum(), frame.value()]
    }
}

impl Driven {
    fn of_model(&self) -> control::Modulation {
        match self.modulation {
            Modulation::Width { amplitude_ua } => {
                control::Modulation::Width { amplitude: f64::from(amplitude_ua) * 1e-6 }
            }
            Modulation::Amplitude { .. } => {
                control::Modulation::Amplitude { width: f64::from(self.width_us) * 1e-6 }
            }
        }
    }
}

impl Sum for Driven {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { channel, width_us, gap_us, recovery, modulation } = *self;
        let (kind, ua) = match modulation {
            Modulation::Width { amplitude_ua } => (0, amplitude_ua),
            Modulation::Amplitude { most_ua } => (1, most_ua),
        };
        checksum.add(u32::from_le_bytes([channel, recovery, kind, 0]));
        checksum.add(u32::from(width_us) << 16 | u32::from(gap_us));
        checksum.add(ua);
    }
}

impl Sum for Frame {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { driven, frequency_tenths_pps, range_urad, period_us, gains } = self;
        driven.sum(checksum);
        let (least, most) = *range_urad;
        [u32::from(*frequency_tenths_pps), least.cast_unsigned(), most.cast_unsigned(), *period_us]
            .into_iter()
            .chain([gains.0, gains.1].map(f32::to_bits))
            .for_each(|word| checksum.add(word));
    }
}

/// A muscle with an electrode, in FES.
fn controllable(
    place: u8,
    muscle: Option<&Upload>,
) -> Result<(&Upload, Electrode), Refusal<'static>> {
    let muscle = muscle.ok_or(Refusal::NotControllable { place })?;
    let electrode = muscle.electrode.ok_or(Refusal::NotControllable { place })?;
    Ok((muscle, electrode))
}

/// An electrode that was validated with its muscle.
fn driven(electrode: Electrode, modulation: Modulation) -> Result<Driven, Refusal<'static>> {
    if let Modulation::Amplitude { most_ua } = modulation {
        within("modulation.most_ua", most_ua, 1, MOST_FULL_SCALE_UA)?;
    }
    let Electrode { channel, curve: _, width_us, gap_us, recovery } = electrode;
    Ok(Driven { channel, width_us, gap_us, recovery, modulation })
}

#[cfg(test)]
pub(crate) mod tests;
