//! Calls one function of an image directly with given arguments, for kernels that the image itself
//! does not call.
//!
//! QEMU loads the image and a small loader into the RAM above it, and starts there: it enables the
//! floating-point unit, sets stack and arguments, calls the function and ends the run.

use object::read::elf::{ElfFile32, FileHeader, ProgramHeader};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// An argument, passed per the procedure call standard.
#[derive(Clone, Debug, PartialEq)]
pub enum Argument {
    /// A word in the next of r0 to r3.
    Word(u32),
    /// A number in the next of s0 to s15.
    Float(f32),
    /// A number in the next free pair of s0 to s15, as d0 to d7.
    Double(f64),
    /// The address of some bytes in the next of r0 to r3.
    Buffer(Vec<u8>),
}

/// The text of an argument could not be parsed.
#[derive(Debug, thiserror::Error)]
#[error(
    "\"{0}\" is no argument: an integer (42, -1, 0x20), a float (1.5 or 1.5f64), zeroed bytes \
     (zeros:64) or literal bytes (bytes:00ff10)"
)]
pub struct ArgumentError(String);

impl FromStr for Argument {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        let integer = |text: &str| {
            text.strip_prefix("0x")
                .map_or_else(|| text.parse::<i64>(), |hex| i64::from_str_radix(hex, 16))
                .ok()
        };
        let parsed = if let Some(count) = text.strip_prefix("zeros:") {
            let count = integer(count).and_then(|count| usize::try_from(count).ok());
            count.filter(|&count| count <= BUFFERS).map(|count| Self::Buffer(vec![0; count]))
        } else if let Some(digits) = text.strip_prefix("bytes:") {
            bytes(digits).map(Self::Buffer)
        } else if let Some(number) = text.strip_suffix("f64") {
            number.parse().ok().map(Self::Double)
        } else if text.contains('.') {
            text.parse().ok().map(Self::Float)
        } else {
            integer(text)
                .filter(|word| (i64::from(i32::MIN)..=i64::from(u32::MAX)).contains(word))
                .map(|word| Self::Word(word as u32))
        };
        parsed.ok_or_else(|| ArgumentError(text.to_owned()))
    }
}

/// Parses pairs of hexadecimal digits.
fn bytes(digits: &str) -> Option<Vec<u8>> {
    let pairs = digits.as_bytes().chunks(2);
    pairs.map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()).collect()
}

/// Why a function could not be called directly.
#[derive(Debug, thiserror::Error)]
pub enum BootError {
    /// More arguments than argument registers.
    #[error("{1} {0}: only {2} are passed in registers")]
    Arguments(&'static str, usize, usize),
    /// The buffers do not fit into the reserved RAM.
    #[error("buffers of {0} bytes exceed the limit of {BUFFERS}")]
    Buffers(usize),
    /// The image occupies the loader's RAM.
    #[error(
        "the image uses {0:#010x}, and a direct call needs the RAM from {RESERVED:#010x} to \
         {RAM_END:#010x}"
    )]
    NoRoom(u32),
    /// The image could not be read.
    #[error("{}: {problem}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// The error.
        problem: String,
    },
    /// The loader's files could not be written.
    #[error("the loader's files: {0}")]
    Write(#[from] std::io::Error),
}

/// Start of the loader's RAM: stack of the call below `STACK`, buffers above it, then code.
const RESERVED: u32 = 0x2000_C000;
const STACK: u32 = 0x2001_0000;
const CODE: u32 = 0x2001_F000;
const RAM_END: u32 = 0x2002_0000;
/// Size of the buffers, bytes.
const BUFFERS: usize = (CODE - STACK) as usize;
/// Coprocessor Access Control Register; bits 20 to 23 enable the floating-point unit.
const CPACR: u32 = 0xE000_ED88;
/// Semihosting exit reason ADP_Stopped_ApplicationExit.
const APPLICATION_EXIT: u32 = 0x2_0026;

