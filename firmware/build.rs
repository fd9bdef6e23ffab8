//! Linker arguments for the target, and the inputs of the bench; nothing else on a host.

use std::path::Path;
use std::{env, fs};

/// RAM reserved for the stack, of 128 KiB; `vm stack` computes how much is used.
const STACK_BYTES: u32 = 40 * 1024;

fn main() {
    println!("cargo::rerun-if-changed=../memory.x");
    println!("cargo::rerun-if-env-changed=VM_BENCH_INPUTS");
    let output = env::var("OUT_DIR").expect("cargo names a folder for output");
    let inputs = env::var("VM_BENCH_INPUTS");
    let is_bench = inputs.is_ok();
    let inputs = match inputs {
        Ok(path) => {
            println!("cargo::rerun-if-changed={path}");
            fs::read(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
        }
        // Without inputs the bench builds, and has nothing to run.
        Err(_) => Vec::new(),
    };
    fs::write(Path::new(&output).join("bench_inputs.bin"), inputs).expect("a file to write");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let here = env::var("CARGO_MANIFEST_DIR").expect("cargo names the package's folder");
        println!("cargo::rustc-link-search={here}/..");
        // The emulated boards with a Cortex-M3 and a Cortex-M0 have their flash at 0, and the
        // smaller of them, a micro:bit, has 16 KiB of RAM.
        if env::var("TARGET").as_deref() != Ok("thumbv7em-none-eabihf") {
            println!("cargo::rustc-link-arg-bins=--defsym=_flash_of_emulated_board=0");
            // The bench, with muscles of 60 motor units, runs on the larger one.
            let end = if is_bench { "0x20020000" } else { "0x20004000" };
            println!("cargo::rustc-link-arg-bins=--defsym=_stack_start={end}");
        }
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        if env::var_os("CARGO_FEATURE_BOARD_STM32F405").is_some() {
            println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
            // The last two sectors store the uploads.
            println!("cargo::rustc-link-arg-bins=--defsym=_flash_has_storage=1");
            // Statics are above the stack: where it overflows, there is no memory to write to.
            println!("cargo::rustc-link-arg-bins=--defsym=_stack_bytes={STACK_BYTES}");
            println!("cargo::rustc-link-arg-bins=--defsym=_stack_start=0x20000000+{STACK_BYTES}");
            println!("cargo::rustc-link-arg-bins=--defsym=_stack_end=0x20000000");
        }
    }
}
