//! Muscles as constant words: `vm emit`, and the smallest firmware with a muscle.
//!
//! Without the thumb target or QEMU the tests of firmware print SKIPPED.

#[path = "../../vm-nostd/examples/src/emulated/inputs.rs"]
mod inputs;

use host_sim::emit::{Emission, Language};
use host_sim::engine::{Arithmetic, C_UNITS, Class};
use host_sim::model_muscle;
use host_sim::muscle_file::{self, NamedMuscle};
use host_sim::muscles;
use host_sim::reference::Mode;
use host_sim::target::{self, root};
use inputs::{Integers, TICKS};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SymbolKind};
use std::path::{Path, PathBuf};
use std::process::Command;
use system_tests::skip;
use vm_nostd::{
    EffectiveLength, FascicleLength, FesMuscle, Fixed, Input, IntramuscularFes, Muscle,
    NaturalContinuous, NaturalDiscrete, Recruitment, Scalar, TimeStep,
};

/// Cortex-M4F of Arm's MPS2 board, whose flash begins at 0.
const MACHINE: &str = "mps2-an386";
const TRIPLE: &str = "thumbv7em-none-eabihf";
/// Most flash of the smallest firmware with an FES muscle, bytes.
const MOST_FLASH: u64 = 20 * 1024;

fn deltoid() -> NamedMuscle {
    let file = root().join("host-sim/data/muscles/deltoid_posterior.toml");
    muscle_file::read(&file).expect("a muscle")
}

fn emission(named: &NamedMuscle, mode: Mode, arithmetic: Arithmetic) -> Emission<'_> {
    let NamedMuscle { name, muscle, class, .. } = named;
    Emission { name, muscle, mode, arithmetic, class: *class, time_step: 1e-3 }
}

/// The words in the sources of firmware and of C are those of this build.
#[test]
fn the_words_of_the_repository_are_current() {
    let named = deltoid();
    let files = [
        (Arithmetic::F32, Language::Rust, "vm-nostd/examples/src/emulated/deltoid_f32.rs"),
        (Arithmetic::Fixed, Language::Rust, "vm-nostd/examples/src/emulated/deltoid_fixed.rs"),
        (Arithmetic::F32, Language::C, "tests/c/words_f32.h"),
        (Arithmetic::Fixed, Language::C, "tests/c/words_fixed.h"),
    ];
    for (arithmetic, language, file) in files {
        let text = emission(&named, Mode::Fes, arithmetic).text(language).expect("words");
        let path = root().join(file);
        if std::env::var_os("VM_WRITE").is_some() {
            std::fs::write(&path, &text).expect("a file");
        }
        let kept = std::fs::read_to_string(&path).expect("a text");
        assert_eq!(kept, text, "VM_WRITE=1 cargo test --release -p system-tests --test emitted");
    }
}

/// The numbers of an emitted text.
fn numbers(text: &str) -> Vec<u32> {
    let (_, list) = text.split_once("= [\n").or(text.split_once("= {\n")).expect("a list");
    let (list, _) = list.split_once("\n]").or(list.split_once("\n}")).expect("its end");
    let number = |text: &str| u32::from_str_radix(text.trim().strip_prefix("0x")?, 16).ok();
    list.trim_end_matches(',').split(',').map(|text| number(text).expect("a word")).collect()
}

/// The text's words are those of the muscle that the host builds.
fn same<S: Scalar, R: Recruitment<S, 2>>(emission: &Emission<'_>, units: &R::Units) {
    let step = TimeStep::from_seconds(emission.time_step).expect("a step");
    let class = emission.class.of_model();
    let params = vm_nostd::MuscleParams { class, ..model_muscle::params(emission.muscle) };
    let built = Muscle::<S, R, 2>::build_with_units(&params, units, step).expect("a muscle");
    for language in [Language::Rust, Language::C] {
        let words = numbers(&emission.text(language).expect("a text"));
        let read = Muscle::<S, R, 2>::from_words(&words, class, step).expect("its words");
        assert_eq!(read.checksum(), built.checksum(), "{}", emission.name);
    }
}

