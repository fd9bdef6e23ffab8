//! What the compiler said of the mutants of some sources: an interrupted run does not ask again.

use crate::mutant::Mutant;
use std::collections::hash_map::DefaultHasher;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};

/// Mutants, by their number, that are not in the program, with what the compiler says of them; and
/// functions that it evaluates.
#[derive(Debug, Default, PartialEq)]
pub struct Remembered {
    /// It refuses them.
    pub unviable: BTreeMap<usize, String>,
    /// They cannot be chosen at run time.
    pub apart: BTreeMap<usize, String>,
    /// Names of functions.
    pub constant: BTreeSet<String>,
}

impl Remembered {
    /// Where it is kept: in a folder, by the mutants and the texts they are woven into.
    pub fn file(known: &Path, mutants: &[Mutant], texts: &[String]) -> Result<PathBuf, String> {
        fs::create_dir_all(known).map_err(|error| format!("{}: {error}", known.display()))?;
        let mut hasher = DefaultHasher::new();
        mutants.iter().for_each(|mutant| mutant.name.hash(&mut hasher));
        texts.hash(&mut hasher);
        Ok(known.join(format!("{:016x}.builds", hasher.finish())))
    }

    /// Nothing, if nothing is kept there.
    pub fn read(file: &Path) -> Self {
        let mut all = Self::default();
        for line in fs::read_to_string(file).unwrap_or_default().lines() {
            match line.splitn(3, '\t').collect::<Vec<_>>()[..] {
                ["constant", name] => drop(all.constant.insert(name.into())),
                [kind, number, message] => {
                    let Ok(number) = number.parse() else { continue };
                    match kind {
                        "unviable" => drop(all.unviable.insert(number, message.into())),
                        "apart" => drop(all.apart.insert(number, message.into())),
                        _ => {}
                    }
                }
                _ => {}
            }
        }
        all
    }

    /// Keeps it.
    pub fn write(&self, file: &Path) -> Result<(), String> {
        let mut text = String::new();
        for (kind, mutants) in [("unviable", &self.unviable), ("apart", &self.apart)] {
            for (number, message) in mutants {
                let message = message.lines().next().unwrap_or_default();
                text.push_str(&format!("{kind}\t{number}\t{message}\n"));
            }
        }
        self.constant.iter().for_each(|name| text.push_str(&format!("constant\t{name}\n")));
        fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::Remembered;

    #[test]
    fn what_was_found_out_is_read_again_for_the_same_texts_only() {
        let known = std::env::temp_dir().join(format!("remembered-{}", std::process::id()));
        let file = |text: &str| Remembered::file(&known, &[], &[text.into()]).expect("a folder");
        let all = Remembered {
            unviable: [(3, "mismatched\ttypes".into())].into(),
            apart: [(7, "a constant".into())].into(),
            constant: ["within".to_owned()].into(),
        };
        all.write(&file("fn a() {}")).expect("a file");
        assert_eq!(Remembered::read(&file("fn a() {}")), all);
        assert_eq!(Remembered::read(&file("fn b() {}")), Remembered::default());
        std::fs::remove_dir_all(known).expect("its folder");
    }
}
