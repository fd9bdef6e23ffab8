//! Architecture: allowed dependencies.

#[path = "rooms/imports.rs"]
mod imports;

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Every Rust source below a folder, with its text.
fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = fs::read_to_string(&path).expect("a source");
            found.push((path, text));
        }
    }
    found
}

/// The sources of a folder that mention any of `words` outside of comments.
fn mentions(folder: &str, words: &[&str]) -> Vec<String> {
    let folder = root().join(folder);
    let mut found: Vec<_> = sources(&folder)
        .into_iter()
        .filter(|(_, text)| {
            text.lines()
                .map(|line| line.split("//").next().unwrap_or(""))
                .any(|line| words.iter().any(|word| line.contains(word)))
        })
        .map(|(path, _)| path.strip_prefix(&folder).expect("below").display().to_string())
        .collect();
    found.sort_unstable();
    found
}

#[test]
fn the_reference_does_not_know_the_model() {
    let words = ["vm_nostd", "literal_port", "crate::model_muscle", "crate::engine"];
    assert_eq!(mentions("host-sim/src/reference", &words), [""; 0]);
    let text = fs::read_to_string(root().join("host-sim/src/reference.rs")).expect("a source");
    assert!(!text.contains("use vm_nostd"));
}

#[test]
fn the_baseline_knows_neither_the_model_nor_the_reference() {
    assert_eq!(mentions("host-sim/literal-port", &["vm_nostd", "host_sim"]), [""; 0]);
}

#[test]
fn only_the_scalars_of_the_model_name_a_maths_library() {
    assert_eq!(mentions("vm-nostd/src", &["libm::"]), ["scalar/float/double.rs"]);
}

#[test]
fn the_model_needs_no_std_no_heap_and_no_unsafe() {
    let found = mentions("vm-nostd/src", &["extern crate", "std::", "unsafe "]);
    assert!(found.iter().all(|file| file.starts_with("tests/")), "{found:?}");
    let parent = root().join("vm-nostd/src/lib.rs");
    assert!(fs::read_to_string(parent).expect("a source").contains("#[cfg(test)]\nmod tests;"));
}

#[test]
fn only_the_board_names_the_chip() {
    let names = mentions("firmware/src", &["SYST", "set_reload", "stm32"]);
    assert_eq!(names, ["board.rs", "board/chip.rs", "board/memory.rs", "board/noise.rs"]);
}

/// The explorer of interleavings intercepts every access: the firmware's levels share nothing else.
/// The board's watchdog, built for the chip only, shares its timeout with flash.
#[test]
fn only_one_module_names_what_levels_share() {
    assert_eq!(mentions("firmware/src", &["atomic::"]), ["between/shared.rs", "board/watchdog.rs"]);
}

/// Files of a crate that import each other in a loop.
fn circles(crate_root: &str) -> Vec<String> {
    let file = root().join(crate_root);
    let folder = file.parent().expect("a folder");
    imports::Crate::new(&sources(folder), &file).circles(folder)
}

/// The crate roots of the workspace's members.
fn crate_roots() -> Vec<String> {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).expect("a manifest");
    let (_, rest) = manifest.split_once("members = [").expect("members");
    let (members, _) = rest.split_once(']').expect("their end");
    let names = members.split('"').skip(1).step_by(2);
    let files =
        names.flat_map(|name| [format!("{name}/src/lib.rs"), format!("{name}/src/main.rs")]);
    files.filter(|file| root().join(file).exists()).collect()
}

#[test]
fn no_file_imports_back() {
    let found: Vec<_> = crate_roots().into_iter().map(|file| (circles(&file), file)).collect();
    for product in ["vm-nostd/src/lib.rs", "firmware/src/lib.rs", "host-sim/src/lib.rs"] {
        assert!(found.iter().any(|(_, file)| file == product), "{product}: {found:#?}");
    }
    assert!(found.iter().all(|(circles, _)| circles.is_empty()), "{found:#?}");
}

/// The table of ARCHITECTURE.md is in the order of imports, and has every file of the model.
#[test]
fn the_map_of_the_model_is_in_the_order_of_imports() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("a text");
    let (_, table) = text.split_once("From the ground up").expect("the table");
    let (table, _) = table.split_once("\n## ").expect("its end");
    let rows: Vec<Vec<&str>> = table
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split_once(" |"))
        .map(|(places, _)| places.trim_end_matches('`').split("`, `").collect())
        .collect();
    // The row of a file: the one that names it, or else its folder.
    let row = |file: &str| {
        let names =
            |place: &&str| file == *place || place.ends_with('/') && file.starts_with(*place);
        let matching = rows.iter().enumerate().filter_map(|(row, places)| {
            places.iter().filter(|place| names(place)).map(|place| (place.len(), row)).max()
        });
        matching.max().map(|(_, row)| row)
    };
    let file = root().join("vm-nostd/src/lib.rs");
    let folder = file.parent().expect("a folder");
    let imports = imports::Crate::new(&sources(folder), &file).imports(folder);
    assert!(imports.len() > 100, "{}", imports.len());
    for (from, to) in imports.iter().filter(|(from, _)| from != "lib.rs") {
        let (Some(above), Some(below)) = (row(from), row(to)) else {
            panic!("ARCHITECTURE.md has no row for {from} or {to}");
        };
        assert!(below <= above, "{from} imports {to}, which is below it in ARCHITECTURE.md");
    }
}

/// These packages are built for each mutant.
#[test]
fn the_tests_of_the_libraries_build_without_the_host() {
    for package in ["tests/model", "tests/stimulator", "firmware", "vm-nostd"] {
        let manifest = root().join(package).join("Cargo.toml");
        let text = fs::read_to_string(manifest).expect("a manifest");
        let knows = |name: &&str| text.lines().any(|line| line.starts_with(*name));
        assert_eq!(["host-sim", "system-tests"].iter().find(|name| knows(name)), None, "{package}");
    }
}

/// Examples are a package of their own; cargo must not take its build script for one.
#[test]
fn no_build_script_passes_for_an_example() {
    let output = std::process::Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(root())
        .output()
        .expect("cargo");
    let metadata = String::from_utf8(output.stdout).expect("a text");
    assert!(metadata.contains("\"kind\":[\"lib\"]"), "{metadata}");
    assert!(!metadata.contains("\"kind\":[\"example\"]"), "{metadata}");
}
