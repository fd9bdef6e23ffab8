//! On the target: the emulated STM32F405 leaves the same bits as the host, tick by tick.
//!
//! Where the thumb target or QEMU cannot be had, these tests say SKIPPED; with
//! `VM_REQUIRE_TARGET` set, as in CI, a skip is a failure.

use firmware::{Frame, Record, Rig, Scenario, TICKS};
use host_sim::target::{self, TargetError};
use object::{Object, ObjectSymbol};
use std::io::Read;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};
use system_tests::{build, skip};

/// The scenario lasts 12 s on the target; a busy machine may take longer.
const PATIENCE: Duration = Duration::from_secs(240);

/// Runs a program on the emulated chip and returns what it wrote.
fn emulate(program: &Path) -> Result<Vec<u8>, TargetError> {
    let mut child = target::emulator(target::MACHINE, program)
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
        if started.elapsed() > PATIENCE {
            let _gone = child.kill();
            panic!("the emulated target did not finish in {PATIENCE:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let bytes = reader.join().expect("the reader ends").expect("the output is read");
    assert!(status.success(), "the target ended with {status} after {} bytes", bytes.len());
    Ok(bytes)
}

/// Keeps frames as the target writes them.
struct Bytes(Vec<u8>);

impl Record for Bytes {
    fn record(&mut self, frame: &Frame) {
        self.0.extend(frame.iter().flat_map(|word| word.to_le_bytes()));
    }
}

fn on_host() -> Vec<u8> {
    let mut rig = Rig::at_rest(Scenario::RESTING_PATH).expect("the rig's muscle is valid");
    let mut bytes = Bytes(Vec::new());
    for _ in 0..TICKS {
        rig.tick(&mut Scenario, &mut bytes);
    }
    bytes.0
}

#[test]
fn the_target_leaves_the_same_bits_as_the_host_in_every_tick() {
    const { assert!(TICKS >= 10_000) };
    let on_target = match build("firmware").and_then(|program| emulate(&program)) {
        Ok(bytes) => bytes,
        Err(reason) => return skip(&reason.to_string()),
    };
    let on_host = on_host();
    assert_eq!(on_target.len(), on_host.len(), "bytes of {TICKS} ticks");
    let size = size_of::<Frame>();
    for (tick, (target, host)) in on_target.chunks(size).zip(on_host.chunks(size)).enumerate() {
        assert_eq!(target, host, "tick {tick}");
    }
    eprintln!("{TICKS} ticks of both modes: {} identical bytes", on_target.len());
}

#[test]
fn the_scenario_visits_what_a_muscle_can_meet() {
    let size = size_of::<Frame>();
    let on_host = on_host();
    let word = |frame: &[u8], index: usize| {
        u32::from_le_bytes(frame[4 * index..4 * index + 4].try_into().expect("four bytes"))
    };
    // Of each muscle: the largest force, the smallest, and all flags.
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
    let program = match build("step") {
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
