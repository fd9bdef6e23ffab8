//! A decoded instruction, reduced to the properties that determine its timing.

use capstone::arch::ArchOperand;
use capstone::arch::arm::{ArchExtraMode, ArchMode, ArmOperandType};
use capstone::prelude::*;

/// Timing class of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Class {
    /// Integer arithmetic, logic, moves, multiplications of one word.
    Integer,
    /// UMULL and SMULL.
    LongMultiply,
    /// UMLAL, SMLAL and UMAAL.
    LongMultiplyAccumulate,
    /// MLA and MLS.
    MultiplyAccumulate,
    /// SDIV and UDIV.
    IntegerDivide,
    /// LDR and its narrow forms.
    Load,
    /// STR with an immediate offset, and its narrow forms.
    Store,
    /// STR with a register as offset.
    StoreByRegister,
    /// LDM, POP, LDRD, VLDM and similar, with the number of words.
    LoadMany(u32),
    /// STM, PUSH, STRD, VSTM and similar, with the number of words.
    StoreMany(u32),
    /// B, conditional or not, CBZ, CBNZ.
    Branch,
    /// BL.
    Call,
    /// BX, BLX, TBB and TBH: the target comes from a register or a table.
    BranchToRegister,
    /// IT.
    IfThen,
    /// VADD, VSUB, VMUL, VCVT: the next instruction may stall on the result.
    Float,
    /// VABS, VNEG, VCMP, VMOV, VMRS: no such stall.
    FloatMove,
    /// VMOV between two core registers and the floating-point unit.
    FloatMoveTwo,
    /// VMLA, VFMA and similar.
    FloatMultiplyAccumulate,
    /// VDIV and VSQRT.
    FloatDivide,
}

/// A set of registers as bits: r0..r15, then s0..s31.
pub type Registers = u64;

const PROGRAM_COUNTER: Registers = 1 << 15;
const LINK_REGISTER: Registers = 1 << 14;

/// A memory operand: base and index registers plus displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Place {
    /// Base and index registers.
    pub registers: Registers,
    /// Displacement, bytes.
    pub displacement: i32,
}

/// One instruction at one address.
#[derive(Clone, Debug, PartialEq)]
pub struct Instruction {
    /// Address.
    pub address: u32,
    /// Size, 2 or 4 bytes.
    pub size: u32,
    /// Timing class.
    pub class: Class,
    /// Registers it reads, except for addresses.
    pub reads: Registers,
    /// Registers it forms addresses from.
    pub addresses: Registers,
    /// Memory operand; `None` if the instruction writes one of its address registers.
    pub place: Option<Place>,
    /// Registers it writes.
    pub writes: Registers,
    /// Change of the stack pointer, bytes.
    pub stack_change: i32,
    /// Disassembly.
    pub text: String,
}

impl Instruction {
    /// Whether it writes the program counter, such as a POP that returns.
    pub fn writes_program_counter(&self) -> bool {
        self.writes & PROGRAM_COUNTER != 0
    }

    /// Mnemonic.
    pub fn mnemonic(&self) -> &str {
        self.text.split(' ').next().unwrap_or(&self.text)
    }

    /// Target address of a direct branch or call.
    pub fn target(&self) -> Option<u32> {
        let digits = self.text.rsplit("#0x").next()?;
        u32::from_str_radix(digits, 16).ok()
    }

    /// Whether it is a single load or store, which can be pipelined with another.
    pub fn is_single_access(&self) -> bool {
        matches!(self.class, Class::Load | Class::Store)
    }
}

/// Disassembler.
pub struct Decoder(Capstone);

impl Decoder {
    /// A decoder for an M33 and an M7, whose instruction sets include those of the other cores.
    pub fn new() -> Result<Self, capstone::Error> {
        let capstone = Capstone::new()
            .arm()
            .mode(ArchMode::Thumb)
            .extra_mode([ArchExtraMode::MClass, ArchExtraMode::V8].into_iter())
            .detail(true)
            .build()?;
        Ok(Self(capstone))
    }

    /// Decodes the first instruction of `code`; `None` if it is invalid.
    pub fn decode(&self, code: &[u8], address: u32) -> Option<Instruction> {
        let decoded = self.0.disasm_count(code, u64::from(address), 1).ok()?;
        let instruction = decoded.iter().next()?;
        let detail = self.0.insn_detail(instruction).ok()?;
        let mnemonic = instruction.mnemonic()?.to_owned();
        let operands = instruction.op_str().unwrap_or("").to_owned();

        let (mut reads, mut writes, mut addresses) = (0, 0, 0);
        let mut displacement = None;
        for operand in detail.arch_detail().operands() {
            let ArchOperand::ArmOperand(operand) = operand;
            match operand.op_type {
                ArmOperandType::Reg(register) => {
                    let bits = self.bits(register);
                    if operand.access.is_none_or(|access| access.is_writable()) {
                        writes |= bits;
                    }
                    if operand.access.is_none_or(|access| access.is_readable()) {
                        reads |= bits;
                    }
                }
                ArmOperandType::Mem(memory) => {
                    addresses |= self.bits(memory.base()) | self.bits(memory.index());
                    displacement = Some(memory.disp());
                }
                _ => {}
            }
        }
        for &register in detail.regs_write() {
            writes |= self.bits(register);
        }
        Some(Instruction {
            address,
            size: instruction.len() as u32,
            class: classify(&mnemonic, &operands),
            reads,
            addresses,
            place: displacement
                .filter(|_| writes & addresses == 0)
                .map(|displacement| Place { registers: addresses, displacement }),
            writes,
            stack_change: stack_change(&mnemonic, &operands),
            text: format!("{mnemonic} {operands}").trim_end().to_owned(),
        })
    }

