//! The stimulator's stack: computed against measured in QEMU, and the effect of an overflow.
//!
//! Without the thumb target or QEMU these tests print SKIPPED.

use firmware::link::{Electrode, MOST_ROWS, Request, RowInputs, Upload};
use firmware::safety::{Fault, State};
use host_sim::stack::{self, Description, Priority};
use host_sim::{readme, target};
use object::{Object, ObjectSection};
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};
use stimulator_tests::host::{READINGS, fes};
use stimulator_tests::joint;
use system_tests::debugger::{Debugger, Port};
use system_tests::machine::{Machine, Said, drive, image, kept_alive, symbol};
use vm_nostd::RecruitmentCurveParams;

fn description() -> Description {
    let path = target::root().join("firmware/stack.toml");
    toml::from_str(&std::fs::read_to_string(path).expect("a file")).expect("a description")
}

#[test]
fn all_depths_are_known_a_quarter_is_free_and_the_readme_is_current() {
    let Some(image) = image() else { return };
    let report = stack::report(&image, &description()).expect("a report");
    assert_eq!(report.problems, Vec::<String>::new());
    let current = readme::STACK.is_current(&readme::stack(&report)).expect("a README");
    assert!(current, "firmware/README.md has drifted: cargo vm stack --write");
}

/// A change of a description and the expected problem.
type Case = (fn(&mut Description), &'static str);

#[test]
fn errors_in_the_description_are_reported() {
    let Some(image) = image() else { return };
    let problem = |change: fn(&mut Description)| {
        let mut description = description();
        change(&mut description);
        stack::report(&image, &description).expect("a report").problems.join("\n")
    };
    let cases: [Case; 8] = [
        (
            |it| it.handlers.retain(|handler| handler.function != "TIM2"),
            "vector 44 is TIM2, described as DefaultHandler",
        ),
        (|it| it.handlers[0].vector = 54, "vector 54 is DefaultHandler, described as USART1"),
        (|it| it.handlers[0].vector = 900, "vector 900, described as USART1, does not exist"),
        (|it| it.indirect.clear(), "indirect call"),
        (
            |it| it.indirect.extend(it.indirect.first().cloned().map(stale)),
            "stale: no indirect call in HardFault",
        ),
        (|it| it.ram.least_free_percent = 90, "less than 90 %"),
        (|it| it.ram.guard_bytes = 1000, "it may skip"),
        // A task's handler uses the stack, a fault handler must not.
        (
            |it| {
                let ends = it.handlers.last().expect("a handler").priority;
                it.handlers[0].priority = ends;
            },
            "USART1: it needs",
        ),
    ];
    for (change, expected) in cases {
        let problems = problem(change);
        assert!(problems.contains(expected), "{expected}: {problems}");
    }
}

fn stale(indirect: stack::Indirect) -> stack::Indirect {
    stack::Indirect { function: "HardFault".to_owned(), ..indirect }
}

/// Memory of the stack and of the statics.
fn layout(image: &Path) -> (Range<u32>, Range<u32>) {
    let bytes = std::fs::read(image).expect("an image");
    let file = object::File::parse(&*bytes).expect("an ELF file");
    let vectors = file.section_by_name(".vector_table").expect("vectors").data().expect("vectors");
    let top = u32::from_le_bytes(vectors[..4].try_into().expect("a word"));
    let ram = description().ram;
    let end = ram.start + ram.bytes;
    // With the default layout the stack is at the top of RAM.
    if top == end {
        (end - 0x8000..end, ram.start..end - 0x8000)
    } else {
        (ram.start..top, top..end)
    }
}

/// Upload of a muscle with an electrode.
fn upload(channel: u8) -> Upload {
    let curve = RecruitmentCurveParams {
        threshold: 4e-3,
        saturation: 12e-3,
        chronaxie: 200e-6,
        slope: 2.0,
    };
    let electrode = Electrode { channel, curve, width_us: 200, gap_us: 50, recovery: 1 };
    Upload { electrode: Some(electrode), ..fes() }
}

/// All kinds of requests of a host.
fn traffic() -> Vec<Request> {
    let row = RowInputs { activation: 0.5, path_length: 0.16, stimulation_frequency: 25.0 };
    let rows = || (0..MOST_ROWS).map(|_| [row; 2]).collect();
    let mut refused = upload(3);
    refused.muscle.mass = -1.0;
    let mut requests = vec![
        Request::Upload { place: 0, upload: upload(0) },
        Request::Upload { place: 1, upload: upload(1) },
        Request::Rest([Some(0.16), None]),
        Request::Readings(READINGS),
        Request::Acknowledge(Fault::Boot),
        Request::Arm,
        Request::Rows { first: 0, rows: rows() },
        Request::Rows { first: MOST_ROWS as u32, rows: rows() },
    ];
    requests.extend(kept_alive());
    requests.extend([
        Request::State { place: 0 },
        Request::Report,
        Request::Stop,
        Request::Upload { place: 0, upload: refused },
        // Refused: electrodes have these channels.
        drive(),
    ]);
    // Building a controller goes deepest.
    let [flexor, extensor] = joint::muscles();
    requests.extend([
        // First the one whose channels are free.
        Request::Upload { place: 1, upload: extensor },
        Request::Upload { place: 0, upload: flexor },
        Request::Control(Some(joint::control())),
    ]);
    requests
}

/// Watermark of unused stack.
const PAINT: u8 = 0xA5;

/// Greatest ratio of computed to measured depth. The computed one nests the deepest paths of all
/// priorities; the ratio was 1.09 when this was written.
const MOST_RATIO: f64 = 1.5;

#[test]
fn the_computed_stack_bounds_the_measured_stack() {
    let Some(image) = image() else { return };
    let description = description();
    let computed = stack::report(&image, &description).expect("a report").stack;
    let (room, _) = layout(&image);
    let length = room.len();

    let port = Port::free();
    let mut arguments = port.arguments();
    arguments.push("-S".to_owned());
    // The machine is halted until the stack is painted; the greeting waits.
    let painted = std::thread::scope(|scope| {
        let painter = scope.spawn(|| {
            let mut debugger = port.wait_and_attach();
            for part in (0..length).step_by(256) {
                debugger.write(u64::from(room.start) + part as u64, &[PAINT; 256]);
            }
            debugger.resume();
            debugger
        });
        let machine = Machine::start(&image, arguments);
        (machine, painter.join().expect("a debugger"))
    });
    let (mut machine, mut debugger) = painted;
    let said = machine.script(&traffic());
    let [first, last] = [&said[..8], &said[said.len() - 3..]];
    assert!(first.iter().chain(last).all(|one| *one == Said::Done), "{said:?}");
    debugger.stop();
    let memory = debugger.read(room.start.into(), length);
    let untouched = memory.iter().take_while(|&&byte| byte == PAINT).count();
    let measured = u32::try_from(length - untouched).expect("a depth");
    println!("computed {computed} B, measured {measured} B");
    assert!(measured <= computed, "{measured} B were taken, {computed} computed");
    let ratio = f64::from(computed) / f64::from(measured);
    assert!(ratio <= MOST_RATIO, "{computed} B computed, {measured} measured: {ratio:.2}");

    // The described priorities equal those in the core's registers, of 4 bits each.
    for handler in &description.handlers {
        let Priority::Level(level) = handler.priority else { continue };
        let register = match handler.vector {
            system @ 4..16 => 0xE000_ED18 + system - 4,
            interrupt => 0xE000_E400 + interrupt - 16,
        };
        let told = debugger.read(register.into(), 1);
        assert_eq!(told, [(16 - level) << 4], "{}", handler.function);
    }
}

/// Whether a word is an EXC_RETURN value.
fn is_exc_return(word: &[u8]) -> bool {
    matches!(word, [0xE1 | 0xE9 | 0xF1 | 0xF9, 0xFF, 0xFF, 0xFF])
}

fn count_exc_returns(debugger: &mut Debugger, range: &Range<u32>) -> usize {
    let memory = debugger.read(range.start.into(), range.len());
    memory.chunks_exact(4).filter(|word| is_exc_return(word)).count()
}

/// The tick overflows the stack during pulses: the first word outside RAM faults the core, statics
/// are unchanged, and the chip restarts in neutral.
#[test]
fn a_stack_overflow_corrupts_nothing_and_ends_in_neutral() {
    let Some(image) = image() else { return };
    let (stack, statics) = layout(&image);
    let port = Port::free();
    let mut machine = Machine::start(&image, port.arguments());
    let mut requests =
        vec![Request::Readings(READINGS), Request::Acknowledge(Fault::Boot), Request::Arm, drive()];
    requests.extend(kept_alive());
    // Armed, and the host still heard, when the debugger stops it.
    let said = machine.converse(&requests, 50);
    assert!(said.iter().all(|one| *one == Said::Done), "{said:?}");

    let mut debugger = port.attach();
    assert!(machine.pins().closed > 20);
    let before = count_exc_returns(&mut debugger, &statics);
    let function = |name| symbol(&image, name).0 & !1;
    let (tick, fault) = (function("SysTick"), function("HardFault"));
    let kept = (debugger.read(tick, 4), debugger.read(fault, 2));
    // push {r0-r7, lr} in a loop; the fault handler loops, too.
    debugger.write(tick, &[0xFF, 0xB5, 0xFD, 0xE7]);
    debugger.write(fault, &[0xFE, 0xE7]);
    debugger.resume();
    let started = Instant::now();
    loop {
        std::thread::sleep(Duration::from_millis(100));
        debugger.stop();
        let bottom = stack.start..stack.start + 0x100;
        if count_exc_returns(&mut debugger, &bottom) > 0 {
            break;
        }
        assert!(started.elapsed() < Duration::from_secs(60), "no overflow");
        debugger.resume();
    }
    let after = count_exc_returns(&mut debugger, &statics);
    assert_eq!(after, before, "the stack was written over the statics");

    // Restores the handlers; the stack pointer stays invalid.
    debugger.write(tick, &kept.0);
    debugger.write(fault, &kept.1);
    let closed = machine.pins().closed;
    debugger.resume();
    let mut machine = machine.greeted_again();
    assert_eq!(machine.report().state, State::Latched(Fault::Boot));
    let pins = machine.pins();
    assert_eq!((pins.bridge, pins.channels, pins.closed), (0, 0, closed));
}
