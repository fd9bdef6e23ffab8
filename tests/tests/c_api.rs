//! The C library: C programs on host and target compute the same bits as Rust.
//!
//! Without a C compiler or QEMU these tests print SKIPPED; with `VM_REQUIRE_TARGET` set they fail.

use host_sim::target::{self, STM32F405};
use host_sim::trace;
use object::{Object, ObjectSymbol};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use system_tests::skip;
use vm_nostd::{ContinuousMuscle, FesMuscle, Fixed, Input, Output as Tick, Scalar, TimeStep};

#[path = "c_api/control.rs"]
mod control;
#[path = "c_api/header.rs"]
mod header;
#[path = "c_api/readme.rs"]
mod readme;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Number of rows that the C program steps.
const ROWS: usize = 1500;

/// Inputs of both arithmetics: steps of activation and frequency on a moving path.
struct Inputs {
    float: Vec<Input<f32>>,
    /// Per mille, µm, tenths of pps.
    integer: Vec<(u16, i32, u16)>,
}

fn inputs() -> Inputs {
    let path = root().join("host-sim/data/vectors/continuous_length_3hz.csv");
    let lengths = trace::read_inputs(&path).expect("inputs").inputs;
    let steps = root().join("host-sim/data/vectors/fes_steps.csv");
    let steps = trace::read_inputs(&steps).expect("inputs").inputs;
    let rows = || lengths.iter().zip(&steps).take(ROWS);
    Inputs {
        float: rows()
            .map(|(length, step)| Input {
                activation: step.activation as f32,
                path_length: length.path_length as f32,
                stimulation_frequency: step.stimulation_frequency as f32,
            })
            .collect(),
        integer: rows()
            .map(|(length, step)| {
                let whole = |value: f64| value.round() as i32;
                let short = |value: f64| u16::try_from(whole(value)).expect("a short number");
                (
                    short(step.activation * 1e3),
                    whole(length.path_length * 1e6),
                    short(step.stimulation_frequency * 10.0),
                )
            })
            .collect(),
    }
}

impl Inputs {
    /// As a C header; floats are exact.
    fn header(&self) -> String {
        let mut text =
            String::from("#include \"vm_nostd.h\"\nstatic const VmInputF32 inputs_f32[] = {\n");
        let exact = |value: f32| {
            let (sign, value) = if value < 0.0 { ("-", -value) } else { ("", value) };
            let (bits, exponent) = (value.to_bits() & 0x7f_ffff, value.to_bits() >> 23);
            if value == 0.0 {
                return "0.0f".to_owned();
            }
            format!("{sign}0x{:x}p{}f", bits | 0x80_0000, exponent as i32 - 150)
        };
        for input in &self.float {
            let [a, l, f] = [input.activation, input.path_length, input.stimulation_frequency];
            writeln!(text, "{{{}, {}, {}}},", exact(a), exact(l), exact(f)).expect("a string");
        }
        text.push_str("};\nstatic const VmInputFixed inputs_fixed[] = {\n");
        for (activation, length, frequency) in &self.integer {
            writeln!(text, "{{{length}, {activation}, {frequency}}},").expect("a string");
        }
        text.push_str("};\n");
        text
    }

    /// Outputs of the Rust library, in the order of the C program.
    fn bytes(&self) -> Vec<u8> {
        let fixed: Vec<Input<Fixed>> =
            self.integer.iter().map(|&(a, l, f)| Input::<Fixed>::from_integers(a, l, f)).collect();
        let mut bytes = Vec::new();
        for fes in [false, true] {
            bytes.extend(played(&self.float, fes));
            bytes.extend(played(&fixed, fes));
        }
        bytes
    }
}

/// Output words of a muscle that starts at rest on the first input's path.
fn played<S: Scalar<Bits = u32>>(inputs: &[Input<S>], fes: bool) -> Vec<u8> {
    let (first, rest) = inputs.split_first().expect("inputs");
    let step = TimeStep::MILLISECOND;
    let words = |output: Tick<S>| {
        [
            S::force_bits(output.force),
            output.fascicle_length.to_bits(),
            output.fascicle_velocity.to_bits(),
            output.relative_force.to_bits(),
            output.status.bits().into(),
        ]
    };
    let all: Vec<[u32; 5]> = if fes {
        let muscle = FesMuscle::<S, 2>::build(&vm_nostd_cores::MUSCLE, step).expect("a muscle");
        let mut state = muscle.rest(first.path_length).expect("a path");
        rest.iter().map(|&input| words(muscle.step(&mut state, input))).collect()
    } else {
        let muscle =
            ContinuousMuscle::<S, 2>::build(&vm_nostd_cores::MUSCLE, step).expect("a muscle");
        let mut state = muscle.rest(first.path_length).expect("a path");
        rest.iter().map(|&input| words(muscle.step(&mut state, input))).collect()
    };
    all.into_iter().flatten().flat_map(u32::to_le_bytes).collect()
}

