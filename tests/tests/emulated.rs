//! The stimulator's image in QEMU: the host's bits over its USART, and the main faults.
//!
//! All requests of a script are queued on the line before the firmware reads them, so that the
//! firmware's timing does not depend on the speed of the host.

use firmware::link::{Answer, Readings, Report, Request};
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
fn traces_played_to_the_firmware_have_the_hosts_bits() {
    let Some(image) = image() else { return };
    let muscle =
        muscle_file::read(&data("muscles/deltoid_posterior.toml")).expect("a muscle").muscle;
    for (vector, mode) in [
        ("fes_steps", reference::Mode::Fes),
        ("continuous_activation_3hz", reference::Mode::Continuous),
    ] {
        let trace = trace::read_inputs(&data(&format!("vectors/{vector}.csv"))).expect("inputs");
        let mut client = Client::new(Emulated::run(&image, &[]).expect("a machine"));
        // A greeting that the boot cuts is a broken frame.
        client.greet().expect("a session");
        let Ok(Answer::Report(booted)) = client.ask(&Request::Report) else { panic!("no report") };
        let played = hil::play(&mut client, &muscle, Class::Standard, mode, &trace, &mut |_| ())
            .expect("equal bits");
        assert_eq!(played.rows.len(), trace.inputs.len());
        let Report { longest_us, late, frames, .. } = played.report;
        assert_eq!(late, 0);
        assert_eq!((frames.broken, frames.refused), (booted.frames.broken, booted.frames.refused));
        // One instruction takes 8 ns.
        assert!((10..=80).contains(&longest_us), "{longest_us} us");
    }
}

/// Faults and the request that injects each.
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
        // 0.29 m; at the limit of path speed this takes longer than a reading may be old.
        (Fault::SensorJump, readings(Readings { path_um: Some(450_000), ..READINGS })),
        (Fault::Stopped, Request::Stop),
    ]
}

#[test]
fn faults_end_in_neutral_on_the_emulated_chip() {
    let Some(image) = image() else { return };
    let mut machine = Machine::start(&image, Vec::new());
    // Off after boot: arming is refused.
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
        // The fault is in a later report; the number of ticks depends on the speed of the host.
        assert!(after.ticks > before.ticks);
        assert_eq!((after.late, after.frames.broken), (0, 0), "{fault:?}: {after:?}");
        // Pulses were given; now all outputs are off and stay off.
        let closed = pins.closed;
        pins = machine.pins();
        assert!(pins.closed > closed + 10, "{fault:?}: {pins:?}");
        assert_eq!(pins.bridge, 0, "{fault:?}");
        machine.script(&kept_alive());
        // A channel whose pulse was interrupted may still discharge for a while.
        let later = machine.pins();
        assert_eq!((later.closed, later.channels), (pins.closed, 0), "{fault:?}: pulses after it");
        latched = fault;
    }

    // A silent host.
    machine.stimulated(latched, &[]);
    let pins = machine.settled_pins();
    assert_eq!((pins.bridge, pins.channels), (0, 0));
    assert_eq!(machine.report().state, State::Latched(Fault::Silence));
}

/// A flipped bit of a muscle's state in RAM is a fault and does not act on the force.
#[test]
fn a_flipped_bit_in_memory_is_a_fault_on_the_emulated_chip() {
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
    // Tendon extension, velocity and path are consecutive, in the bank of the tick and possibly in
    // the other one.
    let pattern: Vec<u8> = words[..3].iter().flat_map(|word| word.to_le_bytes()).collect();
    let found: Vec<usize> = (0..memory.len() - pattern.len())
        .filter(|&at| memory[at..].starts_with(&pattern))
        .collect();
    // The link's bank is overwritten before it is read.
    assert!((1..=2).contains(&found.len()), "the state in {size} bytes: {found:?}");
    for at in found {
        debugger.write(address + at as u64, &[memory[at] ^ 0x01]);
    }
    debugger.resume();

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
    // Acknowledging another fault has no effect, and this one persists: stimulation stays off.
    assert!(matches!(said[4], Said::NotArmed(_)), "{said:?}");
    assert_eq!(said[6], Said::NotArmed(NotArmed::StillThere(Fault::Checksum)));
    assert_eq!(machine.pins(), Pins::default());
    // Resetting the muscle to rest, with new checksums, clears it.
    machine.script(&[rest]);
    let (report, _) = machine.stimulated(Fault::Checksum, &[]);
    assert_eq!(report.wrong, None);
    assert!(machine.pins().closed > 10);
}

/// Bridge closures before a debugger stops a stimulating machine, and after it continues until the
/// pins settle. `instruction` replaces the first one of the tick.
fn closures_before_and_after(image: &Path, instruction: Option<u16>) -> (u32, u32) {
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
        // Bit 0 of a function's address marks Thumb code.
        debugger.write(address & !1, &instruction.to_le_bytes());
    }
    let before = machine.pins().closed;
    debugger.resume();
    let pins = machine.settled_pins();
    assert_eq!((pins.bridge, pins.channels), (0, 0));
    (before, pins.closed)
}

/// Largest number of bridge closures in a number of ticks shorter than the inter-pulse interval of
/// a channel: two per pulse; pulses of different channels do not overlap.
fn most_closures(ticks: u32) -> u32 {
    let consecutive = (ticks * TICK_US).div_ceil(stimulus(10_000).duration_us());
    2 * consecutive.min(CHANNELS as u32)
}

/// The first instruction of the tick is a branch to itself: the pulse timer stops without the tick.
#[test]
fn a_hanging_tick_ends_stimulation_on_the_emulated_chip() {
    let Some(image) = image() else { return };
    // Without the hang, pulses continue until 0.1 s after the last message of the host.
    let (before, after) = closures_before_and_after(&image, None);
    assert!(before > 20 && after > before + 40, "{before}, {after}");
    // With it, the rest of the current tick and a timeout of two ticks.
    let (before, after) = closures_before_and_after(&image, Some(0xe7fe));
    assert!(before > 20 && after <= before + most_closures(3), "{before}, {after}");
}

/// The first instruction of the tick is undefined: the core's fault handler resets the chip, and
/// all outputs are off after boot.
#[test]
fn a_core_fault_ends_stimulation_on_the_emulated_chip() {
    let Some(image) = image() else { return };
    let (before, after) = closures_before_and_after(&image, Some(0xde00));
    // Pulses continue until the next tick.
    assert!(before > 20 && after <= before + most_closures(1), "{before}, {after}");
}
