//! A muscle in its place: coefficients, state and electrode.

use crate::between::guarded::Sum;
use crate::between::stimulus::{Stimulus, within};
use crate::config::{CHANNELS, TYPES};
use crate::link::{Electrode, MOST_WORDS, Mode, Refusal, RowInputs, RowOutputs, Upload};
use heapless::Vec;
use vm_nostd::{
    BankedMuscle, Checksum, ContinuousMuscle, FesMuscle, Input, IntramuscularFes,
    NaturalContinuous, RecruitmentCurve, State, TimeStep,
};

#[cfg(test)]
mod tests;

const _: () = assert!(State::<f32, NaturalContinuous, TYPES>::WORDS <= MOST_WORDS);
const _: () = assert!(State::<f32, IntramuscularFes, TYPES>::WORDS <= MOST_WORDS);

/// Stimulation that a row requests of a muscle's electrode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Demand {
    /// No pulses.
    Nothing,
    /// Pulses on a channel.
    Pulses(usize, Stimulus),
    /// An activation or a frequency that is not finite: a fault.
    NotFinite,
}

impl Sum for Demand {
    fn sum(&self, checksum: &mut Checksum) {
        match self {
            Self::Nothing => checksum.add(0),
            Self::Pulses(channel, stimulus) => {
                // There are few channels.
                checksum.add(1 + *channel as u32);
                stimulus.sum(checksum);
            }
            Self::NotFinite => checksum.add(u32::MAX),
        }
    }
}

/// A muscle with its state, its electrode and the checksums of all of it.
// Copied in memory: a clone would be built on the stack, field by field.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedMuscle {
    muscle: BankedMuscle<f32, TYPES>,
    electrode: Option<(Electrode, RecruitmentCurve<f32>)>,
    checksums: [u32; 3],
    /// A checksum failed once. Stepping stops then, because a new state would get a valid checksum.
    lost: bool,
}

impl PlacedMuscle {
    /// Builds a muscle at rest on
    /// [`MuscleParams::middle_path`](vm_nostd::MuscleParams::middle_path); the error has field,
    /// value and limit.
    pub(crate) fn build(upload: &Upload, step: TimeStep) -> Result<Self, Refusal<'static>> {
        let electrode =
            upload.electrode.map(|electrode| checked(upload.mode, electrode)).transpose()?;
        let path_length = upload.muscle.middle_path() as f32;
        let muscle = match upload.mode {
            Mode::Continuous => {
                let muscle = ContinuousMuscle::build(&upload.muscle, step)?;
                let state = muscle.rest(path_length)?;
                BankedMuscle::Continuous(muscle, state)
            }
            Mode::Fes => {
                let muscle = FesMuscle::build(&upload.muscle, step)?;
                let state = muscle.rest(path_length)?;
                BankedMuscle::Fes(muscle, state)
            }
        };
        let mut driven = Self { muscle, electrode, checksums: [0; 3], lost: false };
        driven.checksums = driven.sums();
        Ok(driven)
    }

    /// Puts it at rest on a path (m). An error if the path is out of range; the muscle is
    /// unchanged.
    pub(crate) fn rest(&mut self, path_length: f32) -> Result<(), Refusal<'static>> {
        match &mut self.muscle {
            BankedMuscle::Continuous(muscle, state) => *state = muscle.rest(path_length)?,
            BankedMuscle::Fes(muscle, state) => *state = muscle.rest(path_length)?,
        }
        self.checksums[1] = self.muscle.state_checksum();
        Ok(())
    }

    /// Whether no checksum has failed.
    pub(crate) fn check(&mut self) -> bool {
        self.lost |= self.sums() != self.checksums;
        !self.lost
    }

    /// Steps by a tick; none after a failed checksum.
    pub(crate) fn step(&mut self, inputs: &RowInputs) -> RowOutputs {
        if self.lost {
            return RowOutputs::default();
        }
        let output = self.muscle.step(Input {
            activation: inputs.activation,
            path_length: inputs.path_length,
            stimulation_frequency: inputs.stimulation_frequency,
        });
        // Keeps the checksum of coefficients and curve: recomputing it would hide a flipped bit.
        self.checksums[1] = self.muscle.state_checksum();
        RowOutputs {
            force: output.force,
            fascicle_length: output.fascicle_length,
            fascicle_velocity: output.fascicle_velocity,
            status: output.status.bits(),
        }
    }

    /// Channel of its electrode, if any.
    pub(crate) fn channel(&self) -> Option<u8> {
        self.electrode.as_ref().map(|(electrode, _)| electrode.channel)
    }

    /// Stimulation for an input: pulses at its frequency, of the amplitude that recruits its
    /// activation.
    pub(crate) fn demand(&self, inputs: &RowInputs) -> Demand {
        let Some((electrode, curve)) = self.electrode.as_ref().filter(|_| !self.lost) else {
            return Demand::Nothing;
        };
        let RowInputs { activation, stimulation_frequency, .. } = *inputs;
        if !activation.is_finite() || !stimulation_frequency.is_finite() {
            return Demand::NotFinite;
        }
        let (milliamperes, _) = curve.amplitude_for(activation, electrode.width_us.into());
        // `as` saturates.
        let frequency_tenths_pps = (stimulation_frequency * 10.0) as u16;
        // No pulses below 1 pps.
        if activation <= 0.0 || frequency_tenths_pps < 10 {
            return Demand::Nothing;
        }
        let stimulus = Stimulus {
            amplitude_ua: (milliamperes * 1000.0) as u32,
            width_us: electrode.width_us,
            gap_us: electrode.gap_us,
            frequency_tenths_pps,
            recovery: electrode.recovery,
        };
        Demand::Pulses(electrode.channel.into(), stimulus)
    }

    /// Words of the state.
    pub(crate) fn words(&self) -> Vec<u32, MOST_WORDS> {
        match &self.muscle {
            BankedMuscle::Continuous(_, state) => state.words().take(MOST_WORDS).collect(),
            BankedMuscle::Fes(_, state) => state.words().take(MOST_WORDS).collect(),
        }
    }

    fn sums(&self) -> [u32; 3] {
        let mut electrode = Checksum::EMPTY;
        if let Some((described, curve)) = &self.electrode {
            // The curve's parameters are not used after it is built; the built one is summed.
            let Electrode { channel, curve: _, width_us, gap_us, recovery } = described;
            electrode.add(curve.checksum());
            electrode.add(u32::from_le_bytes([*channel, *recovery, 1, 1]));
            electrode.add(u32::from(*width_us) << 16 | u32::from(*gap_us));
        }
        [self.muscle.coefficients_checksum(), self.muscle.state_checksum(), electrode.value()]
    }
}

/// A validated electrode with its recruitment curve.
fn checked(
    mode: Mode,
    electrode: Electrode,
) -> Result<(Electrode, RecruitmentCurve<f32>), Refusal<'static>> {
    if mode != Mode::Fes {
        // Only FES muscles have electrodes.
        let channel = electrode.channel.into();
        return Err(Refusal::Number {
            field: "electrode: only for FES",
            value: channel,
            least: 0,
            most: 0,
        });
    }
    within("electrode.channel", electrode.channel.into(), 0, CHANNELS as u32 - 1)?;
    let curve = RecruitmentCurve::build(&electrode.curve)?;
    // Validates the rest as a stimulus; amplitude and frequency come with each row.
    let Electrode { width_us, gap_us, recovery, .. } = electrode;
    Stimulus { amplitude_ua: 0, width_us, gap_us, frequency_tenths_pps: 10, recovery }
        .validate_shape()?;
    Ok((electrode, curve))
}
