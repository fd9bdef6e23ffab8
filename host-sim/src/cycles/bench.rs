//! The bench: every tick of every case, timed in all settings.

use super::image::{Image, ImageError};
use super::instruction::{Decoder, Instruction};
use super::timing::{Core, Setting};
use super::trace::{TraceError, execute};
use crate::scenario::Scenario;
use crate::target::{self, TargetError};
use std::collections::{BTreeSet, HashMap};
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

/// Times every call of the cases' functions in an image.
fn measure_image(path: &Path, cases: &[Case]) -> Result<Vec<Measured>, BenchError> {
    let image = Image::read(path)?;
    let entries: Vec<u32> = cases
        .iter()
        .map(|case| Ok(image.function(case.function)?.address))
        .collect::<Result<_, ImageError>>()?;
    let decoder = Decoder::new().map_err(|error| BenchError::Decoder(error.to_string()))?;
    let mut measured: Vec<Measured> = cases
        .iter()
        .map(|&case| Measured { case, ticks: Vec::new(), stack_bytes: 0, code_bytes: 0 })
        .collect();
    let mut executed: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); cases.len()];
    let mut decoded: HashMap<u32, Instruction> = HashMap::new();
    let mut undecodable = None;
    let mut call: Option<Call> = None;
    let mut before: Option<u32> = None;

    execute(path, |address| {
        if let Some(one) = &mut call {
            // The instruction before is timed now that it is known where it led.
            if let Some(instruction) = before.and_then(|address| decoded.get(&address)) {
                one.instructions += 1;
                one.stack += instruction.stack_change;
                for core in &mut one.cores {
                    core.execute(instruction, address);
                }
                let depth = u32::try_from(-one.stack).unwrap_or(0);
                let all = &mut measured[one.case];
                all.stack_bytes = all.stack_bytes.max(depth);
            }
            if address == one.returns_to {
                let cycles = [0, 1, 2].map(|setting| one.cores[setting].cycles());
                let cost = Cost { instructions: one.instructions, cycles };
                measured[one.case].ticks.push(cost);
                call = None;
            }
        }
        if call.is_none()
            && let Some(case) = entries.iter().position(|&entry| entry == address)
            && let Some(caller) = before
        {
            // A call is a BL, of four bytes; one by register has two.
            let wide = image.code_at(caller).get(1).is_some_and(|high| high >> 3 >= 0b11101);
            call = Some(Call {
                case,
                returns_to: caller + if wide { 4 } else { 2 },
                cores: SETTINGS.map(Core::new),
                instructions: 0,
                stack: 0,
            });
        }
        if let Some(one) = &call
            && executed[one.case].insert(address)
            && !decoded.contains_key(&address)
        {
            match decoder.decode(image.code_at(address), address) {
                Some(instruction) => drop(decoded.insert(address, instruction)),
                None => undecodable = Some(address),
            }
        }
        before = Some(address);
    })?;
    if let Some(address) = undecodable {
        return Err(BenchError::Decode(address));
    }
    for (all, addresses) in measured.iter_mut().zip(&executed) {
        if all.ticks.is_empty() {
            return Err(BenchError::NotExecuted(all.case.name));
        }
        let functions: BTreeSet<(u32, u32)> = addresses
            .iter()
            .filter_map(|&address| image.function_at(address))
            .map(|function| (function.address, function.size))
            .collect();
        all.code_bytes = functions.iter().map(|(_, size)| size).sum();
    }
    Ok(measured)
}
