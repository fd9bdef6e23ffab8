//! Profiles one function: a case of the bench, a single tick of it, or any function of any Cortex-M
//! image.

use super::bench::{BenchError, measure};
use super::boot::{self, Argument, BootError};
use super::breakdown::{Part, by_class, by_file, by_function};
use super::case::{self, CASES, Case, Run};
use super::core::Core;
use super::estimator::Cost;
use super::follow::{Count, FollowError, Followed, follow};
use super::image::{Image, ImageError};
use super::instruction::Instruction;
use super::trace::{Program, Tracer};
use crate::engine::Class;
use crate::output_file::temporary_folder;
use crate::reference::Input;
use crate::target;
use std::path::Path;
use std::time::Duration;

/// Why a function could not be profiled.
#[derive(Debug, thiserror::Error)]
pub enum ProfileError {
    /// Unknown case.
    #[error("--case {0}: must be one of {names}", names = CASES.map(|case| case.name).join(", "))]
    NoCase(String),
    /// Tick out of range.
    #[error("--tick {tick}: {case} has ticks 0 to {last}")]
    NoTick {
        /// The tick.
        tick: usize,
        /// The case.
        case: &'static str,
        /// Its last tick.
        last: usize,
    },
    /// The bench could not be run.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// The image could not be traced or timed.
    #[error(transparent)]
    Follow(#[from] FollowError),
    /// The function cannot be called directly.
    #[error(transparent)]
    Boot(#[from] BootError),
    /// The image could not be read.
    #[error(transparent)]
    Image(#[from] ImageError),
}

/// The profile of a function.
#[derive(Clone, Debug)]
pub struct Profile {
    /// Title for printing.
    pub title: String,
    /// Whether the program was stopped at its timeout.
    pub stopped: bool,
    /// Cost of each call.
    pub calls: Vec<Cost>,
    /// Stack high watermark, bytes.
    pub stack_bytes: u32,
    /// Total size of the executed functions, bytes.
    pub code_bytes: u32,
    /// Cost of each function.
    pub functions: Vec<Part>,
    /// Cost of each source file of the model.
    pub files: Vec<Part>,
    /// Cost of each class of instruction.
    pub classes: Vec<Part>,
    /// Every executed instruction, its execution count and its total cost.
    pub executions: Vec<(Instruction, u64, Cost)>,
}

impl Profile {
    fn new(title: String, image: &Image, followed: Followed) -> Result<Self, ImageError> {
        Ok(Self {
            title,
            stopped: followed.stopped,
            functions: by_function(image, &followed.executions),
            files: by_file(image, &followed.executions)?,
            classes: by_class(&followed.executions),
            code_bytes: followed.code_bytes(),
            calls: followed.calls,
            stack_bytes: followed.stack_bytes,
            executions: followed.executions,
        })
    }
}

/// Profiles a case of the bench on a core: all ticks, or one tick. For one tick only the inputs up
/// to it are run.
pub fn of_case(
    core: Core,
    name: &str,
    tick: Option<usize>,
    tracer: Tracer,
    class: Class,
) -> Result<Profile, ProfileError> {
    let case = Case::named(name).ok_or_else(|| ProfileError::NoCase(name.to_owned()))?;
    let mut runs = case::runs_of(&[*case]);
    let mut title = format!("{name} on a {}, all ticks", core.name());
    let mut count = Count::All;
    if let Some(tick) = tick {
        let (run, row) = locate(&runs, tick).ok_or_else(|| {
            let ticks: usize = runs.iter().map(Run::ticks).sum();
            ProfileError::NoTick { tick, case: case.name, last: ticks - 1 }
        })?;
        let mut run = run.clone();
        run.scenario.trace.inputs.truncate(row + 1);
        let Input { activation, path_length, stimulation_frequency } =
            run.scenario.trace.inputs[row];
        title = format!(
            "{name} on a {}, tick {tick}: row {row} of {} (activation {activation}, \
             path {path_length} m, {stimulation_frequency} pps)",
            core.name(),
            run.scenario.name
        );
        // The rows before it are executed to reach its state, but not counted.
        count = Count::At(row - 1);
        runs = vec![run];
    }
    let (image, followed) = measure(core, &[*case], &runs, tracer, count, class)?;
    let Some(mut followed) = followed.into_iter().next() else {
        return Err(FollowError::NotCalled(case.function.to_owned()).into());
    };
    if let Count::At(call) = count {
        followed.calls = followed.calls.split_off(call);
    }
    Ok(Profile::new(title, &image, followed)?)
}

/// The run that contains a tick, counted from 0 over all runs, and its row in that run.
fn locate(runs: &[Run], tick: usize) -> Option<(&Run, usize)> {
    let mut before = 0;
    for run in runs {
        if tick < before + run.ticks() {
            return Some((run, tick - before + 1));
        }
        before += run.ticks();
    }
    None
}

/// Profiles a function of an image: all calls by its own program that return before `timeout`, or,
/// with `arguments`, one direct call.
pub fn of_image(
    path: &Path,
    function: &str,
    arguments: Option<&[Argument]>,
    machine: &str,
    tracer: Tracer,
    timeout: Duration,
) -> Result<Profile, ProfileError> {
    let mut image = Image::read(path)?;
    let entry = image.function(function)?.clone();
    let folder = temporary_folder().map_err(BootError::Write)?;
    let core = Core::CortexM4F;
    let mut program = Program { image: path, machine, core, arguments: Vec::new(), timeout };
    if let Some(arguments) = arguments {
        program.arguments = boot::loader_arguments(path, entry.address, arguments, folder.path())?;
        let (address, code) = boot::code();
        image.add_code(address, code);
    }
    let followed = follow(&image, &program, tracer, &[function], Count::All)?;
    let Some(followed) = followed.into_iter().next() else {
        return Err(FollowError::NotCalled(function.to_owned()).into());
    };
    let (name, address) = (&entry.name, entry.address);
    let title = format!("{name} at {address:#010x} of {} on {machine}", path.display());
    Ok(Profile::new(title, &image, followed)?)
}

/// Default QEMU machine.
pub const MACHINE: &str = target::STM32F405.machine;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tick_is_found_in_its_run() {
        let runs = case::runs();
        let first = runs[0].ticks();
        assert_eq!(locate(&runs, 0).map(|(_, row)| row), Some(1));
        let (run, row) = locate(&runs, first).expect("a tick of the second run");
        assert_eq!((run.scenario.name.as_str(), row), (runs[1].scenario.name.as_str(), 1));
        let all: usize = runs.iter().map(Run::ticks).sum();
        assert!(locate(&runs, all - 1).is_some() && locate(&runs, all).is_none());
    }
}
