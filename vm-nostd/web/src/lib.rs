//! The muscles of the page, for JavaScript: numbers in, numbers out.
//!
//! A function per question, `f64` and `u32` only: no memory is shared with JavaScript, and nothing
//! is generated. Quantities are in the units of a muscle file, so that a muscle copied from the
//! page is the muscle of the page, to the last bit.

mod muscle;
mod running;

use muscle::Definition;
use running::Running;
use std::cell::RefCell;

/// Muscles that run side by side.
const SLOTS: usize = 10;

/// A muscle as it is defined, and as it runs.
struct Slot {
    definition: Definition,
    running: Box<dyn Running>,
}

struct Page {
    slots: [Option<Slot>; SLOTS],
    /// Why the last muscle was refused.
    message: String,
}

thread_local! {
    static PAGE: RefCell<Page> =
        const { RefCell::new(Page { slots: [const { None }; SLOTS], message: String::new() }) };
}

/// An answer about the muscle of a slot; not a number if there is none.
fn of_slot(slot: u32, answer: impl FnOnce(&mut Slot) -> f64) -> f64 {
    PAGE.with_borrow_mut(|page| match page.slots.get_mut(slot as usize) {
        Some(Some(slot)) => answer(slot),
        _ => f64::NAN,
    })
}

/// Keeps the message of an error; 1 if there was none, 0 if there was.
fn told(page: &mut Page, result: Result<(), String>) -> u32 {
    page.message = result.as_ref().err().cloned().unwrap_or_default();
    u32::from(result.is_ok())
}

/// Defines the muscle of a slot and puts it to rest on a path (m); 0 if it is refused, with a
/// [`message_byte`]. The numbers of `set`, `arithmetic`, `mode` and `class` are those of the page's
/// lists; `size` is F0 in N if `size_is_force` is 1, else the mass in g. `units` is the number of
/// motor units of each type, in the discrete modes.
#[allow(clippy::too_many_arguments, reason = "JavaScript passes numbers only")]
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn define(
    slot: u32,
    set: u32,
    arithmetic: u32,
    mode: u32,
    class: u32,
    size_is_force: u32,
    size: f64,
    fascicle_cm: f64,
    tendon_cm: f64,
    max_path_cm: f64,
    saturation: f64,
    slow_fraction: f64,
    units: u32,
    path_m: f64,
) -> u32 {
    let definition = Definition {
        set,
        class,
        size_is_force: size_is_force == 1,
        size,
        fascicle_cm,
        tendon_cm,
        max_path_cm,
        saturation,
        slow_fraction,
        units: units as usize,
    };
    PAGE.with_borrow_mut(|page| {
        let result = running::at_rest(&definition, arithmetic, mode, path_m);
        let result = match (result, page.slots.get_mut(slot as usize)) {
            (Ok(running), Some(place)) => {
                *place = Some(Slot { definition, running });
                Ok(())
            }
            (Ok(_), None) => Err(format!("slot = {slot}: must be between 0 and {}", SLOTS - 1)),
            (Err(refusal), _) => Err(refusal),
        };
        told(page, result)
    })
}

/// Byte `index` of the message of the last refusal, in UTF-8; 0 at its end.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn message_byte(index: u32) -> u32 {
    PAGE.with_borrow(|page| {
        page.message.as_bytes().get(index as usize).map_or(0, |byte| u32::from(*byte))
    })
}

/// Removes the muscle of a slot.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn remove(slot: u32) {
    PAGE.with_borrow_mut(|page| {
        if let Some(place) = page.slots.get_mut(slot as usize) {
            *place = None;
        }
    });
}

/// Steps the muscle of a slot by 1 ms: activation, path length (m) and stimulation frequency (pps)
/// as in a row of `vm run`. The bits of [`status_name`], and -1 if the slot is empty.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn step(slot: u32, activation: f64, path_m: f64, frequency: f64) -> i32 {
    let status = of_slot(slot, |slot| slot.running.step(activation, path_m, frequency).into());
    if status.is_nan() { -1 } else { status as i32 }
}

/// What the muscle of a slot puts out: 0 is the tendon's force (N), 1 the fascicles' length
/// (L_ce0), 2 their velocity (L_ce0/s), 3 and on the activation of each type, as a share of F0:
/// recruitment times Af times FL.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn output(slot: u32, which: u32) -> f64 {
    of_slot(slot, |slot| slot.running.output(which as usize))
}

/// A quantity of the muscle of a slot, in SI units: 0 mass (kg), 1 L_ce0 (m), 2 L_se0 (m),
/// 3 L_mt_max (m), 4 F0 (N), 5 and 6 the shortest and the longest path (m); 7 and 8 the shortest
/// and the longest fascicles that are valid (L_ce0), 9 the least V_max (L_ce0/s).
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn quantity(slot: u32, which: u32) -> f64 {
    of_slot(slot, |slot| slot.definition.quantity(which))
}

/// Byte `index` of the name of bit `bit` of a status; 0 at its end.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn status_name_byte(bit: u32, index: u32) -> u32 {
    running::status_name(bit).as_bytes().get(index as usize).map_or(0, |byte| u32::from(*byte))
}

/// A curve of the muscle of a slot, fully activated, in F0: 0 is the isometric force at a length
/// `x` (L_ce0), 1 the passive force there, 2 the force at L_ce0 and a velocity `x` (L_ce0/s).
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn curve(slot: u32, curve: u32, x: f64) -> f64 {
    of_slot(slot, |slot| slot.running.curve(curve, x))
}
