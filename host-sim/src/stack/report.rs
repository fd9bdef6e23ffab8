//! Memory budget of a chip: statics, deepest stack, and free memory.

use super::calls::{Calls, Deepest};
use super::description::{Description, Priority};
use super::function::Functions;
use crate::cycles::{Image, ImageError};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Why the stack could not be computed.
#[derive(Debug, thiserror::Error)]
pub enum StackError {
    /// The image cannot be read.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The disassembler did not start.
    #[error("the disassembler: {0}")]
    Decoder(#[from] capstone::Error),
    /// The image has no vector table.
    #[error("{0}: no section .vector_table")]
    NoVectors(String),
}

/// Stack of a task.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Entry {
    /// Task.
    pub task: String,
    /// `thread`, a priority, or `fault`.
    pub priority: String,
    /// Its deepest path, without the exception frame.
    pub deepest: Deepest,
}

/// Memory budget of a program, bytes.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Report {
    /// All tasks.
    pub entries: Vec<Entry>,
    /// Exception frames when all tasks are nested.
    pub core_frames: u32,
    /// Deepest stack, all tasks nested.
    pub stack: u32,
    /// Memory reserved for the stack.
    pub room_for_stack: u32,
    /// Statics.
    pub statics: u32,
    /// RAM of the chip.
    pub ram: u32,
    /// Free memory.
    pub free: u32,
    /// Violations and unknowns.
    pub problems: Vec<String>,
}

/// Exception frame: 26 words with the FPU's, which are always reserved, and one of alignment.
const EXCEPTION_FRAME: u32 = 26 * 4 + 4;

/// Computes the budget of an image.
pub fn report(path: &Path, description: &Description) -> Result<Report, StackError> {
    let image = Image::read(path)?;
    let mut functions = Functions::new(&image)?;
    let mut problems = BTreeSet::new();
    let (vectors, top) = vectors(&image, description, &mut problems)?;
    let mut calls = Calls::new(&mut functions, &description.indirect);

    let thread = image.function(&description.thread.entry)?.address;
    let boot = image.function(&description.thread.boot)?.address;
    let mut entries = Vec::new();
    let mut add = |task: &str, priority: String, deepest: &Deepest| {
        entries.push(Entry { task: task.to_owned(), priority, deepest: deepest.clone() });
    };
    let boot_path = calls.deepest_through(thread, boot).unwrap_or_default();
    add("boot", "thread".to_owned(), &boot_path);
    let idle_path = calls.deepest_without(thread, boot);
    add("idle", "thread".to_owned(), &idle_path);
    let mut levels: BTreeMap<Priority, u32> = BTreeMap::new();
    for handler in &description.handlers {
        let Some(&address) = vectors.get(&handler.vector) else { continue };
        let ends = matches!(handler.priority, Priority::Ends(_));
        calls.may_reset = ends.then_some(address);
        let deepest = calls.deepest(address);
        if ends && deepest.bytes != 0 {
            let needs = format!("{}: it needs {} B of stack", handler.function, deepest.bytes);
            problems.insert(needs);
        }
        let level = levels.entry(handler.priority).or_default();
        *level = deepest.bytes.max(*level);
        let priority = match handler.priority {
            Priority::Level(level) => level.to_string(),
            Priority::Ends(_) => "fault".to_owned(),
        };
        add(&handler.task, priority, &deepest);
    }
    let default_handler = image.function(&description.default_handler)?.address;
    calls.may_reset = Some(default_handler);
    let default_path = calls.deepest(default_handler);
    add("all other vectors", "any".to_owned(), &default_path);

    problems.extend(calls.unknown);
    for (index, indirect) in description.indirect.iter().enumerate() {
        if !calls.used.contains(&index) {
            problems.insert(format!("stale: no indirect call in {}", indirect.function));
        }
    }
    let steps = entries.iter().flat_map(|entry| &entry.deepest.path);
    for step in steps.filter(|step| step.bytes > description.ram.guard_bytes) {
        problems.insert(format!(
            "{} takes {} B: it may skip the {} B guard below RAM",
            step.function, step.bytes, description.ram.guard_bytes
        ));
    }

    // One handler per priority, and the fault handlers on top.
    let interruptions = levels.len() as u32 + 1;
    let core_frames = interruptions * EXCEPTION_FRAME;
    let stack = boot_path.bytes.max(idle_path.bytes)
        + levels.values().sum::<u32>()
        + default_path.bytes
        + core_frames;
    let (statics, room_for_stack) = memory(&image, description, top, &mut problems);
    let ram = description.ram.bytes;
    let free = ram.saturating_sub(statics + stack);
    if stack > room_for_stack {
        problems.insert(format!("the stack needs {stack} B and has {room_for_stack}"));
    }
    let least = description.ram.least_free_percent;
    if u64::from(free) * 100 < u64::from(ram) * u64::from(least) {
        problems.insert(format!("{free} B of {ram} are free: less than {least} %"));
    }
    let problems = problems.into_iter().collect();
    Ok(Report { entries, core_frames, stack, room_for_stack, statics, ram, free, problems })
}

/// Functions of the described vectors, and the initial stack pointer.
fn vectors(
    image: &Image,
    description: &Description,
    problems: &mut BTreeSet<String>,
) -> Result<(BTreeMap<u32, u32>, u32), StackError> {
    let table = image.sections().iter().find(|section| section.name == ".vector_table");
    let table =
        table.ok_or_else(|| StackError::NoVectors(image.path.display().to_string()))?.clone();
    let word = |index: u32| image.word_at(table.address + 4 * index).unwrap_or(0);
    let name = |index: u32| {
        let function = image.function_at(word(index) & !1);
        function.map_or("unknown", |function| function.name.as_str())
    };
    let mut found = BTreeMap::new();
    let mut expected = BTreeMap::from([(1, description.thread.entry.as_str())]);
    for handler in &description.handlers {
        if expected.insert(handler.vector, &handler.function).is_some() {
            problems.insert(format!("vector {} is described twice", handler.vector));
        }
    }
    for index in (1..table.size / 4).filter(|&index| word(index) != 0) {
        let expected = expected.remove(&index).unwrap_or(&description.default_handler);
        if name(index) != expected {
            let name = name(index);
            problems.insert(format!("vector {index} is {name}, described as {expected}"));
        }
        found.insert(index, word(index) & !1);
    }
    for (index, function) in expected {
        problems.insert(format!("vector {index}, described as {function}, does not exist"));
    }
    Ok((found, word(0)))
}

/// Bytes of statics, and bytes below the initial stack pointer.
fn memory(
    image: &Image,
    description: &Description,
    top: u32,
    problems: &mut BTreeSet<String>,
) -> (u32, u32) {
    let ram = description.ram.start..description.ram.start + description.ram.bytes;
    let mut statics = 0;
    for section in image.sections().iter().filter(|section| ram.contains(&section.address)) {
        statics += section.size;
        if section.address < top && section.size > 0 {
            problems.insert(format!(
                "{} is below the stack: an overflow would overwrite it",
                section.name
            ));
        }
    }
    if !(ram.start..=ram.end).contains(&top) {
        problems.insert(format!("the stack begins at {top:#010x}, outside RAM"));
    }
    (statics, top.saturating_sub(ram.start))
}
