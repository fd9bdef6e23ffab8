//! The output stage over `embedded-hal`: a current source set through a converter on SPI, a bridge that turns
//! its current round, and a switch per channel.

use crate::schedule::Step;
use crate::waveform::{Direction, Phase};
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

/// Pins of the bridge. With both low, the electrodes are connected to each other, and what charge is left on
/// them flows off.
#[derive(Debug)]
pub struct Bridge<P> {
    /// High while current flows out of the tissue at the working electrode.
    pub cathodic: P,
    /// High while it flows in.
    pub anodic: P,
}

/// Something on the way to the electrodes did not answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputError {
    /// The converter.
    Converter,
    /// A pin.
    Pin,
    /// A channel that there is not.
    Channel,
}

/// The output stage of `CHANNELS` channels, of which one at a time is connected.
#[derive(Debug)]
pub struct OutputStage<D, P, const CHANNELS: usize> {
    converter: D,
    bridge: Bridge<P>,
    channels: [P; CHANNELS],
    /// The channel that is connected, and where its current flows.
    connected: Option<(usize, Direction)>,
}

/// First byte to a converter of the MCP4921's kind: unbuffered, gain 1, active; then four bits of the count.
const WRITE: u8 = 0x30;

impl<D: SpiDevice, P: OutputPin, const CHANNELS: usize> OutputStage<D, P, CHANNELS> {
    /// Takes over converter and pins, and puts them in neutral before anything else.
    pub fn new(
        converter: D,
        bridge: Bridge<P>,
        channels: [P; CHANNELS],
    ) -> Result<Self, OutputError> {
        let mut stage = Self { converter, bridge, channels, connected: None };
        stage.neutral()?;
        Ok(stage)
    }

    /// Puts out a step; where it fails, what can be put in neutral is.
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

    /// No current, no direction, no channel: every pin is tried, whatever the others say.
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

    /// No current, and both sides of the bridge low: the channel that was connected stays so, and what charge is
    /// on its electrodes flows off. [`neutral`](Self::neutral) is to follow.
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

    /// A phase with current is never one that switches: its first word is its only one.
    fn drive(&mut self, channel: usize, phase: Phase) -> Result<(), OutputError> {
        if self.connected == Some((channel, phase.direction)) {
            return self.convert(phase.counts);
        }
        self.connect(channel, phase.direction)?;
        if phase.counts > 0 { self.convert(phase.counts) } else { Ok(()) }
    }

    /// Connects a channel in a direction, without current while anything switches.
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
