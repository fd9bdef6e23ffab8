//! The emulated target computes the same bits as the host in every tick.
//!
//! Without the thumb target or QEMU these tests print SKIPPED; with `VM_REQUIRE_TARGET` set, as in
//! CI, they fail.

use host_sim::target::{self, Board, CORTEX_M0, CORTEX_M3, STM32F405, TargetError};
use object::{Object, ObjectSymbol};
use std::io::Read;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};
use system_tests::{build, skip};
use vm_nostd::Fixed;
use vm_nostd_cores::{Arithmetic, Record, Rig, Scenario, TICKS, frame_words};

/// Timeout: the scenario takes 12 s in QEMU, longer on a busy host.
const TIMEOUT: Duration = Duration::from_secs(240);

/// Runs a program on the emulated chip and returns what it wrote.
fn emulate(board: Board, program: &Path) -> Result<Vec<u8>, TargetError> {
    let mut child = target::emulator(board.machine, program)
        .stdout(Stdio::piped())
        .spawn()
        .map_err(target::start_error(target::QEMU))?;
    let mut outlet = child.stdout.take().expect("a piped output");
    let reader = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        outlet.read_to_end(&mut bytes).map(|_| bytes)
    });
    let started = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("a child to wait for") {
            break status;
        }
        if started.elapsed() > TIMEOUT {
            let _gone = child.kill();
            panic!("the emulated target did not finish in {TIMEOUT:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let bytes = reader.join().expect("the reader ends").expect("the output is read");
    assert!(status.success(), "the target ended with {status} after {} bytes", bytes.len());
    Ok(bytes)
}

/// Collects the target's frames.
struct Bytes(Vec<u8>);

impl Record for Bytes {
    fn record(&mut self, words: impl Iterator<Item = u32>) {
        self.0.extend(words.flat_map(u32::to_le_bytes));
    }
}

fn on_host<S: Arithmetic>() -> Vec<u8> {
    let mut rig = Rig::<S>::at_rest(Scenario::RESTING_PATH).expect("the rig's muscle is valid");
    let mut bytes = Bytes(Vec::new());
    for _ in 0..TICKS {
        rig.tick(&mut Scenario, &mut bytes);
    }
    bytes.0
}

/// First tick whose bits differ, if any.
fn compare<S: Arithmetic>(on_target: &[u8]) {
    const { assert!(TICKS >= 10_000) };
    let on_host = on_host::<S>();
    assert_eq!(on_target.len(), on_host.len(), "bytes of {TICKS} ticks");
    let size = 4 * frame_words::<S>();
    for (tick, (target, host)) in on_target.chunks(size).zip(on_host.chunks(size)).enumerate() {
        assert_eq!(target, host, "tick {tick}");
    }
}

/// Compares both arithmetics and modes on a core.
fn golden_on(board: Board) {
    match build(board, "golden").and_then(|program| emulate(board, &program)) {
        Ok(bytes) => {
            let fixed = TICKS as usize * 4 * frame_words::<Fixed>();
            compare::<Fixed>(&bytes[..fixed]);
            compare::<f32>(&bytes[fixed..]);
        }
        Err(reason) => skip(&reason.to_string()),
    }
}

#[test]
fn a_cortex_m4f_has_the_hosts_bits_in_both_arithmetics() {
    golden_on(STM32F405);
}

#[test]
fn a_cortex_m3_has_the_hosts_bits_in_both_arithmetics() {
    golden_on(CORTEX_M3);
}

#[test]
fn a_cortex_m0_has_the_hosts_bits_in_both_arithmetics() {
    golden_on(CORTEX_M0);
}

#[test]
fn the_scenario_covers_all_flags_and_the_range_of_force() {
    let size = 4 * frame_words::<f32>();
    let on_host = on_host::<f32>();
    let word = |frame: &[u8], index: usize| {
        u32::from_le_bytes(frame[4 * index..4 * index + 4].try_into().expect("four bytes"))
    };
    // Largest and smallest force and all flags of each muscle.
    for muscle in 0..2 {
        let at = size / 8 * muscle + size / 8 - 4;
        let forces = on_host.chunks(size).map(|frame| f32::from_bits(word(frame, at)));
        let (least, most) = forces.fold((f32::MAX, 0.0_f32), |(l, m), f| (l.min(f), m.max(f)));
        assert!(least < 0.1 && most > 100.0, "muscle {muscle}: {least} to {most} N");
        let flags = on_host.chunks(size).fold(0, |all, frame| all | word(frame, at + 3));
        assert!(flags.count_ones() >= 3, "muscle {muscle}: flags {flags:b}");
    }
}

#[test]
fn no_panic_is_reachable_from_a_program_that_only_steps() {
    let program = match build(STM32F405, "step") {
        Ok(program) => program,
        Err(reason) => return skip(&reason.to_string()),
    };
    let image = std::fs::read(program).expect("the built image");
    let file = object::File::parse(&*image).expect("an ELF file");
    let names: Vec<&str> = file.symbols().filter_map(|symbol| symbol.name().ok()).collect();
    assert!(names.iter().any(|name| name.contains("vm_nostd")), "an image with symbols");
    let panics: Vec<&&str> = names.iter().filter(|name| name.contains("panic")).collect();
    assert!(panics.is_empty(), "{panics:?}");
}