/// All modes of an arithmetic.
fn in_every_mode<S: Scalar>(emission: &Emission<'_>) {
    let of = |mode| Emission { mode, ..*emission };
    same::<S, NaturalContinuous>(&of(Mode::Continuous), &());
    same::<S, IntramuscularFes>(&of(Mode::Fes), &());
    let units = model_muscle::motor_units::<2, C_UNITS>(emission.muscle).expect("units");
    same::<S, NaturalDiscrete<FascicleLength, C_UNITS>>(&of(Mode::Discrete), &units);
    same::<S, NaturalDiscrete<EffectiveLength, C_UNITS>>(
        &of(Mode::DiscreteEffectiveLength),
        &units,
    );
}

#[test]
fn every_named_muscle_is_read_back_from_either_language() {
    let mut named: Vec<_> =
        muscles::all().iter().map(|human| (human.name.clone(), human.muscle())).collect();
    named.push(("deltoid".to_owned(), deltoid().muscle));
    assert!(named.len() > 10, "{}", named.len());
    for (name, muscle) in &mut named {
        for fiber in &mut muscle.fibers {
            fiber.units = vec![1.0, 2.0, 3.0];
        }
        for (class, time_step) in
            [(Class::Economy, 1e-3), (Class::Standard, 0.4e-3), (Class::Fine, 2e-3)]
        {
            let of = |arithmetic| Emission {
                name,
                muscle,
                mode: Mode::Fes,
                arithmetic,
                class,
                time_step,
            };
            in_every_mode::<f32>(&of(Arithmetic::F32));
            in_every_mode::<f64>(&of(Arithmetic::F64));
            in_every_mode::<Fixed>(&of(Arithmetic::Fixed));
        }
    }
}

/// Names and comments cannot leave their place in the text.
#[test]
fn a_name_of_any_characters_makes_valid_c() {
    let muscle = deltoid().muscle;
    for name in ["", "*/ int x; /*", "2 b\n#error\n", "ä\\\"", "m. biceps (long head)"] {
        let emission = Emission {
            name,
            muscle: &muscle,
            mode: Mode::Fes,
            arithmetic: Arithmetic::Fixed,
            class: Class::Standard,
            time_step: 1e-3,
        };
        let text = emission.text(Language::C).expect("a text");
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("words.c");
        // A main file has no once.
        std::fs::write(&file, text.replace("#pragma once\n", "")).expect("a file");
        let include = root().join("vm-nostd/c/include");
        let compiled = Command::new("cc")
            .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsyntax-only", "-I"])
            .arg(include)
            .arg(&file)
            .output();
        match compiled {
            Ok(output) => {
                assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            }
            Err(error) => return skip(&format!("cc: {error}")),
        }
    }
}

#[test]
fn more_motor_units_than_c_has_room_for_are_refused() {
    let mut muscle = deltoid().muscle;
    for fiber in &mut muscle.fibers {
        fiber.units = vec![1.0; 40];
    }
    let emission = Emission {
        name: "many units",
        muscle: &muscle,
        mode: Mode::Discrete,
        arithmetic: Arithmetic::F32,
        class: Class::Standard,
        time_step: 1e-3,
    };
    let error = emission.text(Language::C).expect_err("too many");
    assert_eq!(error.to_string(), "80 motor units: the C library has room for 64");
    let text = emission.text(Language::Rust).expect("a text");
    assert!(text.contains("DiscreteMuscle<f32, 2, 512>"), "{text}");
}

/// Builds a smallest program; `None` if that is skipped.
fn image(program: &str) -> Option<PathBuf> {
    let folder = root().join("target/on-target");
    let output = Command::new(env!("CARGO"))
        .args(["build", "--release", "--package", "vm-nostd-examples", "--features", "emulated"])
        .args(["--target", TRIPLE, "--bin", program, "--target-dir"])
        .arg(&folder)
        // An incremental build is larger.
        .env("CARGO_INCREMENTAL", "0")
        .current_dir(root())
        .output()
        .expect("cargo");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if said.contains("can't find crate for `core`") {
        skip(&format!("rustup target add {TRIPLE}"));
        return None;
    }
    assert!(output.status.success(), "{said}");
    Some(folder.join(TRIPLE).join("release").join(program))
}

