//! A program's image: its sections, functions and code.

use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};
use std::path::{Path, PathBuf};

/// Why an image could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a valid ELF file.
    #[error("{}: {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Error of the parser.
        source: object::Error,
    },
    /// The debug information could not be read.
    #[error("{}: debug information: {reason}", path.display())]
    Lines {
        /// The file.
        path: PathBuf,
        /// Error of the reader.
        reason: String,
    },
    /// No function or several functions match the name.
    #[error("{} functions are named \"{name}\" in the image{}", candidates.len(), list(candidates))]
    Function {
        /// The name.
        name: String,
        /// The functions of that name.
        candidates: Vec<Function>,
    },
}

/// Lists functions of equal name with their addresses and symbols.
fn list(candidates: &[Function]) -> String {
    let Some(first) = candidates.first() else { return String::new() };
    let each = |one: &Function| format!("\n  {:#010x} {} ({})", one.address, one.name, one.symbol);
    let all: String = candidates.iter().map(each).collect();
    format!("; choose one by its address ({:#010x}) or its symbol:{all}", first.address)
}

/// A function of the image.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Demangled name.
    pub name: String,
    /// Mangled name; in Rust it contains a hash.
    pub symbol: String,
    /// First address.
    pub address: u32,
    /// Bytes, literals included.
    pub size: u32,
}

/// A loaded section of the image.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Name.
    pub name: String,
    /// First address.
    pub address: u32,
    /// Bytes.
    pub size: u32,
}

/// An image.
#[derive(Clone, Debug)]
pub struct Image {
    /// The file.
    pub path: PathBuf,
    /// Address and content of each section.
    sections: Vec<(u32, Vec<u8>)>,
    /// All loaded sections, including those without content.
    places: Vec<Section>,
    /// Sorted addresses at which code begins after data.
    code_begins: Vec<u32>,
    /// Sorted by address.
    functions: Vec<Function>,
    /// Name and size in bytes of each constant.
    constants: Vec<(String, u32)>,
}

