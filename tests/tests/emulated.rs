//! The stimulator as it would be flashed, in QEMU: the host's bits over its USART, and the main
//! faults.
//!
//! Requests of a fault's script wait in the line before the firmware looks for them: time is its
//! own, and does not depend on how fast this host is.

use firmware::link::{Readings, Report, Request};
use firmware::safety::{CHANNELS, Fault, NotArmed, State};
use firmware::{Stimulus, TICK_US};
use host_sim::engine::Class;
use host_sim::hil::{self, Client, Emulated};
use host_sim::{muscle_file, reference, trace};
use std::path::{Path, PathBuf};
use stimulator_tests::host::{READINGS, fes};
use system_tests::debugger::Port;
use system_tests::machine::{Machine, Pins, Said, drive, image, kept_alive, stimulus, symbol};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/data").join(name)
}

#[test]
fn traces_played_to_the_firmware_have_the_bits_of_the_hosts_run() {
    let Some(image) = image() else { return };
    let muscle =
        muscle_file::read(&data("muscles/deltoid_posterior.toml")).expect("a muscle").muscle;
    for (vector, mode) in [
        ("fes_steps", reference::Mode::Fes),
        ("continuous_activation_3hz", reference::Mode::Continuous),
    ] {
        let trace = trace::read_inputs(&data(&format!("vectors/{vector}.csv"))).expect("inputs");
        let mut client = Client::new(Emulated::run(&image, &[]).expect("a machine"));
        let played = hil::play(&mut client, &muscle, Class::Standard, mode, &trace, &mut |_| ())
            .expect("equal bits");
        assert_eq!(played.rows.len(), trace.inputs.len());
        let Report { longest_us, late, frames, .. } = played.report;
        assert_eq!((late, frames.broken, frames.refused), (0, 0, 0));
        // By instructions of 8 ns each.
        assert!((10..=80).contains(&longest_us), "{longest_us} us");
    }
}

/// A fault, what is sent to inject it, and whether its cause goes away with good readings.
fn cases() -> Vec<(Fault, Request)> {
    let readings = |readings| Request::Readings(readings);
    let wanted = |stimulus| Request::Drive([Some(stimulus), None, None, None]);
    vec![
        (Fault::Amplitude, wanted(stimulus(100_001))),
        (Fault::Width, wanted(Stimulus { width_us: 501, ..stimulus(1000) })),
        (Fault::Frequency, wanted(Stimulus { frequency_tenths_pps: 1001, ..stimulus(1000) })),
        (Fault::Request, wanted(Stimulus { recovery: 9, ..stimulus(1000) })),
        (Fault::Supply, readings(Readings { supply_mv: 2999, ..READINGS })),
        (
            Fault::ElectrodeOpen,
            readings(Readings { impedance_ohm: [Some(5001), None, None, None], ..READINGS }),
        ),
        (
            Fault::ElectrodeShort,
            readings(Readings { impedance_ohm: [None, None, Some(99), None], ..READINGS }),
        ),
        (Fault::SensorMissing, readings(Readings { path_um: None, ..READINGS })),
        // 0.29 m, for which a path takes longer than a reading may be old.
        (Fault::SensorJump, readings(Readings { path_um: Some(450_000), ..READINGS })),
        (Fault::Stopped, Request::Stop),
    ]
}

#[test]
fn the_main_faults_end_in_neutral_on_the_emulated_chip() {
    let Some(image) = image() else { return };
    let mut machine = Machine::start(&image, Vec::new());
    // Off at boot, whatever is asked for.
    let said =
        machine.script(&[Request::Readings(READINGS), drive(), Request::Arm, Request::Report]);
    assert_eq!(said[2], Said::NotArmed(NotArmed::NotAcknowledged));
    assert!(matches!(said[3], Said::Report(Report { state: State::Latched(Fault::Boot), .. })));
    assert_eq!(machine.pins(), Pins::default());

    let (mut latched, mut pins) = (Fault::Boot, Pins::default());
    for (fault, injection) in cases() {
        let then = [injection, Request::Report, Request::Arm];
        let (before, said) = machine.stimulated(latched, &then);
        let Said::Report(after) = said[1] else { panic!("{said:?}") };
        assert_eq!(after.state, State::Latched(fault), "{after:?}");
        assert_eq!(said[2], Said::NotArmed(NotArmed::NotAcknowledged));
        // In the report that follows it. How many ticks that takes depends on how fast this host
        // sends it.
        assert!(after.ticks > before.ticks);
        assert_eq!((after.late, after.frames.broken), (0, 0), "{fault:?}: {after:?}");
        // There were pulses; now there is no way for a current, and none is opened again.
        let closed = pins.closed;
        pins = machine.pins();
        assert!(pins.closed > closed + 10, "{fault:?}: {pins:?}");
        assert_eq!(pins.bridge, 0, "{fault:?}");
        machine.script(&kept_alive());
        // A channel whose pulse was cut short was left to discharge for a while.
        let later = machine.pins();
        assert_eq!((later.closed, later.channels), (pins.closed, 0), "{fault:?}: pulses after it");
        latched = fault;
    }

    // A host that says nothing.
    machine.stimulated(latched, &[]);
    let pins = machine.pins_at_last();
    assert_eq!((pins.bridge, pins.channels), (0, 0));
    assert_eq!(machine.report().state, State::Latched(Fault::Silence));
}

