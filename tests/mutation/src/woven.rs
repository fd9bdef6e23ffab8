//! Which mutant is on: `VM_MUTANT` is its number, or `trace` for none; `VM_MUTANT_LOG` is a file
//! to which the numbers of those that are reached are appended, each once.

extern crate std;

use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::io::Write;

const MOST: usize = 8192;
/// What is chosen besides a mutant: not read yet, none, and none but all that are reached are told.
const UNKNOWN: usize = usize::MAX;
const NONE: usize = MOST;
const TRACE: usize = MOST + 1;

static CHOSEN: AtomicUsize = AtomicUsize::new(UNKNOWN);
static SEEN: [AtomicBool; MOST] = [const { AtomicBool::new(false) }; MOST];

/// Whether a mutant is on.
#[inline]
pub fn on(mutant: usize) -> bool {
    match CHOSEN.load(Relaxed) {
        NONE => false,
        TRACE => {
            if !SEEN[mutant].load(Relaxed) {
                seen(mutant);
            }
            false
        }
        UNKNOWN => first(mutant),
        one => one == mutant && reached(mutant),
    }
}

/// Reads which one is chosen.
#[cold]
fn first(mutant: usize) -> bool {
    let chosen = match std::env::var("VM_MUTANT") {
        Err(_) => NONE,
        Ok(word) if word == "trace" => TRACE,
        Ok(word) => word.parse().expect("the number of a mutant"),
    };
    CHOSEN.store(chosen, Relaxed);
    on(mutant)
}

#[inline]
fn reached(mutant: usize) -> bool {
    if !SEEN[mutant].load(Relaxed) {
        seen(mutant);
    }
    true
}

#[cold]
fn seen(mutant: usize) {
    if !SEEN[mutant].swap(true, Relaxed) {
        let log = std::env::var("VM_MUTANT_LOG").expect("VM_MUTANT_LOG");
        let mut log = std::fs::OpenOptions::new().append(true).create(true).open(log).expect("log");
        log.write_all(std::format!("{mutant}\n").as_bytes()).expect("log");
    }
}
