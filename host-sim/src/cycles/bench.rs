//! Builds and runs the bench, the image that steps each case through its inputs, and times every
//! tick.

use super::case::{Case, Run};
use super::core::Core;
use super::follow::{Count, FollowError, Followed, follow};
use super::image::Image;
use super::trace::{Program, Tracer};
use crate::engine::Class;
use crate::output_file::temporary_folder;
use crate::target::{self, TargetError};
use std::path::Path;

/// Why a case could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The target toolchain or QEMU is missing, or the build failed.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// The bench could not be traced or timed.
    #[error(transparent)]
    Follow(#[from] FollowError),
    /// The bench did not end within its timeout.
    #[error("the bench is still running after {0} s")]
    Endless(u64),
    /// The inputs could not be written.
    #[error("the inputs of the bench: {0}")]
    Inputs(#[from] std::io::Error),
}

/// Builds the bench for a core with the inputs of `runs` and times every tick of the cases. Returns
/// the image as well.
pub fn measure(
    core: Core,
    cases: &[Case],
    runs: &[Run],
    tracer: Tracer,
    count: Count,
    class: Class,
) -> Result<(Image, Vec<Followed>), BenchError> {
    let folder = temporary_folder()?;
    let inputs = folder.path().join("inputs.bin");
    std::fs::write(&inputs, encode(runs))?;
    let path = target::build(
        core.board(),
        target::BENCH,
        &[("VM_BENCH_INPUTS", &inputs), ("VM_BENCH_CLASS", Path::new(class.name()))],
    )?;
    let image = Image::read(&path).map_err(FollowError::from)?;
    let functions: Vec<&str> = cases.iter().map(|case| case.function).collect();
    let program = Program::on_board(&path, core);
    let followed = follow(&image, &program, tracer, &functions, count)?;
    if followed.iter().any(|followed| followed.stopped) {
        return Err(BenchError::Endless(program.timeout.as_secs()));
    }
    Ok((image, followed))
}

/// Encodes the inputs in the bench's binary format.
fn encode(runs: &[Run]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for run in runs {
        let inputs = &run.scenario.trace.inputs;
        bytes.extend(run.mask.to_le_bytes());
        bytes.extend((inputs.len() as u32).to_le_bytes());
        for input in inputs {
            for value in [input.activation, input.path_length, input.stimulation_frequency] {
                bytes.extend((value as f32).to_le_bytes());
            }
        }
    }
    bytes
}