/// One bit of a muscle's state in RAM: a fault, not a force.
#[test]
fn a_bit_that_flips_in_memory_is_a_fault_on_the_emulated_chip() {
    let Some(image) = image() else { return };
    let port = Port::free();
    let mut machine = Machine::start(&image, port.arguments());
    let rest = Request::Rest([Some(0.16), None]);
    let said = machine.script(&[
        Request::Upload { place: 0, upload: fes() },
        rest.clone(),
        Request::State { place: 0 },
    ]);
    let Said::Words(words) = &said[2] else { panic!("{said:?}") };

    let (address, size) = symbol(&image, "local_init_banks");
    let mut debugger = port.attach();
    let memory = debugger.read(address, size);
    // Tendon extension, velocity and path lie one behind the other, in the bank of the tick and
    // maybe in the other.
    let pattern: Vec<u8> = words[..3].iter().flat_map(|word| word.to_le_bytes()).collect();
    let found: Vec<usize> = (0..memory.len() - pattern.len())
        .filter(|&at| memory[at..].starts_with(&pattern))
        .collect();
    // The link overwrites its own bank before anybody reads it.
    assert!((1..=2).contains(&found.len()), "the state in {size} bytes: {found:?}");
    for at in found {
        debugger.write(address + at as u64, &[memory[at] ^ 0x01]);
    }
    debugger.go_on();

    let said = machine.script(&[
        Request::Readings(READINGS),
        Request::Report,
        Request::Acknowledge(Fault::Boot),
        Request::KeepAlive,
        Request::Arm,
        Request::Acknowledge(Fault::Checksum),
        Request::Arm,
    ]);
    let Said::Report(report) = said[1] else { panic!("{said:?}") };
    assert_eq!(report.wrong, Some(Fault::Checksum));
    // Another fault than the one that was named, and it lasts: no current by way of that muscle.
    assert!(matches!(said[4], Said::NotArmed(_)), "{said:?}");
    assert_eq!(said[6], Said::NotArmed(NotArmed::StillThere(Fault::Checksum)));
    assert_eq!(machine.pins(), Pins::default());
    // A muscle at rest again, with checksums of its own, ends it.
    machine.script(&[rest]);
    let (report, _) = machine.stimulated(Fault::Checksum, &[]);
    assert_eq!(report.wrong, None);
    assert!(machine.pins().closed > 10);
}

/// How often the bridge was closed when a debugger stops a busy machine, and once it has gone on,
/// with an instruction in place of the tick's first one if there is to be one; both while a host is
/// still heard.
fn closed_around(image: &Path, instruction: Option<u16>) -> (u32, u32) {
    let port = Port::free();
    let mut machine = Machine::start(image, port.arguments());
    let mut requests =
        vec![Request::Readings(READINGS), Request::Acknowledge(Fault::Boot), Request::Arm, drive()];
    requests.extend(kept_alive());
    let said = machine.converse(&requests, 50);
    assert!(said.iter().all(|one| *one == Said::Done), "{said:?}");
    let mut debugger = port.attach();
    if let Some(instruction) = instruction {
        let (address, _) = symbol(image, "SysTick");
        // Addresses of functions are odd.
        debugger.write(address & !1, &instruction.to_le_bytes());
    }
    let before = machine.pins().closed;
    debugger.go_on();
    let pins = machine.pins_at_last();
    assert_eq!((pins.bridge, pins.channels), (0, 0));
    (before, pins.closed)
}

/// How often the bridge can be closed, at most, in so many ticks, less than the time between two
/// pulses of a channel: twice for a pulse, and each channel's comes behind another's.
fn closed_in(ticks: u32) -> u32 {
    let one_after_another = (ticks * TICK_US).div_ceil(stimulus(10_000).duration_us());
    2 * one_after_another.min(CHANNELS as u32)
}

/// A branch to itself where the tick begins: the pulse timer stops without it.
#[test]
fn a_tick_that_never_ends_leaves_no_current_on_the_emulated_chip() {
    let Some(image) = image() else { return };
    // Without the hang, pulses go on for as long as the host is heard, and a tenth of a second
    // more.
    let (before, after) = closed_around(&image, None);
    assert!(before > 20 && after > before + 40, "{before}, {after}");
    // With it, there is a tick that had begun, and two ticks' patience.
    let (before, after) = closed_around(&image, Some(0xe7fe));
    assert!(before > 20 && after <= before + closed_in(3), "{before}, {after}");
}

/// An instruction that is none where the tick begins: the core's fault handler starts the chip
/// again, and everything is off at boot.
#[test]
fn a_fault_of_the_core_leaves_no_current_on_the_emulated_chip() {
    let Some(image) = image() else { return };
    let (before, after) = closed_around(&image, Some(0xde00));
    // Pulses go on until the next tick begins.
    assert!(before > 20 && after <= before + closed_in(1), "{before}, {after}");
}
