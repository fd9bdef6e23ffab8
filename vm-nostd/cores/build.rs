//! Linker arguments and memory of an emulated core; nothing on a host.

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
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let target = env::var("TARGET").expect("cargo names the target");
    let here = env::var("CARGO_MANIFEST_DIR").expect("cargo names the package's folder");
    println!("cargo::rustc-link-search={here}/../..");
    match target.as_str() {
        // mps2-an505 starts in its secure memories.
        "thumbv8m.main-none-eabihf" => board(0x1000_0000, 0x3800_0000),
        // mps2-an500.
        "thumbv7em-none-eabihf" => board(0, 0x2000_0000),
        _ => {
            let folder = env::var("OUT_DIR").expect("cargo names a folder for output");
            // Not `memory.x`: the root has one, of the firmware's board.
            let script = Path::new(&folder).join("riscv.x");
            fs::write(&script, RISCV).expect("a linker script");
            println!("cargo::rustc-link-arg-bins=-T{}", script.display());
        }
    }
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
}

/// Where a Cortex-M board has its memories, for the root's `memory.x`.
fn board(flash: u32, ram: u32) {
    println!("cargo::rustc-link-arg-bins=--defsym=_flash_of_emulated_board={flash:#x}");
    println!("cargo::rustc-link-arg-bins=--defsym=_ram_of_emulated_board={ram:#x}");
    let stack = ram + 0x8000;
    println!("cargo::rustc-link-arg-bins=--defsym=_stack_start={stack:#x}");
}
