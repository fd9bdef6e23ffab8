//! Adds up cycles over executed blocks.
//!
//! The cost of a block depends on its instructions, on the state of the pipelines before it and on
//! whether its last branch is taken. Each such passage is timed instruction by instruction when it
//! is first executed, and cached.

use super::core::Core;
use super::image::Image;
use super::instruction::{Decoder, Instruction};
use super::timing::{Pipeline, Setting};
use super::trace::Block;
use rustc_hash::FxHashMap;

/// The settings, in the order of [`Cost::cycles`].
pub const SETTINGS: [Setting; 3] = [Setting::Optimistic, Setting::Typical, Setting::Pessimistic];

/// One pipeline per setting.
type Pipelines = [Pipeline; 3];

/// Cost of one call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Instructions.
    pub instructions: u64,
    /// Cycles in the optimistic, typical and pessimistic setting.
    pub cycles: [u64; 3],
}

impl Cost {
    /// Adds a cost.
    pub fn add(&mut self, other: &Cost) {
        self.add_times(other, 1);
    }

    /// Adds a multiple of a cost.
    pub fn add_times(&mut self, other: &Cost, times: u64) {
        self.instructions += other.instructions * times;
        for (sum, cycles) in self.cycles.iter_mut().zip(other.cycles) {
            *sum += cycles * times;
        }
    }
}

/// The instructions of an image, decoded on first use.
pub struct Decoded<'a> {
    image: &'a Image,
    core: Core,
    decoder: Decoder,
    instructions: FxHashMap<u32, Instruction>,
}

impl<'a> Decoded<'a> {
    /// An empty cache of decoded instructions.
    pub fn new(image: &'a Image, core: Core) -> Result<Self, capstone::Error> {
        Ok(Self { image, core, decoder: Decoder::new()?, instructions: FxHashMap::default() })
    }

    /// The instruction at an address; the address as error if the core has no such instruction.
    pub fn at(&mut self, address: u32) -> Result<&Instruction, u32> {
        use std::collections::hash_map::Entry;
        match self.instructions.entry(address) {
            Entry::Occupied(known) => Ok(known.into_mut()),
            Entry::Vacant(new) => {
                let code = self.image.code_at(address);
                let decoded = self.decoder.decode(code, address);
                let one = decoded.filter(|one| self.core.executes(one.class)).ok_or(address)?;
                Ok(new.insert(one))
            }
        }
    }

    /// The instructions of a block.
    pub fn block(&mut self, block: Block) -> Result<Vec<Instruction>, u32> {
        let mut instructions = Vec::new();
        let mut address = block.first;
        while address <= block.last {
            let instruction = self.at(address)?;
            address += instruction.size;
            instructions.push(instruction.clone());
        }
        Ok(instructions)
    }
}

/// The cache key: everything that the cost of a block depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Passage {
    block: Block,
    /// Index of the pipeline state before the block.
    before: u32,
    /// Whether its last branch is taken.
    taken: bool,
}

/// The cached cost of a passage.
#[derive(Clone, Copy, Debug)]
struct Known {
    cost: Cost,
    /// Index of the pipeline state after the block.
    after: u32,
    /// Change of the stack pointer and its minimum within the block, relative to entry, bytes.
    stack: i32,
    lowest: i32,
    /// Number of executions while counting.
    times: u64,
}

/// Times calls of one function.
#[derive(Default)]
pub struct Estimator {
    states: Vec<Pipelines>,
    numbers: FxHashMap<Pipelines, u32>,
    passages: FxHashMap<Passage, Known>,
    /// Index of the current pipeline state.
    current: u32,
    cost: Cost,
    stack: i32,
    /// Stack high watermark, bytes.
    deepest: i32,
    /// Whether executions are counted.
    counting: bool,
}

impl Estimator {
    /// Begins a call; `counting` includes its instructions in [`Estimator::executions`].
    pub fn begin(&mut self, counting: bool) {
        self.current = index_of(&mut self.states, &mut self.numbers, Pipelines::default());
        self.cost = Cost::default();
        self.stack = 0;
        self.counting = counting;
    }