/// Bytes of flash: code, constants, and initial values of statics.
fn flash(image: &Path) -> u64 {
    let bytes = std::fs::read(image).expect("an image");
    let file = object::File::parse(&*bytes).expect("an ELF file");
    let kept = |section: &object::Section<'_, '_>| {
        let SectionFlags::Elf { sh_flags } = section.flags() else { panic!("not ELF") };
        sh_flags & u64::from(object::elf::SHF_ALLOC) != 0
            && section.kind() != object::SectionKind::UninitializedData
    };
    file.sections().filter(kept).map(|section| section.size()).sum()
}

/// Words of all outputs of a muscle that the host builds.
fn on_host<S: Scalar<Bits = u32>>(input: impl Fn(Integers) -> Input<S>) -> Vec<u8> {
    let params = model_muscle::params(&deltoid().muscle);
    let muscle = FesMuscle::<S, 2>::build(&params, TimeStep::MILLISECOND).expect("a muscle");
    let mut state = muscle.rest(input(inputs::at(0)).path_length).expect("in range");
    let words = (0..TICKS).flat_map(|tick| {
        let output = muscle.step(&mut state, input(inputs::at(tick)));
        [
            S::force_bits(output.force),
            output.fascicle_length.to_bits(),
            output.fascicle_velocity.to_bits(),
            output.relative_force.to_bits(),
            output.status.bits().into(),
        ]
    });
    words.flat_map(u32::to_le_bytes).collect()
}

/// The program is small, links nothing that builds, and has the host's bits.
fn small_and_equal(program: &str, expected: &[u8]) {
    let Some(image) = image(program) else { return };
    let bytes = std::fs::read(&image).expect("an image");
    let file = object::File::parse(&*bytes).expect("an ELF file");
    // Without the names of object files, of which nothing may be linked.
    let functions = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text);
    let names: Vec<&str> = functions.filter_map(|symbol| symbol.name().ok()).collect();
    assert!(names.iter().any(|name| name.contains("vm_nostd")), "an image with symbols");
    let builds = ["libm", "MuscleParams", "build", "panic_fmt", "muldf3", "divdf3", "dmul", "ddiv"];
    let found: Vec<_> =
        names.iter().filter(|name| builds.iter().any(|part| name.contains(part))).collect();
    assert!(found.is_empty(), "{program}: {found:?}");
    let flash = flash(&image);
    assert!(flash <= MOST_FLASH, "{program}: {flash} bytes of flash, of at most {MOST_FLASH}");
    // An image of code that is not there would be small as well.
    assert!(flash > MOST_FLASH / 3, "{program}: {flash} bytes");
    match target::emulator(MACHINE, &image).output() {
        Ok(output) => {
            assert!(output.status.success(), "{program}: {}", output.status);
            let same = output.stdout.chunks(20).zip(expected.chunks(20)).position(|(a, b)| a != b);
            assert_eq!(same, None, "{program}: the first tick that differs");
            assert_eq!(output.stdout.len(), expected.len());
        }
        Err(error) => skip(&format!("{}: {error}", target::QEMU)),
    }
}

#[test]
fn the_smallest_firmware_in_f32_has_the_hosts_bits() {
    let expected = on_host::<f32>(|integers| Input {
        activation: f32::from(integers.activation) * 1e-3,
        path_length: integers.path_length as f32 * 1e-6,
        stimulation_frequency: f32::from(integers.stimulation_frequency) * 0.1,
    });
    let forces =
        expected.chunks(20).map(|tick| f32::from_le_bytes([tick[0], tick[1], tick[2], tick[3]]));
    let most = forces.fold(0.0_f32, f32::max);
    assert!(most > 50.0, "{most} N");
    small_and_equal("emitted-f32", &expected);
}

#[test]
fn the_smallest_firmware_in_fixed_point_has_the_hosts_bits() {
    let expected = on_host::<Fixed>(|integers| {
        let Integers { activation, path_length, stimulation_frequency } = integers;
        Input::<Fixed>::from_integers(activation, path_length, stimulation_frequency)
    });
    small_and_equal("emitted-fixed", &expected);
}
