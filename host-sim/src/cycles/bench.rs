//! The bench: every tick of every case, timed in all settings.

use super::image::{Image, ImageError};
use super::instruction::{Decoder, Instruction};
use super::timing::{Core, Setting};
use super::trace::{TraceError, execute};
use crate::scenario::Scenario;
use crate::target::{self, TargetError};
use std::collections::BTreeSet;
use std::path::Path;

/// Why a case could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The target or QEMU is not to be had.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// The trace failed.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The image is not what it should be.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The decoder could not be set up.
    #[error("the disassembler: {0}")]
    Decoder(String),
    /// An instruction could not be decoded.
    #[error("no instruction at {0:#010x}")]
    Decode(u32),
    /// The inputs could not be written.
    #[error("the inputs of the bench: {0}")]
    Inputs(std::io::Error),
    /// A case was not executed.
    #[error("{0} was not executed")]
    NotExecuted(&'static str),
}

/// A function of the bench, and what it stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    /// Name of the case.
    pub name: &'static str,
    /// The bench's function.
    pub function: &'static str,
}

/// Cost of one call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Instructions.
    pub instructions: u64,
    /// Cycles in the optimistic, typical and pessimistic setting.
    pub cycles: [u64; 3],
}

/// What a case costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Which case.
    pub case: Case,
    /// Of each tick.
    pub ticks: Vec<Cost>,
    /// Deepest stack below the caller's, bytes.
    pub stack_bytes: u32,
    /// Code of all functions that were executed, bytes.
    pub code_bytes: u32,
}

/// The settings, in the order of [`Cost::cycles`].
const SETTINGS: [Setting; 3] = [Setting::Optimistic, Setting::Typical, Setting::Pessimistic];

/// A call that is being followed.
struct Call {
    case: usize,
    returns_to: u32,
    cores: [Core; 3],
    instructions: u64,
    stack: i32,
}

/// Runs the bench on the inputs of scenarios and times every tick of the cases.
pub fn measure(cases: &[Case], scenarios: &[Scenario]) -> Result<Vec<Measured>, BenchError> {
    let folder = tempfile::tempdir().map_err(BenchError::Inputs)?;
    let inputs = folder.path().join("inputs.bin");
    std::fs::write(&inputs, encode(scenarios)).map_err(BenchError::Inputs)?;
    let path = target::build("bench", &[("VM_BENCH_INPUTS", &inputs)])?;
    measure_image(&path, cases)
}

/// The inputs in the bench's format.
fn encode(scenarios: &[Scenario]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for scenario in scenarios {
        let inputs = &scenario.trace.inputs;
        bytes.extend((inputs.len() as u32).to_le_bytes());
        for input in inputs {
            for value in [input.activation, input.path_length, input.stimulation_frequency] {
                bytes.extend((value as f32).to_le_bytes());
            }
        }
    }
    bytes
}

/// The instructions of an image, each decoded when it is first met.
struct Decoded<'a> {
    image: &'a Image,
    decoder: Decoder,
    base: u32,
    /// By half the distance from the base.
    slots: Vec<Option<Instruction>>,
    undecodable: Option<u32>,
}

impl<'a> Decoded<'a> {
    fn new(image: &'a Image) -> Result<Self, BenchError> {
        let decoder = Decoder::new().map_err(|error| BenchError::Decoder(error.to_string()))?;
        let (base, end) = image.code_range();
        let slots = vec![None; ((end - base) / 2) as usize];
        Ok(Self { image, decoder, base, slots, undecodable: None })
    }

    fn slot(&self, address: u32) -> Option<usize> {
        let slot = (address.checked_sub(self.base)? / 2) as usize;
        (slot < self.slots.len()).then_some(slot)
    }

    fn at(&mut self, address: u32) -> Option<&Instruction> {
        let Some(slot) = self.slot(address) else {
            self.undecodable = Some(address);
            return None;
        };
        if self.slots[slot].is_none() {
            self.slots[slot] = self.decoder.decode(self.image.code_at(address), address);
            if self.slots[slot].is_none() {
                self.undecodable = Some(address);
            }
        }
        self.slots[slot].as_ref()
    }
}

/// Follows calls of the cases' functions through a trace.
struct Follower<'a> {
    decoded: Decoded<'a>,
    entries: Vec<u32>,
    measured: Vec<Measured>,
    /// Which cases have executed an instruction, a bit each, by slot.
    executed: Vec<u32>,
    call: Option<Call>,
    before: Option<u32>,
}

impl Follower<'_> {
    fn see(&mut self, address: u32) {
        if let (Some(call), Some(before)) = (&mut self.call, self.before) {
            // The instruction before is timed now that it is known where it led.
            if let Some(slot) = self.decoded.slot(before) {
                self.executed[slot] |= 1 << call.case;
            }
            if let Some(instruction) = self.decoded.at(before) {
                call.instructions += 1;
                call.stack += instruction.stack_change;
                for core in &mut call.cores {
                    core.execute(instruction, address);
                }
            }
            let measured = &mut self.measured[call.case];
            let depth = u32::try_from(-call.stack).unwrap_or(0);
            measured.stack_bytes = measured.stack_bytes.max(depth);
            if address == call.returns_to {
                let cycles = [0, 1, 2].map(|setting| call.cores[setting].cycles());
                measured.ticks.push(Cost { instructions: call.instructions, cycles });
                self.call = None;
            }
        } else if let Some(case) = self.entries.iter().position(|&entry| entry == address)
            && let Some(caller) = self.before
            && let Some(instruction) = self.decoded.at(caller)
        {
            self.call = Some(Call {
                case,
                returns_to: caller + instruction.size,
                cores: SETTINGS.map(Core::new),
                instructions: 0,
                stack: 0,
            });
        }
        self.before = Some(address);
    }
}

/// Times every call of the cases' functions in an image.
fn measure_image(path: &Path, cases: &[Case]) -> Result<Vec<Measured>, BenchError> {
    let image = Image::read(path)?;
    let decoded = Decoded::new(&image)?;
    let mut follower = Follower {
        entries: cases
            .iter()
            .map(|case| Ok(image.function(case.function)?.address))
            .collect::<Result<_, ImageError>>()?,
        measured: cases
            .iter()
            .map(|&case| Measured { case, ticks: Vec::new(), stack_bytes: 0, code_bytes: 0 })
            .collect(),
        executed: vec![0; decoded.slots.len()],
        decoded,
        call: None,
        before: None,
    };
    execute(path, |address| follower.see(address))?;
    if let Some(address) = follower.decoded.undecodable {
        return Err(BenchError::Decode(address));
    }
    let Follower { decoded, mut measured, executed, .. } = follower;
    for (case, all) in measured.iter_mut().enumerate() {
        if all.ticks.is_empty() {
            return Err(BenchError::NotExecuted(all.case.name));
        }
        let functions: BTreeSet<(u32, u32)> = executed
            .iter()
            .zip((decoded.base..).step_by(2))
            .filter(|(cases, _)| *cases & (1 << case) != 0)
            .filter_map(|(_, address)| image.function_at(address))
            .map(|function| (function.address, function.size))
            .collect();
        all.code_bytes = functions.iter().map(|(_, size)| size).sum();
    }
    Ok(measured)
}