    /// Adds the cost of a block; `next` is the start of the block after it. An address without an
    /// instruction is returned as an error.
    pub fn pass(&mut self, block: Block, next: u32, decoded: &mut Decoded<'_>) -> Result<(), u32> {
        let last = decoded.at(block.last)?;
        let taken = next != block.last.wrapping_add(last.size);
        let passage = Passage { block, before: self.current, taken };
        let known = match self.passages.get_mut(&passage) {
            Some(known) => known,
            None => {
                let known = self.time(passage, decoded)?;
                self.passages.entry(passage).or_insert(known)
            }
        };
        known.times += u64::from(self.counting);
        self.cost.add(&known.cost);
        self.deepest = self.deepest.max(-(self.stack + known.lowest));
        self.stack += known.stack;
        self.current = known.after;
        Ok(())
    }

    /// Ends a call and returns its cost.
    pub fn end(&mut self) -> Cost {
        self.cost
    }

    /// Stack high watermark over all calls, below the caller's frame, bytes.
    pub fn stack_bytes(&self) -> u32 {
        u32::try_from(self.deepest).unwrap_or(0)
    }

    /// Every executed block, counted or not.
    pub fn blocks(&self) -> impl Iterator<Item = Block> {
        self.passages.keys().map(|passage| passage.block)
    }

    /// Times a passage instruction by instruction.
    fn time(&mut self, passage: Passage, decoded: &mut Decoded<'_>) -> Result<Known, u32> {
        let mut pipelines = self.states[passage.before as usize];
        let mut cost = Cost::default();
        let (mut stack, mut lowest) = (0, 0);
        for (instruction, one) in costs(passage, &mut pipelines, decoded)? {
            cost.add(&one);
            stack += instruction.stack_change;
            lowest = lowest.min(stack);
        }
        let after = index_of(&mut self.states, &mut self.numbers, pipelines);
        Ok(Known { cost, after, stack, lowest, times: 0 })
    }

    /// Every counted instruction, its execution count and its total cost.
    pub fn executions(
        &self,
        decoded: &mut Decoded<'_>,
    ) -> Result<Vec<(Instruction, u64, Cost)>, u32> {
        let mut sums: FxHashMap<u32, (Instruction, u64, Cost)> = FxHashMap::default();
        for (&passage, known) in self.passages.iter().filter(|(_, known)| known.times > 0) {
            let mut pipelines = self.states[passage.before as usize];
            for (instruction, one) in costs(passage, &mut pipelines, decoded)? {
                let address = instruction.address;
                let sum = sums.entry(address).or_insert((instruction, 0, Cost::default()));
                sum.1 += known.times;
                sum.2.add_times(&one, known.times);
            }
        }
        let mut all: Vec<_> = sums.into_values().collect();
        all.sort_by_key(|(instruction, ..)| instruction.address);
        Ok(all)
    }
}

/// Cost of each instruction of a passage.
fn costs(
    passage: Passage,
    pipelines: &mut Pipelines,
    decoded: &mut Decoded<'_>,
) -> Result<Vec<(Instruction, Cost)>, u32> {
    let core = decoded.core;
    let instructions = decoded.block(passage.block)?;
    Ok(instructions
        .into_iter()
        .map(|instruction| {
            let taken = passage.taken && instruction.address == passage.block.last;
            let mut cycles = [0; 3];
            for ((pipeline, setting), cycles) in pipelines.iter_mut().zip(SETTINGS).zip(&mut cycles)
            {
                *cycles = pipeline.execute(core, setting, &instruction, taken);
            }
            (instruction, Cost { instructions: 1, cycles })
        })
        .collect())
}

/// Index of a pipeline state, assigned on first use.
fn index_of(
    states: &mut Vec<Pipelines>,
    numbers: &mut FxHashMap<Pipelines, u32>,
    state: Pipelines,
) -> u32 {
    *numbers.entry(state).or_insert_with(|| {
        states.push(state);
        (states.len() - 1) as u32
    })
}