    /// The bits of a register.
    fn bits(&self, register: RegId) -> Registers {
        let Some(name) = self.0.reg_name(register) else { return 0 };
        match name.as_str() {
            "sb" => 1 << 9,
            "sl" => 1 << 10,
            "fp" => 1 << 11,
            "ip" => 1 << 12,
            "sp" => 1 << 13,
            "lr" => LINK_REGISTER,
            "pc" => PROGRAM_COUNTER,
            _ => {
                let (kind, number) = name.split_at(1);
                match (kind, number.parse::<u32>()) {
                    ("r", Ok(number @ 0..=15)) => 1 << number,
                    ("s", Ok(number @ 0..=31)) => 1 << (16 + number),
                    ("d", Ok(number @ 0..=15)) => 0b11 << (16 + 2 * number),
                    _ => 0,
                }
            }
        }
    }
}

/// Number of words in a register list such as "{r4, r5, lr}" or "{d8, d9}".
fn words_in_list(operands: &str) -> u32 {
    let Some((_, list)) = operands.split_once('{') else { return 0 };
    let names = list.trim_end_matches('}').split(',');
    names.map(|name| if name.trim().starts_with('d') { 2 } else { 1 }).sum()
}

fn classify(mnemonic: &str, operands: &str) -> Class {
    // "vadd.f32", "ldr.w", "beq.w": the suffix after the dot is a size or type; the name may end
    // with a condition.
    let (name, kind) = mnemonic.split_once('.').unwrap_or((mnemonic, ""));
    let double = kind.contains("f64") || operands.starts_with('d');
    let starts = |prefixes: &[&str]| prefixes.iter().any(|prefix| name.starts_with(prefix));
    let by_register = || {
        let inside = operands.split_once('[').map_or("", |(_, rest)| rest);
        inside.split(',').nth(1).is_some_and(|part| !part.contains('#'))
    };
    if name.starts_with('v') {
        return match () {
            () if starts(&["vldm", "vpop"]) => Class::LoadMany(words_in_list(operands)),
            () if starts(&["vstm", "vpush"]) => Class::StoreMany(words_in_list(operands)),
            () if starts(&["vldr"]) => {
                if double {
                    Class::LoadMany(2)
                } else {
                    Class::Load
                }
            }
            () if starts(&["vstr"]) => {
                if double {
                    Class::StoreMany(2)
                } else {
                    Class::Store
                }
            }
            () if starts(&["vdiv", "vsqrt"]) => Class::FloatDivide,
            () if starts(&["vmla", "vmls", "vnmla", "vnmls", "vfma", "vfms", "vfnma", "vfnms"]) => {
                Class::FloatMultiplyAccumulate
            }
            () if starts(&["vmov"]) && operands.split(',').count() > 2 => Class::FloatMoveTwo,
            () if starts(&["vmov", "vabs", "vneg", "vcmp", "vmrs", "vmsr"]) => Class::FloatMove,
            () => Class::Float,
        };
    }
    match () {
        () if starts(&["ldm", "pop"]) => Class::LoadMany(words_in_list(operands)),
        () if starts(&["stm", "push"]) => Class::StoreMany(words_in_list(operands)),
        () if starts(&["ldrd"]) => Class::LoadMany(2),
        () if starts(&["strd"]) => Class::StoreMany(2),
        () if starts(&["ldr"]) => Class::Load,
        () if starts(&["str"]) && by_register() => Class::StoreByRegister,
        () if starts(&["str"]) => Class::Store,
        () if starts(&["sdiv", "udiv"]) => Class::IntegerDivide,
        () if name == "mla" || name == "mls" => Class::MultiplyAccumulate,
        () if starts(&["umull", "smull"]) => Class::LongMultiply,
        () if starts(&["umlal", "smlal", "umaal"]) => Class::LongMultiplyAccumulate,
        () if starts(&["blx", "bx", "tbb", "tbh"]) => Class::BranchToRegister,
        () if name == "bl" => Class::Call,
        () if starts(&["cbz", "cbnz"]) => Class::Branch,
        () if name.starts_with('b') && !starts(&["bic", "bfi", "bfc", "bkpt"]) => Class::Branch,
        () if name.starts_with("it") => Class::IfThen,
        () => Class::Integer,
    }
}

