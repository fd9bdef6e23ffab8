//! Which mutant is on: `VM_MUTANT` is its number, or `trace` for none; `VM_MUTANT_LOG` is a file
//! to which the numbers of those that are reached are appended, each once.

extern crate std;

use core::sync::atomic::{AtomicBool, Ordering};
use std::io::Write;
use std::sync::LazyLock;

#[derive(PartialEq)]
enum Chosen {
    None,
    Trace,
    One(usize),
}

static CHOSEN: LazyLock<Chosen> = LazyLock::new(|| match std::env::var("VM_MUTANT") {
    Err(_) => Chosen::None,
    Ok(word) if word == "trace" => Chosen::Trace,
    Ok(word) => Chosen::One(word.parse().expect("the number of a mutant")),
});

static SEEN: [AtomicBool; 8192] = [const { AtomicBool::new(false) }; 8192];

/// Whether a mutant is on.
#[inline]
pub fn on(mutant: usize) -> bool {
    match &*CHOSEN {
        Chosen::One(one) if *one == mutant => {
            seen(mutant);
            true
        }
        Chosen::Trace => {
            seen(mutant);
            false
        }
        _ => false,
    }
}

fn seen(mutant: usize) {
    if !SEEN[mutant].swap(true, Ordering::Relaxed) {
        let log = std::env::var("VM_MUTANT_LOG").expect("VM_MUTANT_LOG");
        let mut log = std::fs::OpenOptions::new().append(true).create(true).open(log).expect("log");
        log.write_all(std::format!("{mutant}\n").as_bytes()).expect("log");
    }
}
