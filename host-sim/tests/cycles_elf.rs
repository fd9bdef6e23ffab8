//! `vm cycles --elf`: functions of equal name are distinguished, and a program that never ends is
//! stopped.
//!
//! The images are assembled here from a few instructions. Without QEMU, tests that need it print
//! SKIPPED.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const FLASH: u32 = 0x0800_0000;
/// Start of code, after stack pointer and reset vector.
const CODE: u32 = FLASH + 8;
/// Mangled symbols of two functions of equal name.
const FIRST: &str = "_ZN4test4spin17h0123456789abcdefE";
const SECOND: &str = "_ZN4test4spin17hfedcba9876543210E";

const NOP: u16 = 0xBF00;
const BX_LR: u16 = 0x4770;
const WFI: u16 = 0xBF30;
/// `b .`
const FOREVER: u16 = 0xE7FE;

/// `bl` from one address to a later one.
fn call(from: u32, to: u32) -> [u16; 2] {
    let offset = to - (from + 4);
    assert!(offset < 1 << 12);
    [0xF000, 0xF800 | (offset >> 1) as u16]
}

/// A program: reset calls the first `spin` (two instructions) twice and ends with the instruction
/// `end`. The other `spin` has four instructions, and `stuck` does not return.
fn program(end: u16) -> Vec<u8> {
    let [first, second, stuck] = [CODE + 12, CODE + 16, CODE + 24];
    let mut code = Vec::new();
    code.extend(call(CODE, first));
    code.extend(call(CODE + 4, first));
    code.extend([end, FOREVER]);
    code.extend([NOP, BX_LR, NOP, NOP, NOP, BX_LR, FOREVER]);
    let functions =
        [("reset", CODE, 12), (FIRST, first, 4), (SECOND, second, 8), ("stuck", stuck, 2)];
    image(&code, &functions)
}

/// An ELF file for a Cortex-M with one section of code, in flash.
fn image(code: &[u16], functions: &[(&str, u32, u32)]) -> Vec<u8> {
    let words =
        |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    let mut text = words(&[0x2002_0000, CODE | 1]);
    text.extend(code.iter().flat_map(|half| half.to_le_bytes()));
    let (mut names, mut symbols) = (vec![0], vec![0; 16]);
    for (name, address, size) in functions {
        symbols.extend(words(&[names.len() as u32, address | 1, *size, 0x0001_0002]));
        names.extend(name.bytes().chain([0]));
    }
    let section_names = b"\0.text\0.symtab\0.strtab\0.shstrtab\0";
    let start = 52 + 32;
    let mut contents = Vec::new();
    let mut place = |bytes: &[u8]| {
        let offset = start + contents.len() as u32;
        contents.extend(bytes);
        contents.resize(contents.len().next_multiple_of(4), 0);
        (offset, bytes.len() as u32)
    };
    let [
        (text_at, text_size),
        (symbols_at, symbols_size),
        (names_at, names_size),
        (of_sections, its_size),
    ] = [&text[..], &symbols, &names, section_names].map(&mut place);
    let headers_at = start + contents.len() as u32;
    let mut file = b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0".to_vec();
    // ELF header: executable, Arm, version 1, entry at reset; offsets and counts of headers.
    file.extend(words(&[0x0028_0002, 1, CODE | 1, 52, headers_at, 0x0500_0000]));
    file.extend(words(&[0x0020_0034, 0x0028_0001, 0x0004_0005]));
    // Program header: offset, virtual and physical address, sizes; readable and executable.
    file.extend(words(&[1, text_at, FLASH, FLASH, text_size, text_size, 5, 4]));
    file.extend(contents);
    file.extend(words(&[0; 10]));
    file.extend(words(&[1, 1, 6, FLASH, text_at, text_size, 0, 0, 4, 0]));
    file.extend(words(&[7, 2, 0, 0, symbols_at, symbols_size, 3, 5, 4, 16]));
    file.extend(words(&[15, 3, 0, 0, names_at, names_size, 0, 0, 1, 0]));
    file.extend(words(&[23, 3, 0, 0, of_sections, its_size, 0, 0, 1, 0]));
    file
}

fn cycles(image: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vm"))
        .args(["cycles", "--elf"])
        .arg(image)
        .args(arguments.split_whitespace())
        .output()
        .expect("vm runs")
}

/// Standard output and error; `None`, with a message, if QEMU is missing.
fn said(output: &Output) -> Option<(String, String)> {
    let [out, error] =
        [&output.stdout, &output.stderr].map(|b| String::from_utf8_lossy(b).into_owned());
    if error.contains("apt-get install qemu-system-arm")
        && std::env::var_os("VM_REQUIRE_TARGET").is_none()
    {
        eprintln!("SKIPPED: {error}");
        return None;
    }
    Some((out, error))
}

#[test]
fn functions_of_equal_name_are_selected_by_address_or_symbol() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("image.elf");
    fs::write(&path, program(FOREVER)).expect("an image");
    let (first, second) = (format!("{:#010x}", CODE + 12), format!("{:#010x}", CODE + 16));
    let output = cycles(&path, "--symbol spin --timeout 2");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    for word in ["2 functions are named \"spin\"", &first, &second, FIRST, SECOND] {
        assert!(message.contains(word), "no \"{word}\" in: {message}");
    }
    // Direct calls, by each name that the message lists.
    for (name, instructions) in [(first.as_str(), 2), (&second, 4), (FIRST, 2), (SECOND, 4)] {
        let output = cycles(&path, &format!("--symbol {name} --entry --timeout 20"));
        let Some((text, message)) = said(&output) else { return };
        assert!(output.status.success(), "{name}: {message}");
        let words = format!("1 calls of up to {instructions} instructions");
        assert!(text.contains(&words), "{name}: no \"{words}\" in: {text}");
    }
    let output = cycles(&path, "--symbol 0x08000000");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("0 functions are named \"0x08000000\""), "{message}");
}

#[test]
fn a_program_that_never_ends_is_stopped_at_the_timeout() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("image.elf");
    // Both in an endless loop and asleep.
    for end in [FOREVER, WFI] {
        fs::write(&path, program(end)).expect("an image");
        // Calls that returned before the timeout are counted.
        let output = cycles(&path, &format!("--symbol {FIRST} --timeout 2"));
        let Some((text, message)) = said(&output) else { return };
        assert!(output.status.success(), "{message}");
        assert!(
            message.contains("still running after 2 s (--timeout): 2 calls until then"),
            "{message}"
        );
        assert!(text.contains("2 calls of up to 2 instructions"), "{text}");
        // Functions that were not called or did not return are reported.
        let output = cycles(&path, &format!("--symbol {SECOND} --timeout 2"));
        let (_, message) = said(&output).expect("QEMU");
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("still running after 2 s (--timeout)"), "{message}");
        assert!(message.contains("was not called"), "{message}");
    }
    let output = cycles(&path, "--symbol stuck --entry --timeout 2");
    let (_, message) = said(&output).expect("QEMU");
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("still running after 2 s (--timeout)"), "{message}");
    assert!(message.contains("stuck was called and has not returned"), "{message}");
    let help = cycles(&path, "--help");
    assert!(String::from_utf8_lossy(&help.stdout).contains("[default: 60]"));
}