/// Change of the stack pointer by an instruction, bytes.
fn stack_change(mnemonic: &str, operands: &str) -> i32 {
    let name = mnemonic.split('.').next().unwrap_or(mnemonic);
    let list = 4 * words_in_list(operands) as i32;
    let on_stack = operands.starts_with("sp!");
    let immediate = || {
        let text = operands.rsplit('#').next().unwrap_or("").trim_end_matches(['!', ']']);
        let (sign, digits) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
        let value = digits
            .strip_prefix("0x")
            .map_or_else(|| digits.parse().ok(), |hex| i32::from_str_radix(hex, 16).ok());
        sign * value.unwrap_or(0)
    };
    match name {
        "push" | "vpush" => -list,
        "pop" | "vpop" => list,
        _ if on_stack && (name.starts_with("stm") || name.starts_with("vstm")) => -list,
        _ if on_stack && (name.starts_with("ldm") || name.starts_with("vldm")) => list,
        "sub" | "subw" if operands.starts_with("sp,") => -immediate(),
        "add" | "addw" if operands.starts_with("sp,") => immediate(),
        // Pre- and post-indexed loads and stores with sp as base.
        _ if operands.contains("[sp, #") && operands.ends_with('!') => immediate(),
        _ if operands.contains("[sp], #") => immediate(),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(halfwords: &[u16]) -> Instruction {
        let code: Vec<u8> = halfwords.iter().flat_map(|h| h.to_le_bytes()).collect();
        Decoder::new().expect("a decoder").decode(&code, 0x0800_0000).expect("an instruction")
    }

    #[test]
    fn instructions_are_classified_by_timing() {
        let cases: &[(&[u16], &str, Class)] = &[
            (&[0xEE20, 0x0A20], "vmul.f32 s0, s0, s1", Class::Float),
            (&[0xEEA0, 0x0A81], "vfma.f32 s0, s1, s2", Class::FloatMultiplyAccumulate),
            (&[0xEE80, 0x0A20], "vdiv.f32 s0, s0, s1", Class::FloatDivide),
            (&[0xEEB4, 0x0A60], "vcmp.f32 s0, s1", Class::FloatMove),
            (&[0xEEF1, 0xFA10], "vmrs apsr_nzcv, fpscr", Class::FloatMove),
            (&[0xEEB8, 0x0AC0], "vcvt.f32.s32 s0, s0", Class::Float),
            (&[0xED90, 0x0A01], "vldr s0, [r0, #4]", Class::Load),
            (&[0xED80, 0x0A01], "vstr s0, [r0, #4]", Class::Store),
            (&[0xED2D, 0x8B04], "vpush {d8, d9}", Class::StoreMany(4)),
            (&[0x6808], "ldr r0, [r1]", Class::Load),
            (&[0x6008], "str r0, [r1]", Class::Store),
            (&[0x5088], "str r0, [r1, r2]", Class::StoreByRegister),
            (&[0xB5F0], "push {r4, r5, r6, r7, lr}", Class::StoreMany(5)),
            (&[0xBD10], "pop {r4, pc}", Class::LoadMany(2)),
            (&[0xE9D1, 0x0200], "ldrd r0, r2, [r1]", Class::LoadMany(2)),
            (&[0xFBB0, 0xF0F1], "udiv r0, r0, r1", Class::IntegerDivide),
            (&[0xFB00, 0x2001], "mla r0, r0, r1, r2", Class::MultiplyAccumulate),
            (&[0xFBC2, 0x0103], "smlal r0, r1, r2, r3", Class::LongMultiplyAccumulate),
            (&[0xFBA2, 0x0103], "umull r0, r1, r2, r3", Class::LongMultiply),
            (&[0xD1FE], "bne #0x8000000", Class::Branch),
            (&[0xF7FF, 0xFFFE], "bl #0x8000000", Class::Call),
            (&[0x4770], "bx lr", Class::BranchToRegister),
            (&[0xBF08], "it eq", Class::IfThen),
            (&[0xF021, 0x0001], "bic r0, r1, #1", Class::Integer),
        ];
        for (code, text, class) in cases {
            let instruction = decode(code);
            assert_eq!((instruction.text.as_str(), instruction.class), (*text, *class));
        }
    }

    #[test]
    fn read_written_and_address_registers_are_decoded() {
        let multiply = decode(&[0xEE20, 0x0A20]);
        assert_eq!((multiply.writes, multiply.reads), (1 << 16, 0b11 << 16));
        let load = decode(&[0x6808]);
        assert_eq!((load.writes, load.addresses), (1, 0b10));
        assert!(decode(&[0xBD10]).writes_program_counter());
        assert!(!decode(&[0xB510]).writes_program_counter());
    }

    #[test]
    fn changes_of_the_stack_pointer_are_decoded() {
        let cases: &[(&[u16], i32)] = &[
            (&[0xB5F0], -20),
            (&[0xBD10], 8),
            (&[0xED2D, 0x8B04], -16),
            (&[0xB084], -16),
            (&[0xB004], 16),
            (&[0xF84D, 0xED08], -8),
            (&[0xF85D, 0xEB08], 8),
            (&[0xE92D, 0x4FF0], -36),
            (&[0x9001], 0),
        ];
        for (code, change) in cases {
            let instruction = decode(code);
            assert_eq!(instruction.stack_change, *change, "{}", instruction.text);
        }
    }
}
