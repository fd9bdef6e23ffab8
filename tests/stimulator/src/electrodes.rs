//! A fake converter and pins that record the electrodes.

use embedded_hal::digital::{ErrorType as PinErrorType, OutputPin};
use embedded_hal::spi::{ErrorKind, ErrorType as SpiErrorType, Operation, SpiDevice};
use firmware::{Bridge, OutputStage, Scale};
use std::cell::RefCell;
use std::rc::Rc;

/// Channels of the stage.
pub const CHANNELS: usize = 4;
/// 50 mA by twelve bits.
pub const SCALE: Scale = Scale { full_scale_ua: 50_000, full_scale_counts: 4095 };

/// State of the electrodes, and violations so far.
#[derive(Debug, Default)]
pub struct Electrodes {
    /// Of the converter.
    pub counts: u16,
    /// Levels of the bridge's pins.
    pub cathodic: bool,
    /// See `cathodic`.
    pub anodic: bool,
    /// Levels of the channels' pins.
    pub channels: [bool; CHANNELS],
    /// Counts times µs that went through each channel.
    pub charges: [i64; CHANNELS],
    /// Violations.
    pub problems: Vec<String>,
    /// Words to the converter since a step began.
    pub words: u32,
    /// Until all were low once, several channels may be connected.
    pub starting: bool,
    /// Words that the converter will not take.
    pub missed_words: u32,
    /// Converter or pins that do not answer any more.
    pub broken_converter: bool,
    /// See `broken_converter`.
    pub broken_pins: bool,
}

/// Electrodes that converter, pins and test share.
pub type Shared = Rc<RefCell<Electrodes>>;

/// Where a pin is.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// In the bridge.
    Cathodic,
    /// In the bridge.
    Anodic,
    /// At a channel.
    Channel(usize),
}

/// A pin that tells the electrodes its level.
#[derive(Debug)]
pub struct Pin(Shared, Place);

impl PinErrorType for Pin {
    type Error = embedded_hal::digital::ErrorKind;
}

impl Pin {
    fn set(&mut self, level: bool) -> Result<(), embedded_hal::digital::ErrorKind> {
        let mut electrodes = self.0.borrow_mut();
        if electrodes.broken_pins {
            return Err(embedded_hal::digital::ErrorKind::Other);
        }
        let changed = match self.1 {
            Place::Cathodic => std::mem::replace(&mut electrodes.cathodic, level) != level,
            Place::Anodic => std::mem::replace(&mut electrodes.anodic, level) != level,
            Place::Channel(index) => {
                std::mem::replace(&mut electrodes.channels[index], level) != level
            }
        };
        // With a converter that does not answer there is no other way.
        if changed && electrodes.counts != 0 && !electrodes.broken_converter {
            electrodes.problems.push(format!("{:?} switched under current", self.1));
        }
        let connected = electrodes.channels.iter().filter(|connected| **connected).count();
        electrodes.starting &= connected > 0;
        if connected > 1 && !electrodes.starting && !electrodes.broken_pins {
            electrodes.problems.push("two channels at once".to_owned());
        }
        if electrodes.cathodic && electrodes.anodic {
            electrodes.problems.push("both sides of the bridge".to_owned());
        }
        Ok(())
    }
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        self.set(false)
    }
    fn set_high(&mut self) -> Result<(), Self::Error> {
        self.set(true)
    }
}

/// A converter that tells the electrodes its count.
#[derive(Debug)]
pub struct Converter(Shared);

impl SpiErrorType for Converter {
    type Error = ErrorKind;
}

impl SpiDevice for Converter {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let mut electrodes = self.0.borrow_mut();
        if electrodes.broken_converter {
            return Err(ErrorKind::Other);
        }
        if electrodes.missed_words > 0 {
            electrodes.missed_words -= 1;
            return Err(ErrorKind::Other);
        }
        for operation in operations {
            let &mut Operation::Write(&[high, low]) = operation else {
                electrodes.problems.push("not a word to the converter".to_owned());
                continue;
            };
            if high & 0xf0 != 0x30 {
                electrodes.problems.push(format!("control bits {high:#x}"));
            }
            // A word takes time: a current that begins or ends with any but a step's first lasts
            // too long or too short.
            let counts = u16::from_be_bytes([high & 0x0f, low]);
            if electrodes.words > 0 && counts != electrodes.counts {
                electrodes
                    .problems
                    .push("a current that does not begin or end with its step".to_owned());
            }
            electrodes.words += 1;
            electrodes.counts = counts;
        }
        Ok(())
    }
}

/// A stage on fakes.
pub type Stage = OutputStage<Converter, Pin, CHANNELS>;

/// An output stage with its electrodes.
pub fn stage() -> (Stage, Shared) {
    let shared = Shared::default();
    // As after a reset that came at the worst moment.
    *shared.borrow_mut() = Electrodes {
        cathodic: true,
        channels: [true; CHANNELS],
        starting: true,
        ..Electrodes::default()
    };
    let pin = |place| Pin(Rc::clone(&shared), place);
    let bridge = Bridge { cathodic: pin(Place::Cathodic), anodic: pin(Place::Anodic) };
    let channels = std::array::from_fn(|index| pin(Place::Channel(index)));
    let stage = Stage::new(Converter(Rc::clone(&shared)), bridge, channels).expect("a stage");
    (stage, shared)
}