impl Image {
    /// Reads an ELF file.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let bytes = std::fs::read(path)
            .map_err(|source| ImageError::Read { path: path.to_owned(), source })?;
        let parse = |source| ImageError::Parse { path: path.to_owned(), source };
        let file = object::File::parse(&*bytes).map_err(parse)?;
        let (mut sections, mut places) = (Vec::new(), Vec::new());
        for section in file.sections() {
            // Sections that are not loaded have address 0.
            if section.address() != 0 {
                let content = section.data().map_err(parse)?.to_vec();
                let (address, size) = (section.address() as u32, section.size() as u32);
                sections.push((address, content));
                let name = section.name().map_err(parse)?.to_owned();
                places.push(Section { name, address, size });
            }
        }
        let mut functions: Vec<Function> = file
            .symbols()
            // Assembly may omit the symbol type. Symbols with "$" mark code and data.
            .filter(|symbol| matches!(symbol.kind(), SymbolKind::Text | SymbolKind::Unknown))
            .filter(|symbol| {
                let section = symbol.section_index().and_then(|s| file.section_by_index(s).ok());
                section.is_some_and(|section| section.kind() == SectionKind::Text)
            })
            .filter_map(|symbol| {
                let mangled = symbol.name().ok().filter(|name| !name.starts_with('$'))?;
                let name = format!("{:#}", rustc_demangle::demangle(mangled));
                // Bit 0 of the address marks Thumb code.
                let address = symbol.address() as u32 & !1;
                let (symbol, size) = (mangled.to_owned(), symbol.size() as u32);
                Some(Function { name, symbol, address, size })
            })
            .collect();
        let mut code_begins: Vec<u32> = file
            .symbols()
            .filter(|symbol| {
                symbol.name().is_ok_and(|name| name == "$t" || name.starts_with("$t."))
            })
            .map(|symbol| symbol.address() as u32 & !1)
            .collect();
        code_begins.sort_unstable();
        let constants = file
            .symbols()
            .filter(|symbol| symbol.kind() == SymbolKind::Data)
            .filter_map(|symbol| {
                let name = format!("{:#}", rustc_demangle::demangle(symbol.name().ok()?));
                Some((name, symbol.size() as u32))
            })
            .collect();
        // Of several symbols at one address, keep the one that states its size.
        functions.sort_by_key(|function| (function.address, function.size == 0));
        functions.dedup_by_key(|function| function.address);
        for index in 0..functions.len() {
            // A function without a size ends where the next one begins.
            if functions[index].size == 0 {
                let address = functions[index].address;
                let next = functions.get(index + 1).map_or(u32::MAX, |next| next.address);
                let end = section_end(&sections, address).min(next);
                functions[index].size = end.saturating_sub(address);
            }
        }
        let path = path.to_owned();
        Ok(Self { path, sections, places, code_begins, functions, constants })
    }

    /// Total size of the constants of a module and its submodules, bytes.
    pub fn constant_bytes(&self, module: &str) -> u32 {
        let inside = format!("{module}::");
        let of_module = self.constants.iter().filter(|(name, _)| name.starts_with(&inside));
        of_module.map(|(_, bytes)| bytes).sum()
    }

    /// Adds code that is not in the file.
    pub fn add_code(&mut self, address: u32, code: Vec<u8>) {
        self.sections.push((address, code));
    }

    /// Looks up a function by its name, the end of its path (`::name`), its symbol or its
    /// hexadecimal address (0x...).
    pub fn function(&self, name: &str) -> Result<&Function, ImageError> {
        let ending = format!("::{name}");
        let address = name.strip_prefix("0x").map(|digits| digits.replace('_', ""));
        let address = address.and_then(|digits| u32::from_str_radix(&digits, 16).ok());
        let chosen = |function: &&Function| match address {
            Some(address) => function.address == address & !1,
            None => function.name == name || function.name.ends_with(&ending),
        };
        let by_symbol = self.functions.iter().filter(|function| function.symbol == name);
        let found: Vec<&Function> = self.functions.iter().filter(chosen).collect();
        match (found.as_slice(), by_symbol.collect::<Vec<_>>().as_slice()) {
            ([one], _) | (_, [one]) => Ok(one),
            _ => Err(ImageError::Function {
                name: name.to_owned(),
                candidates: found.into_iter().cloned().collect(),
            }),
        }
    }

    /// All loaded sections.
    pub fn sections(&self) -> &[Section] {
        &self.places
    }

    /// The first start of code at or after an address; `None` if the image marks none.
    pub fn code_behind(&self, address: u32) -> Option<u32> {
        let index = self.code_begins.partition_point(|&begin| begin < address);
        self.code_begins.get(index).copied()
    }

    /// The 32-bit word at an address.
    pub fn word_at(&self, address: u32) -> Option<u32> {
        self.code_at(address).try_into().ok().map(u32::from_le_bytes)
    }

    /// The function that contains an address.
    pub fn function_at(&self, address: u32) -> Option<&Function> {
        let after = self.functions.partition_point(|function| function.address <= address);
        let function = self.functions.get(after.checked_sub(1)?)?;
        (address < function.address + function.size).then_some(function)
    }

    /// Up to four bytes of code at an address, the longest instruction; fewer at a section's end.
    pub fn code_at(&self, address: u32) -> &[u8] {
        self.sections
            .iter()
            .find_map(|(start, content)| {
                let offset = address.checked_sub(*start)? as usize;
                // An address at the end of one section may be the start of the next.
                content.get(offset..).filter(|code| !code.is_empty())
            })
            .map_or(&[], |code| &code[..code.len().min(4)])
    }
}

#[cfg(test)]
impl Image {
    /// An image of consecutive functions, given by name and halfwords.
    pub(crate) fn of_code(address: u32, functions: &[(&str, &[u16])]) -> Self {
        let mut code = Vec::new();
        let functions = functions
            .iter()
            .map(|(name, halfwords)| {
                let at = address + code.len() as u32;
                code.extend(halfwords.iter().flat_map(|halfword| halfword.to_le_bytes()));
                let (name, size) = ((*name).to_owned(), 2 * halfwords.len() as u32);
                Function { symbol: name.clone(), name, address: at, size }
            })
            .collect();
        let sections = vec![(address, code)];
        Self {
            path: PathBuf::from("test"),
            sections,
            places: Vec::new(),
            code_begins: Vec::new(),
            functions,
            constants: Vec::new(),
        }
    }
}

/// The end of the section that contains an address.
fn section_end(sections: &[(u32, Vec<u8>)], address: u32) -> u32 {
    let ends = sections.iter().map(|(start, content)| (*start, start + content.len() as u32));
    ends.filter(|(start, end)| (*start..*end).contains(&address))
        .map(|(_, end)| end)
        .next()
        .unwrap_or(address)
}