/// Start-up code with its two literals; [`table`] follows it.
const STUB: [u16; 32] = [
    0x4C0E, // 00 ldr r4, [pc, #0x38]  the table
    0xCC0E, // 02 ldm r4!, {r1, r2, r3}
    0x6808, // 04 ldr r0, [r1]
    0xF440,
    0x0070, // 06 orr r0, r0, #0xf00000
    0x6008, // 0a str r0, [r1]
    0xF3BF,
    0x8F4F, // 0c dsb sy
    0xF3BF,
    0x8F6F, // 10 isb sy
    0x4695, // 14 mov sp, r2
    0x461D, // 16 mov r5, r3
    0xCC0F, // 18 ldm r4!, {r0, r1, r2, r3}
    0xEC94,
    0x0A10, // 1a vldmia r4, {s0 to s15}
    0x47A8, // 1e blx r5
    0x2018, // 20 movs r0, #0x18  semihosting: exit
    0x4902, // 22 ldr r1, [pc, #8]  its reason
    0xBEAB, // 24 bkpt #0xab
    0xE7FE, // 26 b .
    0,
    0, // 28
    (APPLICATION_EXIT & 0xFFFF) as u16,
    (APPLICATION_EXIT >> 16) as u16, // 2c
    0,
    0,
    0,
    0,
    0,
    0, // 30
    ((CODE + 0x40) & 0xFFFF) as u16,
    ((CODE + 0x40) >> 16) as u16, // 3c
];

/// Register values in load order: address of CPACR, sp, the function, r0 to r3, s0 to s15; and the
/// contents of the buffers.
fn table(function: u32, arguments: &[Argument]) -> Result<(Vec<u32>, Vec<u8>), BootError> {
    let (mut words, mut floats, mut buffers) = (Vec::new(), Vec::new(), Vec::new());
    for argument in arguments {
        match argument {
            Argument::Word(word) => words.push(*word),
            Argument::Float(float) => floats.push(float.to_bits()),
            Argument::Double(double) => {
                let bits = double.to_bits();
                floats.resize(floats.len().next_multiple_of(2), 0);
                floats.extend([bits as u32, (bits >> 32) as u32]);
            }
            Argument::Buffer(bytes) => {
                words.push(STACK + buffers.len() as u32);
                buffers.extend(bytes);
                // Align the next buffer for any access.
                buffers.resize(buffers.len().next_multiple_of(8), 0);
            }
        }
    }
    for (what, values, most) in [("integers and buffers", &words, 4), ("floats", &floats, 16)] {
        if values.len() > most {
            return Err(BootError::Arguments(what, values.len(), most));
        }
    }
    if buffers.len() > BUFFERS {
        return Err(BootError::Buffers(buffers.len()));
    }
    words.resize(4, 0);
    floats.resize(16, 0);
    let thumb = function | 1;
    Ok(([[CPACR, STACK, thumb].as_slice(), &words, &floats].concat(), buffers))
}

/// The start-up code and its address.
pub fn code() -> (u32, Vec<u8>) {
    (CODE, STUB.iter().flat_map(|half| half.to_le_bytes()).collect())
}

/// QEMU arguments that call the function at an address of an image. Writes its files to `folder`.
pub fn loader_arguments(
    image: &Path,
    function: u32,
    arguments: &[Argument],
    folder: &Path,
) -> Result<Vec<String>, BootError> {
    let (table, buffers) = table(function, arguments)?;
    let (address, mut code) = code();
    code.extend(table.iter().flat_map(|word| word.to_le_bytes()));
    let mut loads = initialised_data(image)?;
    loads.push((address, code));
    if !buffers.is_empty() {
        loads.push((STACK, buffers));
    }
    let mut devices = Vec::new();
    for (address, bytes) in loads {
        let path = folder.join(format!("{address:x}.bin"));
        std::fs::write(&path, bytes)?;
        let path = path.display();
        devices.push("-device".to_owned());
        devices.push(format!("loader,file={path},addr={address:#x},force-raw=on"));
    }
    devices.push("-device".to_owned());
    devices.push(format!("loader,addr={:#x},cpu-num=0", CODE | 1));
    Ok(devices)
}

