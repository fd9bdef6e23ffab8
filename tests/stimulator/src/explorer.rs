//! Every order in which higher levels interrupt lower ones: a run is repeated with each sequence of
//! choices, the deepest changed first, until there is none left.

use std::cell::RefCell;

/// The choices of a run, and how many there were to choose from.
#[derive(Debug, Default)]
struct Trail {
    choices: Vec<(u8, u8)>,
    next: usize,
}

thread_local! {
    static TRAIL: RefCell<Trail> = RefCell::default();
}

/// A choice among `options`, another one in each run.
pub fn choose(options: u8) -> u8 {
    TRAIL.with_borrow_mut(|trail| {
        if trail.next == trail.choices.len() {
            trail.choices.push((0, options));
        }
        let (choice, before) = trail.choices[trail.next];
        assert_eq!(before, options, "the same choices lead to the same run");
        trail.next += 1;
        choice
    })
}

/// Goes back to the last choice that has another option. False if none has.
fn turn_back() -> bool {
    TRAIL.with_borrow_mut(|trail| {
        // Choices that the run did not come to.
        trail.choices.truncate(trail.next);
        trail.next = 0;
        while let Some((choice, options)) = trail.choices.last_mut() {
            *choice += 1;
            if choice < options {
                return true;
            }
            trail.choices.pop();
        }
        false
    })
}

/// Repeats a run until it has made every sequence of choices, and returns how many there are. What
/// goes wrong is told with the choices that led to it.
pub fn explore(mut run: impl FnMut() -> Result<(), String>) -> Result<u64, String> {
    TRAIL.set(Trail::default());
    let mut runs = 0;
    loop {
        runs += 1;
        if let Err(problem) = run() {
            let choices: Vec<u8> =
                TRAIL.with_borrow(|trail| trail.choices.iter().map(|choice| choice.0).collect());
            return Err(format!("{problem}, in run {runs}, after choices {choices:?}"));
        }
        if !turn_back() {
            return Ok(runs);
        }
    }
}
