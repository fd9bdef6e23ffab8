//! A program's image: where its functions are, and the code at an address.

use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};
use std::path::{Path, PathBuf};

/// Why an image could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is not an ELF file.
    #[error("{}: {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: object::Error,
    },
    /// No function has the name, or several have.
    #[error("{found} functions are named \"{name}\" in the image{}", list(candidates))]
    Function {
        /// The name.
        name: String,
        /// How many there are.
        found: usize,
        /// The names that end alike.
        candidates: Vec<String>,
    },
}

fn list(candidates: &[String]) -> String {
    if candidates.is_empty() { String::new() } else { format!(": {}", candidates.join(", ")) }
}

/// A function of the image.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Name, as in the source.
    pub name: String,
    /// First address.
    pub address: u32,
    /// Bytes, literals included.
    pub size: u32,
}

/// An image.
#[derive(Clone, Debug)]
pub struct Image {
    /// Address and content of each section.
    sections: Vec<(u32, Vec<u8>)>,
    /// By address.
    functions: Vec<Function>,
}

impl Image {
    /// Reads an ELF file.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let bytes = std::fs::read(path)
            .map_err(|source| ImageError::Read { path: path.to_owned(), source })?;
        let parse = |source| ImageError::Parse { path: path.to_owned(), source };
        let file = object::File::parse(&*bytes).map_err(parse)?;
        let mut sections = Vec::new();
        for section in file.sections() {
            // What is not loaded has no address.
            if section.address() != 0 {
                let content = section.data().map_err(parse)?.to_vec();
                sections.push((section.address() as u32, content));
            }
        }
        let mut functions: Vec<Function> = file
            .symbols()
            .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
            .filter_map(|symbol| {
                let name = format!("{:#}", rustc_demangle::demangle(symbol.name().ok()?));
                // Bit 0 of a function's address says that its code is Thumb.
                let address = symbol.address() as u32 & !1;
                Some(Function { name, address, size: symbol.size() as u32 })
            })
            .collect();
        functions.sort_by_key(|function| function.address);
        functions.dedup_by_key(|function| function.address);
        Ok(Self { sections, functions })
    }

    /// The one function whose name is `name` or ends with `::name`.
    pub fn function(&self, name: &str) -> Result<&Function, ImageError> {
        let ending = format!("::{name}");
        let found: Vec<&Function> = self
            .functions
            .iter()
            .filter(|function| function.name == name || function.name.ends_with(&ending))
            .collect();
        match found.as_slice() {
            [one] => Ok(one),
            _ => Err(ImageError::Function {
                name: name.to_owned(),
                found: found.len(),
                candidates: found.iter().map(|function| function.name.clone()).collect(),
            }),
        }
    }

    /// The function that an address is in.
    pub fn function_at(&self, address: u32) -> Option<&Function> {
        let after = self.functions.partition_point(|function| function.address <= address);
        let function = self.functions.get(after.checked_sub(1)?)?;
        (address < function.address + function.size).then_some(function)
    }

    /// From the first address of a function to the end of the last.
    pub fn code_range(&self) -> (u32, u32) {
        let end = |function: &Function| function.address + function.size;
        let (first, last) = (self.functions.first(), self.functions.iter().map(end).max());
        (first.map_or(0, |function| function.address), last.unwrap_or(0))
    }

    /// The code at an address: what an instruction may take, or less where a section ends.
    pub fn code_at(&self, address: u32) -> &[u8] {
        self.sections
            .iter()
            .find_map(|(start, content)| {
                let offset = address.checked_sub(*start)? as usize;
                content.get(offset..)
            })
            .map_or(&[], |code| &code[..code.len().min(4)])
    }
}