/// Initialised data that start-up code would copy to RAM, with its address.
fn initialised_data(image: &Path) -> Result<Vec<(u32, Vec<u8>)>, BootError> {
    let fail = |problem: String| BootError::Image { path: image.to_owned(), problem };
    let bytes = std::fs::read(image).map_err(|error| fail(error.to_string()))?;
    let file = ElfFile32::<object::Endianness>::parse(&*bytes)
        .map_err(|error| fail(format!("not a 32-bit ELF file: {error}")))?;
    let endian = file.endian();
    let header = file.elf_header();
    let segments =
        header.program_headers(endian, &*bytes).map_err(|error| fail(error.to_string()))?;
    let mut copies = Vec::new();
    let mut loaded = 0;
    for segment in segments.iter().filter(|s| s.p_type(endian) == object::elf::PT_LOAD) {
        loaded += 1;
        let (at, size) = (segment.p_vaddr(endian), segment.p_memsz(endian));
        if at < RAM_END && at.saturating_add(size) > RESERVED {
            return Err(BootError::NoRoom(at.max(RESERVED)));
        }
        if segment.p_vaddr(endian) != segment.p_paddr(endian) && segment.p_filesz(endian) > 0 {
            let data = segment
                .data(endian, &*bytes)
                .map_err(|()| fail("a segment is not in the file".to_owned()))?;
            copies.push((at, data.to_vec()));
        }
    }
    if loaded == 0 {
        return Err(fail("nothing to load: an object file has to be linked first".to_owned()));
    }
    Ok(copies)
}

#[cfg(test)]
mod tests {
    use super::super::instruction::Decoder;
    use super::*;

    #[test]
    fn the_stub_disassembles_to_its_comments() {
        let (_, code) = code();
        let decoder = Decoder::new().expect("a decoder");
        let mut at = 0;
        let mut texts = Vec::new();
        while at < 0x28 {
            let one = decoder.decode(&code[at..], at as u32).expect("an instruction");
            at += one.size as usize;
            texts.push(one.text);
        }
        let floats: Vec<String> = (0..16).map(|s| format!("s{s}")).collect();
        assert_eq!(
            texts,
            [
                "ldr r4, [pc, #0x38]",
                "ldm r4!, {r1, r2, r3}",
                "ldr r0, [r1]",
                "orr r0, r0, #0xf00000",
                "str r0, [r1]",
                "dsb sy",
                "isb sy",
                "mov sp, r2",
                "mov r5, r3",
                "ldm r4!, {r0, r1, r2, r3}",
                &format!("vldmia r4, {{{}}}", floats.join(", ")),
                "blx r5",
                "movs r0, #0x18",
                "ldr r1, [pc, #8]",
                "bkpt #0xab",
                "b #0x26",
            ]
        );
    }

    #[test]
    fn arguments_are_passed_per_the_procedure_call_standard() {
        let arguments = ["-1", "1.5", "zeros:3", "bytes:0aff", "0x10", "-2f64"]
            .map(|text| text.parse().expect("an argument"));
        let (table, buffers) = table(0x0800_0100, &arguments).expect("few enough");
        assert_eq!(table[..7], [CPACR, STACK, 0x0800_0101, u32::MAX, STACK, STACK + 8, 0x10]);
        assert_eq!(table[7..11], [1.5_f32.to_bits(), 0, 0, 0xC000_0000]);
        assert_eq!(buffers, [0, 0, 0, 0, 0, 0, 0, 0, 0x0A, 0xFF, 0, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn malformed_arguments_are_refused() {
        for text in ["", "x", "1.2.3", "zeros:-1", "zeros:100000", "bytes:0g", "0x1ffffffff"] {
            assert!(text.parse::<Argument>().is_err(), "{text}");
        }
        let words = vec![Argument::Word(0); 5];
        assert!(matches!(table(0, &words), Err(BootError::Arguments(_, 5, 4))));
    }
}
