//! Times the calls of some functions during the execution of an image.

use super::core::Core;
use super::estimator::{Cost, Decoded, Estimator};
use super::image::{Image, ImageError};
use super::instruction::Instruction;
use super::trace::{Block, Program, TraceError, Tracer, execute};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Why a call could not be timed.
#[derive(Debug, thiserror::Error)]
pub enum FollowError {
    /// The trace failed.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The image could not be read, or has no such function.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The decoder could not be set up.
    #[error("the disassembler: {0}")]
    Decoder(#[from] capstone::Error),
    /// An instruction could not be decoded.
    #[error("no instruction of a {} at {address:#010x}", core.name())]
    Decode {
        /// Address of the instruction.
        address: u32,
        /// The core.
        core: Core,
    },
    /// A function was not called.
    #[error("{0} was not called")]
    NotCalled(String),
    /// A function was called and did not return.
    #[error("{0} was called and did not return")]
    NotReturned(String),
    /// The program was stopped before a function had returned.
    #[error(
        "{} is still running after {seconds} s (--timeout), and {function} {}",
        program.display(),
        if *called { "was called and has not returned" } else { "was not called" }
    )]
    Endless {
        /// The program.
        program: PathBuf,
        /// Timeout, s.
        seconds: u64,
        /// The function.
        function: String,
        /// Whether a call is under way.
        called: bool,
    },
}

/// Measurements of one function.
#[derive(Clone, Debug)]
pub struct Followed {
    /// Cost of each call, from its first instruction to its return.
    pub calls: Vec<Cost>,
    /// Stack high watermark below the caller's frame, bytes. Pushes, pops and constant changes of
    /// the stack pointer are tracked.
    pub stack_bytes: u32,
    /// Address and size in bytes of every executed function.
    pub code: BTreeSet<(u32, u32)>,
    /// Whether the program was stopped at its timeout.
    pub stopped: bool,
    /// Every counted instruction, its execution count and its total cost.
    pub executions: Vec<(Instruction, u64, Cost)>,
}

impl Followed {
    /// Total size of the executed functions, bytes.
    pub fn code_bytes(&self) -> u32 {
        self.code.iter().map(|(_, bytes)| bytes).sum()
    }
}

/// Which calls go into [`Followed::executions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// All of them.
    All,
    /// One of them, counted from 0.
    At(usize),
}

/// A call under way.
struct Call {
    function: usize,
    returns_to: u32,
}

struct Follower<'a> {
    decoded: Decoded<'a>,
    entries: Vec<u32>,
    count: Count,
    estimators: Vec<Estimator>,
    calls: Vec<Vec<Cost>>,
    call: Option<Call>,
    before: Option<Block>,
}

impl Follower<'_> {
    fn observe(&mut self, block: Block) -> Result<(), u32> {
        let Some(before) = self.before.replace(block) else { return Ok(()) };
        if let Some(Call { function, returns_to }) = self.call {
            // Whether the previous block's branch was taken is only known now.
            let estimator = &mut self.estimators[function];
            estimator.pass(before, block.first, &mut self.decoded)?;
            if block.first == returns_to {
                self.calls[function].push(estimator.end());
                self.call = None;
            }
        }
        if self.call.is_none()
            && let Some(function) = self.entries.iter().position(|&entry| entry == block.first)
        {
            let caller = self.decoded.at(before.last)?;
            let returns_to = caller.address + caller.size;
            let number = self.calls[function].len();
            let counting = match self.count {
                Count::All => true,
                Count::At(call) => call == number,
            };
            self.estimators[function].begin(counting);
            self.call = Some(Call { function, returns_to });
        }
        Ok(())
    }
}

/// Runs a program with the code of `image` and times every call of the functions. Nested calls are
/// charged to the outermost call.
pub fn follow(
    image: &Image,
    program: &Program<'_>,
    tracer: Tracer,
    functions: &[&str],
    count: Count,
) -> Result<Vec<Followed>, FollowError> {
    let entries = functions
        .iter()
        .map(|name| Ok(image.function(name)?.address))
        .collect::<Result<_, ImageError>>()?;
    let mut follower = Follower {
        decoded: Decoded::new(image, program.core)?,
        entries,
        count,
        estimators: functions.iter().map(|_| Estimator::default()).collect(),
        calls: vec![Vec::new(); functions.len()],
        call: None,
        before: None,
    };
    let mut undecodable = None;
    let executed = execute(program, tracer, |block| {
        if undecodable.is_none() {
            undecodable = follower.observe(block).err();
        }
    });
    let stopped = match executed {
        Ok(()) => None,
        Err(TraceError::Endless { program, seconds }) => Some((program, seconds)),
        Err(error) => return Err(error.into()),
    };
    let no_instruction = |address| FollowError::Decode { address, core: program.core };
    if let Some(address) = undecodable {
        return Err(no_instruction(address));
    }
    let Follower { mut decoded, estimators, calls, call, .. } = follower;
    let mut all = Vec::new();
    for (index, ((estimator, calls), name)) in
        estimators.iter().zip(calls).zip(functions).enumerate()
    {
        if calls.is_empty() {
            let called = call.as_ref().is_some_and(|call| call.function == index);
            let function = (*name).to_owned();
            return Err(match stopped {
                Some((program, seconds)) => {
                    FollowError::Endless { program, seconds, function, called }
                }
                None if called => FollowError::NotReturned(function),
                None => FollowError::NotCalled(function),
            });
        }
        let code = estimator
            .blocks()
            .filter_map(|block| image.function_at(block.first))
            .map(|function| (function.address, function.size))
            .collect();
        all.push(Followed {
            calls,
            stopped: stopped.is_some(),
            stack_bytes: estimator.stack_bytes(),
            code,
            executions: estimator.executions(&mut decoded).map_err(no_instruction)?,
        });
    }
    Ok(all)
}
