//! Memory of an emulated core and the inputs of the bench; on a host, nothing.

use std::path::Path;
use std::{env, fs};

/// QEMU's RISC-V machine starts in RAM.
const RISCV: &str = "MEMORY { RAM : ORIGIN = 0x80000000, LENGTH = 16M }
REGION_ALIAS(\"REGION_TEXT\", RAM);
REGION_ALIAS(\"REGION_RODATA\", RAM);
REGION_ALIAS(\"REGION_DATA\", RAM);
REGION_ALIAS(\"REGION_BSS\", RAM);
REGION_ALIAS(\"REGION_HEAP\", RAM);
REGION_ALIAS(\"REGION_STACK\", RAM);
";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../../memory.x");
    let output = env::var("OUT_DIR").expect("cargo names a folder for output");
    if env::var_os("CARGO_FEATURE_BENCH").is_some() {
        bench_inputs(Path::new(&output));
    }
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let here = env::var("CARGO_MANIFEST_DIR").expect("cargo names the package's folder");
    println!("cargo::rustc-link-search={here}/../..");
    if env::var("CARGO_CFG_TARGET_ARCH").as_deref() == Ok("riscv32") {
        // Not `memory.x`: the root has one, of the firmware's board.
        let script = Path::new(&output).join("riscv.x");
        fs::write(&script, RISCV).expect("a linker script");
        println!("cargo::rustc-link-arg-bins=-T{}", script.display());
    } else {
        cortex_m();
    }
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
}

/// What the bench runs, from the file that `VM_BENCH_INPUTS` names. Without it the bench builds,
/// and has nothing to run.
fn bench_inputs(output: &Path) {
    println!("cargo::rerun-if-env-changed=VM_BENCH_INPUTS");
    let inputs = env::var("VM_BENCH_INPUTS").map_or_else(
        |_| Vec::new(),
        |path| {
            println!("cargo::rerun-if-changed={path}");
            fs::read(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
        },
    );
    fs::write(output.join("bench_inputs.bin"), inputs).expect("a file to write");
}

/// Where the emulated board of a Cortex-M, `VM_MACHINE`, has its memories. By default that of the
/// firmware, whose they are in `memory.x`.
fn cortex_m() {
    println!("cargo::rerun-if-env-changed=VM_MACHINE");
    let machine = env::var("VM_MACHINE").unwrap_or_default();
    let (flash, ram, stack_end) = match machine.as_str() {
        // Cortex-M3 and Cortex-M7.
        "mps2-an385" | "mps2-an500" => (0, 0x2000_0000_u32, 0x2_0000),
        // Cortex-M33: it starts in its secure memories.
        "mps2-an505" => (0x1000_0000, 0x3800_0000, 0x8000),
        // Cortex-M0, with 16 KiB of RAM.
        "microbit" => (0, 0x2000_0000, 0x4000),
        "" | "netduinoplus2" => return,
        other => panic!("VM_MACHINE = {other}: its memories are not known"),
    };
    println!("cargo::rustc-link-arg-bins=--defsym=_flash_of_emulated_board={flash:#x}");
    println!("cargo::rustc-link-arg-bins=--defsym=_ram_of_emulated_board={ram:#x}");
    println!("cargo::rustc-link-arg-bins=--defsym=_stack_start={:#x}", ram + stack_end);
}