/// Builds the library for a target, by default the host.
fn library(target: Option<&str>) -> PathBuf {
    let folder = root().join("target/c-library");
    let mut command = Command::new(env!("CARGO"));
    command
        .args(["build", "--release", "--package", "vm-nostd-c", "--target-dir"])
        .arg(&folder)
        // An incremental build inlines too little to be free of panics.
        .env("CARGO_INCREMENTAL", "0")
        .current_dir(root());
    if let Some(target) = target {
        command.args(["--target", target]);
    }
    let built = command.output().expect("cargo");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    folder.join(target.unwrap_or("")).join("release/libvm_nostd.a")
}

/// Compiles the C program for a platform; `None` without a compiler.
fn compile(compiler: &str, folder: &Path, platform: &str, arguments: &[&str]) -> Option<PathBuf> {
    let program = folder.join("golden");
    let sources = root().join("tests/c");
    std::fs::write(folder.join("inputs.h"), inputs().header()).expect("a header");
    let output = Command::new(compiler)
        .args(["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic", "-I"])
        .arg(root().join("vm-nostd/c/include"))
        .arg("-I")
        .arg(folder)
        .arg(sources.join("golden.c"))
        .arg(sources.join("misuse.c"))
        .arg(sources.join("control.c"))
        .arg(sources.join(platform))
        .args(arguments)
        .arg("-o")
        .arg(&program)
        .output();
    match output {
        Ok(output) => {
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            Some(program)
        }
        Err(error) => {
            skip(&format!("{compiler}: {error} (apt-get install gcc-arm-none-eabi gcc)"));
            None
        }
    }
}

/// Asserts that a program's words equal Rust's. A failed check writes its line number to standard
/// error.
fn compare(output: &Output) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "tests/c: {}, {said}", output.status);
    let expected = inputs().bytes();
    assert_eq!(expected.len(), 4 * 20 * (ROWS - 1));
    let (muscles, controllers) = output.stdout.split_at_checked(expected.len()).expect("words");
    control::compare(controllers);
    let same = muscles.chunks(20).zip(expected.chunks(20)).position(|(a, b)| a != b);
    assert_eq!(same, None, "the first tick that differs");
    // The rows are not all zeros.
    assert!(expected.chunks(20).filter(|tick| tick[..4] != [0; 4]).count() > ROWS);
}

#[test]
fn a_c_program_on_the_host_has_the_same_bits() {
    let folder = tempfile::tempdir().expect("a folder");
    let library = library(None);
    let library = library.to_str().expect("a path");
    let arguments = [library, "-lm", "-lpthread", "-ldl"];
    let Some(program) = compile("cc", folder.path(), "host.c", &arguments) else { return };
    compare(&Command::new(program).output().expect("a program"));
}

#[test]
fn a_c_program_on_the_target_has_the_same_bits_and_no_panic() {
    let folder = tempfile::tempdir().expect("a folder");
    let library = library(Some(STM32F405.triple));
    let script = root().join("tests/c/target.ld");
    let script = format!("-T{}", script.display());
    let arguments = [
        "-mcpu=cortex-m4",
        "-mthumb",
        "-mfloat-abi=hard",
        "-mfpu=fpv4-sp-d16",
        "-ffreestanding",
        "-nostdlib",
        "-Wl,--gc-sections",
        &script,
        library.to_str().expect("a path"),
    ];
    let Some(program) = compile("arm-none-eabi-gcc", folder.path(), "target.c", &arguments) else {
        return;
    };
    let image = std::fs::read(&program).expect("an image");
    let file = object::File::parse(&*image).expect("an ELF file");
    let names: Vec<&str> = file.symbols().filter_map(|symbol| symbol.name().ok()).collect();
    assert!(names.contains(&"vm_fixed_step"), "an image with symbols");
    let panics: Vec<&&str> = names.iter().filter(|name| name.contains("panic")).collect();
    assert!(panics.is_empty(), "{panics:?}");
    match target::emulator(STM32F405.machine, &program).output() {
        Ok(output) => compare(&output),
        Err(error) => skip(&format!("{}: {error}", target::QEMU)),
    }
}
