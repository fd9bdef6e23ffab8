//! Linker arguments for the target; nothing on a host.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let here = env::var("CARGO_MANIFEST_DIR").expect("cargo names the package's folder");
        println!("cargo::rustc-link-search={here}/../..");
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        // The LM3S6965 has its flash at 0.
        println!("cargo::rustc-link-arg-bins=--defsym=_flash_of_emulated_board=0");
        println!("cargo::rustc-link-arg-bins=--defsym=_stack_start=0x20010000");
    }
}
