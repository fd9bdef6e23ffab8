//! Output stage over `embedded-hal`: a current source set by a converter on SPI, a bridge that
//! reverses the current, and a switch per channel.

use crate::between::step::Step;
use crate::between::waveform::{Direction, Phase};
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

/// Pins of the bridge. With both low, the electrodes are shorted to each other, and residual charge
/// decays.
#[derive(Debug)]
pub struct Bridge<P> {
    /// High for the cathodic phase: current out of the tissue at the working electrode.
    pub cathodic: P,
    /// High for the anodic phase.
    pub anodic: P,
}

/// A part of the output stage failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputError {
    /// The converter.
    Converter,
    /// A pin.
    Pin,
    /// No such channel.
    Channel,
}

/// Output stage of `CHANNELS` channels, of which at most one is connected.
#[derive(Debug)]
pub struct OutputStage<D, P, const CHANNELS: usize> {
    converter: D,
    bridge: Bridge<P>,
    channels: [P; CHANNELS],
    /// Connected channel and direction of its current.
    connected: Option<(usize, Direction)>,
}

/// First byte to an MCP4921: unbuffered, gain 1, active, and four bits of the count.
const WRITE: u8 = 0x30;

impl<D: SpiDevice, P: OutputPin, const CHANNELS: usize> OutputStage<D, P, CHANNELS> {
    /// Takes over converter and pins and puts them in neutral first.
    pub fn new(
        converter: D,
        bridge: Bridge<P>,
        channels: [P; CHANNELS],
    ) -> Result<Self, OutputError> {
        let mut stage = Self { converter, bridge, channels, connected: None };
        stage.neutral()?;
        Ok(stage)
    }

    /// Outputs a step; on an error puts everything it can in neutral.
    pub fn apply(&mut self, step: &Step) -> Result<(), OutputError> {
        let done = match step.output {
            Some((channel, phase)) => self.drive(channel, phase),
            None if self.connected.is_some() => self.neutral(),
            None => Ok(()),
        };
        if done.is_err() {
            let _the_first_error_counts = self.neutral();
        }
        done
    }

    /// No current, no direction, no channel; tries every pin even after an error.
    pub fn neutral(&mut self) -> Result<(), OutputError> {
        self.connected = None;
        let converter = self.convert(0);
        let mut pins = Ok(());
        let bridge = [&mut self.bridge.cathodic, &mut self.bridge.anodic];
        for pin in bridge.into_iter().chain(&mut self.channels) {
            if pin.set_low().is_err() {
                pins = Err(OutputError::Pin);
            }
        }
        converter.and(pins)
    }

    /// Whether a channel is connected to the source.
    pub fn is_connected(&self) -> bool {
        self.connected.is_some()
    }

    /// No current, both sides of the bridge low, and the channel stays connected: residual charge
    /// of its electrodes decays. [`neutral`](Self::neutral) must follow.
    pub fn discharge(&mut self) -> Result<(), OutputError> {
        self.connected = None;
        let converter = self.convert(0);
        let mut pins = Ok(());
        for pin in [&mut self.bridge.cathodic, &mut self.bridge.anodic] {
            if pin.set_low().is_err() {
                pins = Err(OutputError::Pin);
            }
        }
        converter.and(pins)
    }

    /// Phases with current never switch: their first word is their only one.
    fn drive(&mut self, channel: usize, phase: Phase) -> Result<(), OutputError> {
        if self.connected == Some((channel, phase.direction)) {
            return self.convert(phase.counts);
        }
        self.connect(channel, phase.direction)?;
        if phase.counts > 0 { self.convert(phase.counts) } else { Ok(()) }
    }

    /// Connects a channel in a direction, without current during switching.
    fn connect(&mut self, channel: usize, direction: Direction) -> Result<(), OutputError> {
        if channel >= CHANNELS {
            return Err(OutputError::Channel);
        }
        self.convert(0)?;
        let Bridge { cathodic, anodic } = &mut self.bridge;
        let (on, off) = match direction {
            Direction::Cathodic => (cathodic, anodic),
            Direction::Anodic => (anodic, cathodic),
        };
        // Never both high: that would connect the source to itself.
        off.set_low().map_err(|_| OutputError::Pin)?;
        // All others are off before one is on.
        for (_, pin) in self.channels.iter_mut().enumerate().filter(|(index, _)| *index != channel)
        {
            pin.set_low().map_err(|_| OutputError::Pin)?;
        }
        if let Some(pin) = self.channels.get_mut(channel) {
            pin.set_high().map_err(|_| OutputError::Pin)?;
        }
        on.set_high().map_err(|_| OutputError::Pin)?;
        self.connected = Some((channel, direction));
        Ok(())
    }

    fn convert(&mut self, counts: u16) -> Result<(), OutputError> {
        let [high, low] = counts.to_be_bytes();
        self.converter.write(&[WRITE | (high & 0x0f), low]).map_err(|_| OutputError::Converter)
    }
}
