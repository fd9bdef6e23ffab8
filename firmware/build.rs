//! Linker arguments for the target; nothing on a host.

use std::env;

/// RAM reserved for the stack, of 128 KiB; `vm stack` computes how much is used.
const STACK_BYTES: u32 = 40 * 1024;

fn main() {
    println!("cargo::rerun-if-changed=../memory.x");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let here = env::var("CARGO_MANIFEST_DIR").expect("cargo names the package's folder");
    println!("cargo::rustc-link-search={here}/..");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    // The last two sectors store the uploads.
    println!("cargo::rustc-link-arg-bins=--defsym=_flash_has_storage=1");
    // Statics are above the stack: where it overflows, there is no memory to write to.
    println!("cargo::rustc-link-arg-bins=--defsym=_stack_bytes={STACK_BYTES}");
    println!("cargo::rustc-link-arg-bins=--defsym=_stack_start=0x20000000+{STACK_BYTES}");
    println!("cargo::rustc-link-arg-bins=--defsym=_stack_end=0x20000000");
}
